"""What a check says."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from ...case.quantities import DOF

Array = np.ndarray


@dataclass(frozen=True)
class Check:
    """One quality check. value and threshold: None when skipped; message: a sentence with both and the remedy."""

    name: str
    state: Literal["ok", "warning", "skipped"]
    message: str
    value: float | None = None
    threshold: float | None = None

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


def judge(name: str, value: float, threshold: float, good: str, bad: str) -> Check:
    """Ok while value <= threshold; the texts name what was compared, `bad` the remedy too."""
    fine = value <= threshold
    return Check(name, "ok" if fine else "warning", good if fine else bad, float(value), threshold)


def skipped(name: str, reason: str) -> Check:
    return Check(name, "skipped", reason)


def pair(i: Any, j: Any) -> str:
    """Two degrees of freedom by name, from their indices (integers of any kind)."""
    return DOF[int(i)] if i == j else f"{DOF[int(i)]} and {DOF[int(j)]}"


def percent(value: float) -> str:
    return f"{100 * value:.3g} %"
