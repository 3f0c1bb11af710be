"""Start a worker in this process."""

from __future__ import annotations

import os

from store.broker import EMBEDDED, INTERACTIVE, RUNS, queue_name

QUICK_POLL_SECONDS = 0.05


def run_worker(queue: str = RUNS, concurrency: int = 1) -> None:
    """Serve one queue until ended by a signal."""
    from .app import app, settings

    # one thread per process: the solver's parallelism is runs and chunks, not BLAS
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    if queue == INTERACTIVE and app.conf.broker_url.startswith(EMBEDDED):
        app.conf.broker_transport_options |= {"polling_interval": QUICK_POLL_SECONDS}  # somebody waits for the answer
    app.worker_main(
        [
            "worker",
            f"--queues={queue_name(settings, queue)}",
            f"--concurrency={concurrency}",
            f"--hostname={queue}@%h",
            "--pool=prefork",
            "--without-gossip",
            "--without-mingle",
            "--without-heartbeat",
            f"--loglevel={settings.log_level}",
        ]
    )
