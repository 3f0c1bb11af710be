"""A shuffled run is a permutation that its seed fixes, with the tests of a module together."""

from __future__ import annotations

import logging
from itertools import pairwise

import pytest

from tests.shuffle import shuffled

ITEMS = [f"{module}::{k}" for module in ("store", "api", "waves", "statics", "modes") for k in range(12)]


def module(item: str) -> str:
    return item.split("::")[0]


def test_the_seed_fixes_the_order() -> None:
    assert shuffled(ITEMS, module, 5) == shuffled(list(ITEMS), module, 5)
    assert shuffled(ITEMS, module, 5) != shuffled(ITEMS, module, 6)


@pytest.mark.parametrize("seed", range(5))
def test_nothing_is_lost_and_modules_stay_together(seed: int) -> None:
    order = shuffled(ITEMS, module, seed)
    assert sorted(order) == sorted(ITEMS)
    changes = sum(module(a) != module(b) for a, b in pairwise(order))
    assert changes == 4
    assert order != ITEMS


@pytest.mark.parametrize("level", [logging.ERROR, logging.DEBUG])
def test_a_test_may_set_the_level_of_the_log(level: int) -> None:
    logging.getLogger().setLevel(level)


@pytest.mark.parametrize("_again", range(2))
def test_the_level_of_the_log_is_that_of_a_fresh_start(_again: int, caplog: pytest.LogCaptureFixture) -> None:
    """Libraries such as Capytaine set the level of the whole process; before each test it is put back."""
    assert logging.getLogger().level == logging.WARNING
    assert logging.root.manager.disable == logging.NOTSET
    logging.getLogger("anything").warning("seen")
    assert "seen" in caplog.text
    logging.getLogger().setLevel(logging.CRITICAL)
    logging.disable(logging.CRITICAL)
