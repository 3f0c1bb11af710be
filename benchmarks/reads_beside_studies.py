"""Reads while studies are written: `python benchmarks/reads_beside_studies.py [--kind embedded postgres-redis]`.

100 clients poll, each once a second, while eight studies of 500 runs and one of 10 000 are accepted; nothing computes.
Only reads under way while a study is being written count. Measured by turns with the API as it is (its threads change
every 0.5 ms, cli/api.py) and with Python's own 5 ms, ratios reported.
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from pathlib import Path

import httpx
from service_load import KINDS, ROOT, end_polling, start_polling, started, study, submit, summary

PYTHONS_OWN = "import sys\nsys.setswitchinterval = lambda seconds: None\n"
Span = tuple[float, float]


def timed_study(client: httpx.Client, runs: int, stiffness: float) -> Span:
    began = time.monotonic()
    study(client, runs, stiffness)
    return began, time.monotonic()


def measure(kind: str, clients: int) -> tuple[dict[str, float], dict[str, float]]:
    """Beside the studies of 500 runs, and beside that of 10 000."""
    with started(kind, "--workers", "0") as client:
        ids = [submit(client, number) for number in range(10)]
        polling = start_polling(client, clients, ids)
        small = []
        for number in range(8):
            small.append(timed_study(client, 500, 2.0e9 + 1.0e6 * number))
            time.sleep(0.5)
        large = [timed_study(client, 10_000, 1.0e9)]
        reads = end_polling(polling)
    return beside(reads, small), beside(reads, large)


def beside(reads: list[Span], spans: list[Span]) -> dict[str, float]:
    """Of the reads under way in one of the spans, and how long the spans were."""
    met = [took for when, took in reads if any(a < when + took and when < z for a, z in spans)]
    return summary(met) | {"accepted_s": sum(z - a for a, z in spans) / len(spans)}


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
                        + f"; p99 times {now['read_p99_ms'] / own['read_p99_ms']:.2f}"
                    )


if __name__ == "__main__":
    main()
