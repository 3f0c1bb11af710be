"""What the frequency domain costs: the FPSO example, and growth with lines, elements and frequencies.

Run from the repository: python benchmarks/frequency_domain.py [--quick]. Kernels are warm; one thread.
"""

from __future__ import annotations

import argparse
import copy
import os
import resource
import statistics
import time
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import yaml

from solver.case import parse_case
from solver.frequency_domain.solve import solve_frequency_domain
from solver.model.build import build
from solver.run import warm_up
from solver.statics.solve import solve_statics
from solver.vessel.data import FileSource

EXAMPLES = Path(__file__).parents[1] / "examples"


def fpso() -> dict[str, Any]:
    data: dict[str, Any] = yaml.safe_load((EXAMPLES / "fpso-2000m.yaml").read_text())
    data["analyses"].pop("time_domain", None)
    return data


def measure(data: dict[str, Any], repeat: int) -> tuple[float, float, int]:
    """Median seconds of statics and of the frequency domain, and its iterations."""
    model = build(parse_case(data), FileSource(EXAMPLES))
    spec = model.case.analyses.frequency_domain
    assert spec is not None
    statics, frequency, iterations = [], [], 0
    for _ in range(repeat):
        started = time.perf_counter()
        static = solve_statics(model)
        middle = time.perf_counter()
        iterations = solve_frequency_domain(model, static, spec).iterations
        statics.append(middle - started)
        frequency.append(time.perf_counter() - middle)
    return statistics.median(statics), statistics.median(frequency), iterations


def with_lines(count: int) -> dict[str, Any]:
    data = fpso()
    names = list(data["lines"])
    lines = {}
    for k in range(count):
        line = copy.deepcopy(data["lines"][names[k % 4]])
        line["multiplicity"] = 1
        lines[f"line-{k}"] = line
    data["lines"] = lines
    data["vessel"]["hydrodynamics"]["drift"] = "newman"
    return data


def with_elements(count: int) -> dict[str, Any]:
    data = fpso()
    for line in data["lines"].values():
        line["segments"][0]["elements"] = count
    seabed = data["environment"]["seabed"]  # one bed, whatever the spacing
    if "node_stiffness" in seabed:
        seabed["node_stiffness"] = 30e3 * 50 / count
    return data


def with_frequencies(factor: int) -> dict[str, Any]:
    data = fpso()
    bands = data["analyses"]["frequency_domain"]
    bands["wave"]["step"] = 0.005 / factor
    bands["low"]["step"] = 0.00125 / factor
    return data


def table(title: str, sizes: list[int], make: Any, repeat: int) -> None:
    """A row per size; the slope is that of seconds per iteration, since iterations may differ."""
    print(f"\n{title:>14} {'statics, s':>11} {'frequency, s':>13} {'iterations':>11} {'s/iteration':>12} {'ratio':>7}")
    each = []
    for size in sizes:
        statics, frequency, iterations = measure(make(size), repeat)
        each.append(frequency / iterations)
        print(
            f"{size:>14} {statics:>11.3f} {frequency:>13.3f} {iterations:>11} {each[-1]:>12.4f} {each[-1] / each[0]:>7.2f}"
        )
    slope = np.polyfit(np.log(sizes), np.log(each), 1)[0]
    print(f"{'log-log slope of s/iteration':>60} {slope:>6.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer sizes, each once")
    parser.add_argument("--repeat", type=int, default=3, help="runs per size; the median is shown")
    arguments = parser.parse_args()
    repeat = 1 if arguments.quick else arguments.repeat
    print(f"kernels loaded or compiled in {warm_up():.1f} s")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    statics, frequency, iterations = measure(fpso(), max(repeat, 1) * 2 - 1)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"FPSO: statics {statics:.3f} s, frequency domain {frequency:.3f} s in {iterations} iterations (median)")
    print(f"peak memory {after:.0f} MB ({before:.0f} MB before the first case)")
    table("lines", [4, 16] if arguments.quick else [4, 8, 16, 32, 64], with_lines, repeat)
    table("elements", [50, 200] if arguments.quick else [50, 100, 200, 400], with_elements, repeat)
    table("frequencies ×", [1, 4] if arguments.quick else [1, 2, 4, 8], with_frequencies, repeat)


if __name__ == "__main__":
    main()
