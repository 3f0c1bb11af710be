"""Text from anybody: YAML that would blow up, repeat itself or smuggle something in."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from solver.case import Case, load_case
from solver.case.text import MAX_BYTES, MAX_DEPTH
from solver.outcome import CaseError

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.yaml"))
RISER = (Path(__file__).parents[2] / "examples" / "hanging-riser-case1.yaml").read_text()


def _bomb(levels: int = 12, wide: int = 9) -> str:
    rows = ["a0: &a0 [" + ",".join("x" * wide) + "]"]
    rows += [f"a{i}: &a{i} [" + ",".join([f"*a{i - 1}"] * wide) + "]" for i in range(1, levels)]
    return "\n".join(rows) + "\n"


def _merge_bomb(levels: int = 25) -> str:
    rows = ["m0: &m0 {x: 1}"] + [f"m{i}: &m{i} {{<<: [*m{i - 1}, *m{i - 1}]}}" for i in range(1, levels)]
    return "\n".join(rows) + "\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (_bomb(), "expands"),
        (_bomb() + "? *a11\n: 1\n", ""),
        (
            "? ["
            + ",".join(f"&a{i} [" + ",".join([f"*a{i - 1}" if i else "x"] * 9) + "]" for i in range(12))
            + "]\n: 1\n",
            "",
        ),
        (_merge_bomb(), "expands"),
        ("a: &a [*a]", "expands"),
        ("a: &a {b: *a}", "expands"),
        ("a: " + "[" * 10_000, "nested too deeply"),
        ("a: " + "{a: " * 10_000, "nested too deeply"),
        ("- " * 5000, "nested too deeply"),
        ("[" * (MAX_DEPTH + 1) + "]" * (MAX_DEPTH + 1), "nested too deeply"),
        ("a: " + "x" * MAX_BYTES, "at most"),
        (b"a: \xff\xfe", "not UTF-8"),
        ("name: x".encode("utf-16"), "not UTF-8"),
        ("\ud800", "not UTF-8"),
        ("a: \x00", "not valid YAML"),
        ("slowdrift: 1\nslowdrift: 1\n", "given twice"),
        ('{"a": 1, "a": 2}', "given twice"),
        ("a: {b: 1, b: 2}", "given twice"),
        ("a: 1\n---\nb: 2", "another document"),
        ("", "mapping"),
        ("[1, 2]", "mapping"),
        ("just words", "mapping"),
        ("a: *nowhere", "undefined alias"),
        ("a: [1, 2", "not valid YAML"),
        ("{[1]: 2}", "key must be"),
        ("? {a: 1}\n: 2", "key must be"),
        ("a: !!python/object/apply:os.system [ls]", "not allowed"),
        ("a: !!int abc", "not allowed"),
        ("a: !!float abc", "not allowed"),
        ("a: !!bool maybe", "not allowed"),
        ("a: !!timestamp 2001-99-99", "not allowed"),
        ("a: !!binary AAAA", "not allowed"),
        ("a: !!set {x}", "not allowed"),
        ("? !!int x\n: 1", "not allowed"),
        ("!mine {a: 1}", "not allowed"),
    ],
)
def test_hostile_text_is_a_case_error(text: str | bytes, says: str) -> None:
    with pytest.raises(CaseError) as caught:
        load_case(text)
    message = str(caught.value)
    assert says in message
    assert len(message) < 2000


def test_numbers_follow_yaml_1_2() -> None:
    """`1e9` is a number and `1:30`, `0o17`, `1_000`, `yes` are not: none becomes another number in silence."""
    text = RISER.replace("EA: 500 MN", "EA: 5e8").replace("depth: 100 m", "depth: 1E2")
    case = load_case(text)
    assert case.line_types["riser"].EA == 5e8
    assert case.environment.depth == 100.0
    for wrong in ("1:30", "1_000", "0x64", "yes", "0o144"):
        with pytest.raises(CaseError, match=r"environment\.depth"):
            load_case(RISER.replace("depth: 100 m", f"depth: {wrong}"))


def test_anchors_and_merges_within_bounds_are_read() -> None:
    text = RISER.replace("drag: {normal: 1, tangential: 0}", "drag: &c {normal: 1, tangential: 0}").replace(
        "added_mass: {normal: 1, tangential: 0}", "added_mass: *c"
    )
    assert "*c" in text
    assert load_case(text) == load_case(RISER)
    merged = RISER.replace("drag: {normal: 1, tangential: 0}", "drag: &c {normal: 1, tangential: 0}").replace(
        "added_mass: {normal: 1, tangential: 0}", "added_mass: {<<: *c}"
    )
    assert load_case(merged) == load_case(RISER)


def test_bytes_with_a_byte_order_mark_are_read() -> None:
    assert load_case(b"\xef\xbb\xbf" + RISER.encode()) == load_case(RISER)


def test_errors_carry_the_line_of_their_field() -> None:
    text = RISER.replace("length: 170 m", "length: -170 m")
    with pytest.raises(CaseError) as caught:
        load_case(text)
    (error,) = caught.value.errors
    assert error.line == 1 + next(i for i, row in enumerate(text.splitlines()) if "-170 m" in row)
    assert error.field == "lines.riser.segments.0.length"


words = st.sampled_from([
    "slowdrift", "name", "environment", "depth", "lines", "segments", "type", "length", "elements", "end_a", "end_b",
    "pinned", "anchor", "azimuth", "fairlead", "analyses", "statics", "seastates", "wave", "spectrum", "jonswap", "regular",
    "vessel", "from", "<<", "45 deg", "1e400", "-1 m", "find", "null", "NaN", ".nan", ".inf", "~", "é", "\u2028",
])  # fmt: skip
leaves = words | st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
trees = st.recursive(
    leaves, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(words, inner, max_size=4), max_leaves=12
)


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(text=st.text(max_size=200) | st.binary(max_size=100) | trees.map(yaml.safe_dump) | trees.map(json.dumps))
def test_any_text_gives_a_case_or_a_case_error(text: str | bytes) -> None:
    _only_a_case_or_an_error(text)


def _paths(node: object, path: tuple[object, ...] = ()) -> list[tuple[object, ...]]:
    found = [path] if path else []
    for key, value in node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ():
        found += _paths(value, (*path, key))
    return found


TREES = [yaml.safe_load(path.read_text()) for path in EXAMPLES]


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data(), tree=st.sampled_from(TREES), new=leaves | trees)
def test_an_example_with_any_one_part_replaced_gives_a_case_or_a_case_error(data, tree, new) -> None:  # type: ignore[no-untyped-def]
    copy = json.loads(json.dumps(tree))
    *path, last = data.draw(st.sampled_from(_paths(copy)))
    parent = copy
    for key in path:
        parent = parent[key]
    parent[last] = new
    _only_a_case_or_an_error(json.dumps(copy))
    _only_a_case_or_an_error(yaml.safe_dump(copy, allow_unicode=True))


def _only_a_case_or_an_error(text: str | bytes) -> None:
    outcome: Case | CaseError
    try:
        outcome = load_case(text)
    except CaseError as error:
        outcome = error
    if isinstance(outcome, CaseError):
        assert outcome.errors
        assert all(item.message for item in outcome.errors)
    else:
        assert load_case(outcome.canonical()) == outcome


def test_json_with_letters_beyond_16_bits_is_read() -> None:
    case = load_case('{"slowdrift": 1, "name": "\\ud83d\\ude80 \\\\ud83d", "environment": {"depth": 5}, "lines": {"a": {'
                     '"segments": [{"type": "t", "length": 9, "elements": 2}], "end_a": {"pinned": [0, 0, -1]}, '
                     '"end_b": {"pinned": [5, 0, -1]}}}, "line_types": {"t": {"diameter": 1, "mass": 1, "EA": 1}}, '
                     '"analyses": {"statics": {}}}')  # fmt: skip
    assert case.name == "\U0001f680 \\ud83d"
    assert load_case(case.canonical()) == case
