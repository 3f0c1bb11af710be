"""Compares a nested outcome with what a test expects of it: every leaf on both sides, none left over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Close:
    """A number or array that is met within `rel` of its own largest entry."""

    value: Any
    rel: float


@dataclass(frozen=True)
class Holds:
    """A value of which a condition is asked, where no formula gives it (a time, a count of iterations)."""

    condition: Callable[[Any], bool]


REL = 1e-6


def differences(expected: Any, actual: Any, place: str = "") -> list[str]:
    """Places where two outcomes differ, keys that one of them lacks among them."""
    if isinstance(expected, dict) and isinstance(actual, dict):
        out = []
        for key in [*expected, *(one for one in actual if one not in expected)]:
            inner = f"{place}.{key}" if place else str(key)
            if key not in actual:
                out.append(f"{inner}: expected, and not there")
            elif key not in expected:
                out.append(f"{inner}: there, and no value is known for it")
            else:
                out += differences(expected[key], actual[key], inner)
        return out
    if isinstance(expected, list) and expected and isinstance(expected[0], dict):
        if len(expected) != len(actual):
            return [f"{place}: {len(actual)} items, not {len(expected)}"]
        return [
            one
            for k, pair in enumerate(zip(expected, actual, strict=True))
            for one in differences(*pair, f"{place}[{k}]")
        ]
    return [] if _same(expected, actual) else [f"{place}: {_short(actual)}, expected {_short(expected)}"]


def _same(expected: Any, actual: Any) -> bool:
    if isinstance(expected, Holds):
        return bool(expected.condition(actual))
    rel = REL
    if isinstance(expected, Close):
        expected, rel = expected.value, expected.rel
    if expected is None or isinstance(expected, str | bool) or (isinstance(expected, list) and not expected):
        return bool(expected == actual) and type(expected) is type(actual)
    if isinstance(expected, list) and isinstance(expected[0], str):
        return bool(expected == actual)
    if actual is None or isinstance(actual, str | dict | bool):
        return False
    left, right = np.asarray(expected, dtype=float), np.asarray(actual, dtype=float)
    if left.shape != right.shape or not np.all(np.isfinite(right)):
        return False
    size = float(np.abs(left).max(initial=0.0))
    return bool(np.all(np.abs(left - right) <= rel * size + 1e-12 * (size == 0.0)))


def _short(value: Any) -> str:
    text = repr(value.value if isinstance(value, Close) else value)
    return text if len(text) < 120 else text[:117] + "..."
