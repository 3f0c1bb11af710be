"""Start a worker in this process."""

from __future__ import annotations

import os

from store.broker import EMBEDDED, HYDRODYNAMICS, INTERACTIVE, QUICK, RUNS, queue_name

from . import hydrodynamics

QUICK_POLL_SECONDS = 0.05
NICENESS = 5


def run_worker(queue: str = RUNS, concurrency: int = 1) -> None:
    """Serve one queue until ended by a signal.

    The interactive worker takes previews and, in one of its two processes at a time, small runs: so that neither waits
    for the other, nor for what the workers of `runs` have at hand.
    """
    from .app import app, settings

    # one thread per process: the solver's parallelism is runs and chunks, not BLAS
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    if queue == INTERACTIVE and app.conf.broker_url.startswith(EMBEDDED):
        app.conf.broker_transport_options |= {"polling_interval": QUICK_POLL_SECONDS}  # somebody waits for the answer
    if queue == HYDRODYNAMICS:
        hydrodynamics.warm_up(settings.data_dir)
    if queue != INTERACTIVE:
        os.nice(NICENESS)  # on a machine that is shared, answers to people come before the computing
    queues = [queue]
    if queue == INTERACTIVE:
        queues, concurrency = [INTERACTIVE, QUICK], max(2, concurrency)
    app.worker_main(
        [
            "worker",
            f"--queues={','.join(queue_name(settings, name) for name in queues)}",
            f"--concurrency={concurrency}",
            f"--hostname={queue}@%h",
            "--pool=prefork",
            "--without-gossip",
            "--without-mingle",
            "--without-heartbeat",
            f"--loglevel={settings.log_level}",
        ]
    )
