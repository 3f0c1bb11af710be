"""What a start costs: imports and kernels, on a second start (cached) and, with --first, compiled from nothing.

Run from the repository: python benchmarks/start.py [--quick] [--first].
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile

PROBE = """
import time
started = time.perf_counter()
import solver.run
imported = time.perf_counter()
kernels = solver.run.warm_up()
print(imported - started, kernels)
"""


def start(cache: str | None) -> tuple[float, float]:
    """Seconds of import and of kernels in a fresh process."""
    environment = {**os.environ, **({"NUMBA_CACHE_DIR": cache} if cache else {})}
    shown = subprocess.run(
        [sys.executable, "-c", PROBE], env=environment, capture_output=True, text=True, check=True
    ).stdout
    imported, kernels = map(float, shown.split())
    return imported, kernels


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two starts")
    parser.add_argument("--first", action="store_true", help="compile into an empty cache too; about a minute or two")
    parser.add_argument("--repeat", type=int, default=5)
    arguments = parser.parse_args()
    start(None)  # fills the cache
    found = [start(None) for _ in range(2 if arguments.quick else arguments.repeat)]
    imports, kernels = (statistics.median(column) for column in zip(*found, strict=True))
    print(f"{'':>14} {'import, s':>10} {'kernels, s':>11} {'both, s':>8}")
    print(f"{'second start':>14} {imports:>10.2f} {kernels:>11.2f} {imports + kernels:>8.2f}")
    if arguments.first:
        with tempfile.TemporaryDirectory() as empty:
            imported, compiled = start(empty)
        print(f"{'first start':>14} {imported:>10.2f} {compiled:>11.2f} {imported + compiled:>8.2f}")
        print(f"first over second: {(imported + compiled) / (imports + kernels):.0f}")


if __name__ == "__main__":
    main()
