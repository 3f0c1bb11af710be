"""docs/summary.md names every key of real summaries and every channel, with its unit and band."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from solver.case import DOF, Case, load_case
from solver.results.channels import CHANNELS, Definition
from solver.results.part import Result
from solver.run import run
from solver.vessel.data import FileSource

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs/summary.md").read_text(encoding="utf-8")
DOCUMENTED = set(re.findall(r"^\| `([^`]+)` \|", TEXT, flags=re.MULTILINE))
CASES = {"hanging-riser-case1.yaml": None, "fpso-2000m.yaml": "barge-240x46x10.nc"}


def leaves(value: Any, place: str = "") -> Iterator[str]:
    """Dotted paths of every key that holds no further keys."""
    if isinstance(value, dict) and value:
        for key, below in value.items():
            yield from leaves(below, f"{place}.{key}" if place else key)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for item in value:
            yield from leaves(item, f"{place}[]")
    else:
        yield place


def general(path: str, lines: tuple[str, ...]) -> str:
    """A path with line names, motions and bands replaced by the words of the page."""
    words = [*((name, "NAME") for name in lines), *((dof, "DOF") for dof in DOF), ("wf", "BAND"), ("lf", "BAND")]
    parts = path.split(".")
    return ".".join(dict(words).get(part, part) for part in parts)


@cache
def example_result(name: str) -> tuple[Case, Result]:
    """An example run once, its time domain cut to 40 s of two seeds; skips without the data it needs."""
    path, needs = ROOT / "examples" / name, CASES[name]
    if needs is not None and not (path.parent / needs).exists():
        pytest.skip(f"needs {needs}")
    text = re.sub(
        r"duration: 5026.56 s, seeds: 10",
        "duration: 40 s, seeds: 2",
        path.read_text().replace("build_up: 20 min", "build_up: 0 s"),
    )
    case = load_case(text)
    return case, run(case, FileSource(path.parent))


@pytest.mark.parametrize("name", CASES)
def test_every_key_is_documented(name: str) -> None:
    case, result = example_result(name)
    summary = dict(result.summary)
    assert summary["failures"] == {}
    types = summary.pop("line_types")
    found = {general(key, tuple(case.lines)) for key in leaves(summary)}
    found |= {f"line_types.TYPE.{key}" for kind in types.values() for key in leaves(kind)}
    assert found <= DOCUMENTED


@pytest.mark.parametrize("item", CHANNELS, ids=lambda item: f"{item.domain}-{item.owner}-{item.quantity}")
def test_every_channel_is_documented(item: Definition) -> None:
    owner = "line/NAME" if item.owner == "line" else item.owner
    row = re.search(rf"^\| `{re.escape(f'{item.domain}/{owner}/{item.quantity}')}` \|(.*)$", TEXT, flags=re.MULTILINE)
    assert row is not None
    unit, _axes, band, *_ = (cell.strip() for cell in row.group(1).split("|"))
    assert (unit, band) == (item.unit, item.band)


def test_no_channel_is_made_up() -> None:
    made = {f"{i.domain}/{'line/NAME' if i.owner == 'line' else i.owner}/{i.quantity}" for i in CHANNELS}
    assert {key for key in DOCUMENTED if "/" in key} == made
