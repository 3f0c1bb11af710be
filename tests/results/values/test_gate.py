"""No key of a summary and no channel without a value test: those of real runs against those that the scenes work out.

A new key or channel fails here until tests/results/values works it out, or ELSEWHERE names the test that does.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Any

import pytest

from solver.results.channels import CHANNELS
from solver.results.part import Result
from tests.docs.test_summary_doc import CASES, DOCUMENTED, ROOT, example_result, general, leaves

from . import linear_channels, timed, whole
from .linear import DOFS, Raw
from .scenes import Linear, Timed

#: keys and channels that the scenes do not have, and the test that holds their values
VALUES = "tests/results/values"
CATALOGUE = f"{VALUES}/test_other_values.py::test_what_the_catalogue_gave"
REFUSED = f"{VALUES}/test_time_values.py::test_a_refused_run_says_the_same_under_another_name"
ELSEWHERE = {
    "frequency_domain.same_waves.vessel_std.BAND.DOF": f"{VALUES}/test_other_values.py::test_sigma_in_the_same_waves",
    "line_types.TYPE.catalogue.name": CATALOGUE,
    **{
        f"line_types.TYPE.catalogue.values.KEY.{key}": CATALOGUE
        for key in ("value", "unit", "formula", "source", "status")
    },
    **{f"time_domain_doubtful.{key}": REFUSED for key in ("converged", "doubt", "seeds", "duration")},
}


def keys_of(summary: dict[str, Any], lines: Iterable[str]) -> set[str]:
    """The keys of a summary with names of lines, motions, bands and types made general, as docs/summary.md has them."""
    rest = {key: value for key, value in summary.items() if key != "line_types"}
    found = {general(key, tuple(lines)) for key in leaves(rest)}
    types = {key for kind in summary.get("line_types", {}).values() for key in leaves(kind)}
    return found | {f"line_types.TYPE.{re.sub(r'(?<=catalogue.values.).*(?=[.])', 'KEY', key)}" for key in types}


def channel_of(name: str) -> str:
    """A channel's name with its line and motion made general."""
    domain, owner, *rest = name.split("/")
    quantity = re.sub(rf"^({'|'.join(DOFS)})", "{dof}", rest[-1])
    return f"{domain}/line/NAME/{quantity}" if owner == "line" else f"{domain}/{owner}/{quantity}"


@pytest.fixture(scope="session")
def known_keys(linear: dict[str, Linear], timed_scenes: dict[str, Timed]) -> set[str]:
    """General keys of every summary that the scenes work out, without the product."""
    found = set(ELSEWHERE)
    for scene in linear.values():
        found |= keys_of(whole.summary(scene), scene.case.lines)
    for late in timed_scenes.values():
        found |= keys_of({"time_domain": timed.summary(late)}, late.case.lines)
    return found


@pytest.fixture(scope="session")
def known_channels(linear: dict[str, Linear], timed_scenes: dict[str, Timed]) -> set[str]:
    names = [name for scene in linear.values() for name in linear_channels.channels(Raw(scene))]
    names += [name for late in timed_scenes.values() for name in timed.channels(late)]
    return {channel_of(name) for name in names}


def without_value(result: Result, lines: Iterable[str], keys: set[str], channels: set[str]) -> set[str]:
    """Keys and channels of a result that no test works out."""
    return (keys_of(result.summary, lines) - keys) | ({channel_of(one.name) for one in result.channels} - channels)


@pytest.mark.parametrize("name", CASES)
def test_no_key_of_an_example_is_without_a_value_test(
    name: str, known_keys: set[str], known_channels: set[str]
) -> None:
    case, result = example_result(name)
    assert without_value(result, case.lines, known_keys, known_channels) == set()


def test_every_registered_channel_has_a_value_test(known_channels: set[str]) -> None:
    made = {f"{i.domain}/{'line/NAME' if i.owner == 'line' else i.owner}/{i.quantity}" for i in CHANNELS}
    assert made == known_channels


def test_every_documented_key_has_a_value_test(known_keys: set[str]) -> None:
    assert {
        key for key in DOCUMENTED if "/" not in key and not re.fullmatch(r"\d+|[A-Za-z ]+ [a-z ].*", key)
    } - known_keys == set()


def test_an_invented_key_is_found(known_keys: set[str], known_channels: set[str]) -> None:
    case, result = example_result("hanging-riser-case1.yaml")
    line = {**result.summary["statics"]["lines"]["riser"], "sag": 1.0}
    invented = Result(
        {**result.summary, "statics": {**result.summary["statics"], "lines": {"riser": line}}}, result.channels
    )
    assert without_value(invented, case.lines, known_keys, known_channels) == {"statics.lines.NAME.sag"}


def test_an_invented_channel_is_found(known_keys: set[str], known_channels: set[str]) -> None:
    from dataclasses import replace

    case, result = example_result("hanging-riser-case1.yaml")
    invented = Result(result.summary, (*result.channels, replace(result.channels[0], name="static/line/riser/sag")))
    assert without_value(invented, case.lines, known_keys, known_channels) == {"static/line/NAME/sag"}


def test_tests_named_elsewhere_exist() -> None:
    for place in set(ELSEWHERE.values()):
        file, name = place.split("::")
        assert f"def {name}(" in (ROOT / file).read_text(encoding="utf-8")
