"""Line types whose nominal, drag and displaced sizes differ, as a deck with one diameter: the forces are the same."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import yaml

from solver.case import Case, parse_case
from solver.io.moordyn import read_deck, write_deck
from solver.model.line import discretise
from solver.outcome import CaseError

from .decks import VESSEL

TYPES: dict[str, dict[str, Any]] = {
    "catalogue": {"catalogue": "chain-R4-studless", "diameter": "120 mm"},
    "drag": {"diameter": 0.12, "mass": 286.0, "EA": 1e9, "volume": 0.0365, "drag_diameter": 0.2,
             "drag": {"normal": 1.4, "tangential": 0.7}, "added_mass": {"normal": 1.0, "tangential": 0.4}},
    "weight": {"diameter": 0.2, "mass": 27.16, "EA": 2e8, "submerged_weight": 68.5, "drag": {"normal": 1.6}},
    "plain": {"diameter": 0.15, "mass": 150.0, "EA": 1e9, "EI": 5e4, "drag": {"normal": 1.0}},
}  # fmt: skip


def made(*types: str, **seabed: Any) -> Case:
    lines = {
        f"line {i}": {
            "segments": [{"type": name, "length": 200.0, "elements": 20}],
            "end_a": {"anchor": {"point": [150.0, 10.0 * i]}}, "end_b": {"fairlead": [0.0, float(i), -5.0]},
        }
        for i, name in enumerate(types)
    }  # fmt: skip
    return parse_case({
        "slowdrift": 1, "name": "made", "environment": {"depth": 100.0, "seabed": seabed or {"soil": 2e5}},
        "vessel": yaml.safe_load(VESSEL)["vessel"], "line_types": {name: TYPES[name] for name in types}, "lines": lines,
        "analyses": {"statics": {}},
    })  # fmt: skip


@pytest.mark.parametrize("name", TYPES)
def test_read_again_every_force_is_the_same(name: str) -> None:
    case = made(name)
    again = read_deck(write_deck(case).text, VESSEL).case
    assert again is not None
    [line] = again.lines
    one, two = discretise(case, "line 0", 0.0, 0.0), discretise(again, line, 0.0, 0.0)
    for field in one._fields:
        if field not in (
            "a2",
            "bed",
        ):  # the transition of the bed follows the nominal diameter, which a deck does not have
            assert getattr(two, field) == pytest.approx(getattr(one, field), rel=1e-10), field


@pytest.mark.parametrize("seabed", [{"node_stiffness": 3e4}, {"soil": 2e5, "damping": 500.0}])
def test_stiffness_and_damping_of_a_node_stay(seabed: dict[str, Any]) -> None:
    case = made("catalogue", **seabed)
    again = read_deck(write_deck(case).text, VESSEL).case
    assert again is not None
    one, two = discretise(case, "line 0", 0.0, 0.0), discretise(again, *again.lines, 0.0, 0.0)
    assert two.a1[1:-1] == pytest.approx(one.a1[1:-1], rel=1e-10)
    assert two.contact[0] == pytest.approx(one.contact[0], rel=1e-10)


def test_the_report_says_what_was_scaled() -> None:
    said = "\n".join(write_deck(made("catalogue")).report.assumed)
    volume = 286.56 / 7850
    wide = np.sqrt(4 * volume / np.pi)
    assert f"line_types.catalogue: Diam {wide:.6g} m is that of its displaced volume (diameter 0.12 m)" in said
    assert f"Cd and CdAx times {0.12 / wide:.6g}" in said
    assert f"kBot is seabed.soil times {0.12 / wide:.6g}" in said
    both = "\n".join(write_deck(made("catalogue", "plain")).report.assumed)
    assert f"kBot is seabed.soil times {(0.12 / wide + 1) / 2:.6g}, the mean of {0.12 / wide:.4g} to 1" in both
    assert "line_types.plain" not in both


def test_one_diameter_is_written_as_before() -> None:
    written = write_deck(made("plain"))
    assert not [text for text in written.report.assumed if "Diam" in text]
    assert "\nplain 0.15 150 1000000000 -1 50000 1 " in written.text
    assert "\n200000 kBot" in written.text


def test_a_type_without_volume_is_refused() -> None:
    case = made("plain").model_dump(mode="json", exclude_none=True)
    case["line_types"]["plain"]["volume"] = 0.0
    with pytest.raises(CaseError, match="no line type without displaced volume"):
        write_deck(parse_case(case))
