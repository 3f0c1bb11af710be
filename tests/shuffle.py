"""The order of the tests by a seed: modules first, then the tests of each, so that what a module prepares is made once."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import TypeVar

T = TypeVar("T")
VARIABLE = "SLOWDRIFT_SHUFFLE"


def shuffled(items: list[T], group: Callable[[T], str], seed: int) -> list[T]:
    """The items in an order that the seed fixes; those of a group stay together."""
    groups: dict[str, list[T]] = {}
    for item in items:
        groups.setdefault(group(item), []).append(item)
    names = sorted(groups)
    draw = random.Random(seed)
    draw.shuffle(names)
    for name in names:
        draw.shuffle(groups[name])
    return [item for name in names for item in groups[name]]
