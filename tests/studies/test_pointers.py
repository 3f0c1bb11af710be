"""RFC 6901 pointers: its own examples, and what must not happen to the original."""

from __future__ import annotations

import copy

import pytest

from solver.outcome import CaseError
from store.pointers import parts_of, replaced, value_at

DOCUMENT = {"foo": ["bar", "baz"], "a/b": 1, "c%d": 2, "m~n": 8, " ": 7, "deep": {"list": [{"x": 1}, {"x": 2}]}}


@pytest.mark.parametrize(
    ("pointer", "value"),
    [("/foo", ["bar", "baz"]), ("/foo/0", "bar"), ("/a~1b", 1), ("/c%d", 2), ("/m~0n", 8), ("/ ", 7)],
)
def test_the_examples_of_the_standard(pointer: str, value: object) -> None:
    assert value_at(DOCUMENT, pointer) == value


def test_replacing_touches_only_the_copy() -> None:
    before = copy.deepcopy(DOCUMENT)
    made = replaced(DOCUMENT, {"/deep/list/1/x": 5, "/deep/list/0/y": 6, "/new": 7})
    assert made["deep"] == {"list": [{"x": 1, "y": 6}, {"x": 5}]}
    assert made["new"] == 7
    assert before == DOCUMENT
    assert made["foo"] is DOCUMENT["foo"]


@pytest.mark.parametrize(
    ("pointer", "says"),
    [
        ("foo", "starts with /"),
        ("/", "starts with /"),
        ("/foo/2", "0 to 1"),
        ("/foo/-", "0 to 1"),
        ("/foo/0/x", "beyond a single value"),
        ("/none/x", "there is no 'none'"),
        ("/" + "x" * 600, "at most 500"),
        ("/a\x00b", "control"),
    ],
)
def test_a_wrong_pointer_is_told(pointer: str, says: str) -> None:
    with pytest.raises(CaseError, match=says):
        replaced(DOCUMENT, {pointer: 1})


def test_the_tilde_is_unescaped_in_the_right_order() -> None:
    assert parts_of("/~01") == ("~1",)
