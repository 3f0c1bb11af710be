"""What the time domain costs: ten seeds of the FPSO example, one seed alone, peak memory, and growth with nodes.

Run from the repository: python benchmarks/ensemble.py [--quick] [--repeat 3]. Kernels are warm.
"""

from __future__ import annotations

import argparse
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
from solver.model.build import build
from solver.statics.solve import solve_statics
from solver.time_domain.ensemble import Block, Run, march_ensemble
from solver.vessel.data import FileSource
from solver.warm import warm_up, warm_up_time_domain

EXAMPLES = Path(__file__).parents[1] / "examples"
SIZES = (25, 50, 100, 200)


def fpso(elements: int = 50, **spec: Any) -> dict[str, Any]:
    """The example's time domain with other numbers of elements, on one bed whatever the spacing."""
    data: dict[str, Any] = yaml.safe_load((EXAMPLES / "fpso-2000m.yaml").read_text())
    for line in data["lines"].values():
        line["segments"][0]["elements"] = elements
    seabed = data["environment"]["seabed"]
    if "node_stiffness" in seabed:
        seabed["node_stiffness"] = 30e3 * 50 / elements
    data["analyses"] = {"frequency_domain": data["analyses"]["frequency_domain"],
                        "time_domain": {**data["analyses"]["time_domain"], **spec}}  # fmt: skip
    return data


def measure(data: dict[str, Any], seeds: int, threads: int) -> tuple[float, float, int, float]:
    """Wall and processor seconds of `seeds` seeds, their line-steps and the share of second iterations."""
    model = build(parse_case(data), FileSource(EXAMPLES))
    spec = model.case.analyses.time_domain
    assert spec is not None
    static = solve_statics(model)
    wall, processor = time.perf_counter(), time.process_time()
    record, timing = march_ensemble(model, static, spec, list(range(1, seeds + 1)), threads)
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    steps = timing.build_up + timing.kept
    return wall, processor, steps * seeds * len(data["lines"]), record.iterations / steps


def median(data: dict[str, Any], seeds: int, threads: int, repeat: int) -> tuple[float, float, int]:
    found = [measure(data, seeds, threads) for _ in range(repeat)]
    return statistics.median(one[0] for one in found), statistics.median(one[1] for one in found), found[0][2]


def ensembles(repeat: int, spec: dict[str, Any]) -> None:
    print(
        f"{'seeds':>6} {'threads':>8} {'wall, s':>8} {'processor, s':>13} {'µs/line-step':>13} {'peak MB so far':>15}"
    )
    for seeds, threads in ((1, 1), (1, 2), (10, 2)):
        wall, processor, line_steps = median(fpso(**spec), seeds, threads, repeat)
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        print(
            f"{seeds:>6} {threads:>8} {wall:>8.1f} {processor:>13.1f} {1e6 * processor / line_steps:>13.2f} {peak:>15.0f}",
            flush=True,
        )


def growth(repeat: int, steps: int) -> None:
    """Processor time of equally many steps of two seeds over elements a line: the march alone, without set-up."""
    print(f"\n{'elements':>9} {'processor, s':>13} {'µs/line-step':>13} {'ratio':>6}")
    costs = []
    for elements in SIZES:
        data = fpso(elements, build_up=0.0, duration=0.04 * 10 * steps, output_step=4.0, wave_step=0.00125)
        model = build(parse_case(data), FileSource(EXAMPLES))
        spec = model.case.analyses.time_domain
        assert spec is not None
        block = Block(Run(model, solve_statics(model), spec), [1, 2])
        block.go(steps // 4)
        found = []
        for _ in range(max(repeat, 3)):
            started = time.process_time()
            block.go(steps)
            found.append(time.process_time() - started)
        costs.append(statistics.median(found))
        each = 1e6 * costs[-1] / (2 * len(data["lines"]) * steps)
        print(f"{elements:>9} {costs[-1]:>13.3f} {each:>13.2f} {costs[-1] / costs[0]:>6.2f}", flush=True)
    print(f"log-log slope {np.polyfit(np.log(SIZES), np.log(costs), 1)[0]:.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a tenth of the kept time, each once")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each; medians are shown")
    parser.add_argument("--growth", action="store_true", help="only the growth with nodes")
    given = parser.parse_args()
    repeat = 1 if given.quick else given.repeat
    print(f"kernels loaded or compiled in {warm_up() + warm_up_time_domain():.1f} s")
    if not given.growth:
        ensembles(repeat, {"build_up": 120.0, "duration": 502.64} if given.quick else {})
    growth(repeat, 400 if given.quick else 2000)


if __name__ == "__main__":
    main()
