"""Reads while studies are written: `python benchmarks/reads_beside_studies.py [--kind embedded postgres-redis]`.

100 clients poll, each once a second, while eight studies of 500 runs and one of 10 000 are accepted; nothing computes.
Only reads under way while a study is being written count. Measured by turns with the API as it is (its threads change
every 0.5 ms, cli/api.py) and with Python's own 5 ms, ratios reported.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import service_load
from service_load import KINDS, ROOT, started, study, submit

PYTHONS_OWN = "import sys\nsys.setswitchinterval = lambda seconds: None\n"
Span = tuple[float, float]


def timed_study(client: service_load.httpx.Client, runs: int, stiffness: float) -> Span:
    began = time.monotonic()
    study(client, runs, stiffness)
    return began, time.monotonic()


def measure(kind: str, clients: int) -> tuple[dict[str, float], dict[str, float]]:
    """Beside the studies of 500 runs, and beside that of 10 000."""
    with started(kind, "--workers", "0") as client:
        ids = [submit(client, number) for number in range(10)]
        command = [sys.executable, service_load.__file__, "--poll", str(client.base_url.port), str(clients), *ids]
        polling = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT)
        time.sleep(3)
        small = []
        for number in range(8):
            small.append(timed_study(client, 500, 2.0e9 + 1.0e6 * number))
            time.sleep(0.5)
        large = [timed_study(client, 10_000, 1.0e9)]
        found = json.loads(polling.communicate()[0])
    assert not found["bad"], found["bad"]
    return summary(found["reads"], small), summary(found["reads"], large)


def summary(reads: list[Span], spans: list[Span]) -> dict[str, float]:
    times = sorted(1e3 * took for when, took in reads if any(a < when + took and when < z for a, z in spans))
    return {
        "reads": len(times),
        "p50_ms": times[len(times) // 2],
        "p99_ms": times[int(0.99 * len(times))],
        "max_ms": times[-1],
        "accepted_s": sum(z - a for a, z in spans) / len(spans),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--kind", nargs="*", choices=KINDS, default=["embedded", "postgres-redis"])
    parser.add_argument("--clients", type=int, default=100)
    parser.add_argument("--times", type=int, default=2)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="sd-turns-") as folder:
        (Path(folder) / "sitecustomize.py").write_text(PYTHONS_OWN)
        for kind in options.kind:
            for _ in range(options.times):
                os.environ["SD_TEST_PATH"] = str(ROOT)
                ours = measure(kind, options.clients)
                os.environ["SD_TEST_PATH"] = os.pathsep.join((folder, str(ROOT)))
                pythons = measure(kind, options.clients)
                for runs, now, own in zip((500, 10_000), ours, pythons, strict=True):
                    print(
                        f"{kind}, studies of {runs} runs: "
                        + ", ".join(f"{name} {now[name]:.3g} (5 ms: {own[name]:.3g})" for name in now)
                        + f"; p99 times {now['p99_ms'] / own['p99_ms']:.2f}"
                    )


if __name__ == "__main__":
    main()
