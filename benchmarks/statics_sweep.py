"""How many of 1000 ordinary moorings find their static equilibrium, how fast, and whether it is one.

Run from the repository: PYTHONPATH=. python benchmarks/statics_sweep.py [--first 0] [--count 1000] [--seed 1] [--out FILE]. The
systems are those of tests/sweep.py, the check of equilibrium is tests/statics/independent.py. Kernels are warm;
seconds are of the processor, for one model's statics, pretension search included.
"""

from __future__ import annotations

import argparse
import csv
import os
import time
from collections import defaultdict
from itertools import pairwise
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from solver.case import parse_case
from solver.model.build import build
from solver.outcome import CaseError, SlowdriftError
from solver.statics.assembly import Assembly
from solver.statics.drift import DriftingBody
from solver.statics.solve import solve_statics
from solver.warm import warm_up
from tests.statics.independent import impossible, residuals
from tests.sweep import KINDS, ScaledBarge, kind_of, system

RESULTS = Path(__file__).parent / "results"
DEPTHS = (30, 100, 300, 1000, 3000)
ALLOWED = 1e-8  # residual of the independent check
COLUMNS = ("index", "kind", "depth", "lines", "iterations", "seconds", "nodes", "vessel", "lowest", "outcome")
Row = dict[str, Any]


def measure(index: int, seed: int) -> Row:
    """One system: iterations, seconds, residuals of the independent check, and the outcome."""
    data = system(index, seed)
    row: Row = {"index": index, "kind": kind_of(index), "depth": round(data["environment"]["depth"], 1),
                "lines": len(data["lines"])}  # fmt: skip
    model = build(parse_case(data), ScaledBarge(data))
    started = time.process_time()
    try:
        static = solve_statics(model)
    except SlowdriftError as failure:
        none = isinstance(failure, CaseError) and impossible(data) is not None
        outcome = f"no solution: {failure}" if none else str(failure)
        return {**row, "seconds": round(time.process_time() - started, 3), "outcome": outcome}
    row["seconds"] = round(time.process_time() - started, 3)
    found = residuals(model, static)
    row |= {"iterations": static.state.iterations, "nodes": f"{found['nodes']:.1e}", "vessel": f"{found['vessel']:.1e}"}
    assert static.body is not None
    loads = [np.zeros((line.nodes, 3)) for line in static.lines]
    whole = Assembly(static.lines, loads, DriftingBody(static.body, model.mean_drift))
    row["lowest"] = round(whole.weakest(static.state.shapes, static.position)[0], 3)
    good = found["nodes"] < ALLOWED and found["vessel"] < ALLOWED and found["fairleads"] < 1e-6
    return {**row, "outcome": "equilibrium" if good else "residual"}


def table(rows: list[Row]) -> str:
    """The outcome by family and depth, as a table in Markdown."""
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        groups[row["kind"]].append(row)
        low = max(depth for depth in DEPTHS[:-1] if depth <= row["depth"] + 0.05)
        groups[f"{low} to {DEPTHS[DEPTHS.index(low) + 1]} m"].append(row)
    order = [*KINDS, *(f"{a} to {b} m" for a, b in pairwise(DEPTHS))]
    out = ["| systems | number | equilibrium | median s | 99 % s | longest s | median iterations | most |",
           "| --- | --- | --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    for name in [*order, "all"]:
        some = rows if name == "all" else groups[name]
        good = [row for row in some if row["outcome"] == "equilibrium"]
        if good:
            seconds, steps = [float(row["seconds"]) for row in good], [int(row["iterations"]) for row in good]
            out.append(
                f"| {name} | {len(some)} | {len(good)} | {np.median(seconds):.2f} | {np.quantile(seconds, 0.99):.2f} | "
                f"{max(seconds):.2f} | {np.median(steps):.0f} | {max(steps)} |"
            )
    return "\n".join(out)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=RESULTS / "statics-sweep.csv")
    options = parser.parse_args()
    warm_up()
    options.out.parent.mkdir(exist_ok=True)
    rows = []
    with options.out.open("w", newline="", buffering=1) as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for index in range(options.first, options.first + options.count):
            rows.append(measure(index, options.seed))
            writer.writerow(rows[-1])
            if rows[-1]["outcome"] != "equilibrium":
                print(rows[-1], flush=True)
    print(table(rows))


if __name__ == "__main__":
    main()
