"""A solver that does nothing, slowly, in the shape of solver.run. The case's description says how (JSON)."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from solver.case import Case
from solver.outcome import CaseError, FieldError, NotConverged
from solver.results.channel import Axis, Channel
from solver.results.part import Chunk, OnProgress, Part, Progress, Result

POSITIONS = np.array([[0.0, 0.0, -100.0], [10.0, 0.0, -50.0], [20.0, 0.0, 0.0]])


def run_chunk(
    case: Case, data: Any, chunk: Chunk, checkpoint: bytes | None = None, on_progress: OnProgress | None = None
) -> Part:
    orders = _orders(case)
    _note(orders, case, chunk)
    _misbehave(orders, chunk)
    steps = max(1, int(orders.get("seconds", 0.0) / 0.02))
    first = int(checkpoint or b"0")
    for step in range(first, steps):
        time.sleep(orders.get("seconds", 0.0) / steps)
        if on_progress:
            done = str(step + 1).encode()
            on_progress(Progress((step + 1) / steps, f"step {step + 1} of {steps}", lambda done=done: done))
    number = 0.0 if chunk.seeds is None else float(chunk.seeds[0])
    return Part({"kind": chunk.kind, "number": number, "resumed_from": first}, (), {"x": np.full(4, number)})


def merge(case: Case, parts: Sequence[Part]) -> Result:
    omega, arc = (
        Axis("omega", "rad/s", np.linspace(0.01, 1.2, 50)),
        Axis("arc_length", "m", np.array([0.0, 60.0, 120.0])),
    )
    values = np.arange(50, dtype=float) * stiffness(case) / 1e8
    axis = Axis("axis", "", np.arange(3.0))
    channels = (
        Channel("frequency/vessel/surge", values, (omega,), "m2 s/rad", "a response spectrum"),
        Channel("frequency/line/top/tension", np.outer(values, [1.0, 2.0, 3.0]), (omega, arc), "N2 s/rad", "tension"),
        Channel("static/line/top/position", POSITIONS, (arc, axis), "m", "positions"),
    )
    summary: dict[str, Any] = {
        "case": case.name,
        "warnings": ["a warning"],
        "numbers": [p.summary["number"] for p in parts],
    }
    summary |= {"resumed_from": max(p.summary["resumed_from"] for p in parts)}
    summary["answer"] = stiffness(case) / 3
    failures = _orders(case).get("failures", {})
    summary |= {name: {"converged": True} for name in case.analyses.requested() if name not in failures}
    if failures:
        summary["failures"] = failures
    return Result(summary, channels)


def run(case: Case, data: Any, on_progress: OnProgress | None = None) -> Result:
    return merge(case, [run_chunk(case, data, Chunk("statics"), None, on_progress)])


def stiffness(case: Case) -> float:
    """What the answers are made of, so that a run's numbers can be told from another's."""
    return float(next(iter(case.line_types.values())).EA)


def _orders(case: Case) -> dict[str, Any]:
    return dict(json.loads(case.description)) if case.description.startswith("{") else {}


def _note(orders: dict[str, Any], case: Case, chunk: Chunk) -> None:
    if "log" in orders:
        with Path(orders["log"]).open("a") as file:
            file.write(f"{case.name} {chunk.kind} {chunk.seeds} {os.getpid()}\n")


def _misbehave(orders: dict[str, Any], chunk: Chunk) -> None:
    match orders.get("fault"):
        case "case":
            raise CaseError([FieldError(("lines",), "this is wrong")])
        case "diverge":
            raise NotConverged("statics", "It went on and on.", "Use a shorter line.")
        case "bug":
            raise ZeroDivisionError("a secret of the source")
        case "memory":
            raise MemoryError
        case "hog":
            _eat(float(orders.get("megabytes", 4000)))
        case "die":
            os.kill(os.getpid(), 9)
        case "once":
            flag = Path(orders["flag"])
            if not flag.exists():
                flag.touch()
                os.kill(os.getpid(), 9)
        case "nan":
            os.environ["X"] = "1"


def _eat(megabytes: float) -> None:
    """Takes memory and touches it, without a progress call, as a computation gone wrong would."""
    held = []
    while len(held) * 20 < megabytes:
        held.append(np.ones(20 * 2**17))
        time.sleep(0.01)
