"""Cases written as decks: nothing that both can say is lost, and MoorDyn itself finds the same tensions."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.case import Case, load_case, parse_case
from solver.io.moordyn import Placed, read_deck, write_deck
from solver.outcome import CaseError

from .decks import DECK, ROOT, VESSEL

number = st.floats(0.01, 10.0).map(lambda value: round(value, 4))


@st.composite
def cases(draw: st.DrawFn) -> dict[str, object]:
    """Moorings that a deck can say: vessel lines and fixed ones, of several types, with clumps at the joints."""
    kinds = {
        f"type-{i}": {
            "diameter": draw(number), "mass": 100 * draw(number), "EA": 1e8 * draw(number),
            "EI": draw(st.sampled_from([0.0, 1e4])),
            "drag": {"normal": draw(number), "tangential": draw(number)},
            "added_mass": {"normal": draw(number), "tangential": draw(number)},
        }
        for i in range(draw(st.integers(1, 3)))
    }  # fmt: skip
    lines, attachments = {}, []
    for i in range(draw(st.integers(1, 4))):
        pieces = [
            {
                "type": draw(st.sampled_from(sorted(kinds))),
                "length": 200.0 + 10 * draw(number),
                "elements": draw(st.integers(1, 40)),
            }
            for _ in range(draw(st.integers(1, 3)))
        ]
        top = {"fairlead": [draw(number), float(i), -draw(number)]}
        bottom = draw(st.sampled_from([{"anchor": {"point": [150.0, 10.0 * i]}}, {"pinned": [90.0, float(i), -80.0]}]))
        lines[f"line {i}"] = {
            "segments": pieces,
            "end_a": bottom,
            "end_b": top,
            "multiplicity": draw(st.integers(1, 3)),
        }
        arc = 0.0
        for piece in pieces[:-1]:
            arc += piece["length"]
            if draw(st.booleans()):
                load = {key: draw(number) for key in ("mass", "volume", "drag_area", "added_mass")}
                attachments.append({"line": f"line {i}", "arc_length": arc, **load})
    environment = {
        "depth": 100.0, "water": {"density": 1000.0 + draw(number), "gravity": 9.0 + 0.1 * draw(number)},
        "seabed": {"soil": 1e5 * draw(number)},
    }  # fmt: skip
    vessel = yaml.safe_load(VESSEL)["vessel"]
    return {
        "slowdrift": 1, "name": "made", "environment": environment, "vessel": vessel, "line_types": kinds, "lines": lines,
        "attachments": attachments, "analyses": {"statics": {}},
    }  # fmt: skip


def _close(one: object, two: object, where: str = "") -> None:
    """Equal, numbers to 1e-11."""
    if isinstance(one, dict) and isinstance(two, dict):
        assert set(one) == set(two), where
        for key, value in one.items():
            _close(value, two[key], f"{where}.{key}")
    elif isinstance(one, list) and isinstance(two, list):
        assert len(one) == len(two), where
        for index, (a, b) in enumerate(zip(one, two, strict=True)):
            _close(a, b, f"{where}.{index}")
    elif isinstance(one, float | int) and isinstance(two, float | int):
        assert one == pytest.approx(two, rel=1e-11, abs=1e-11), where
    else:
        assert one == two, where


def _numbered(case: Case) -> dict[str, object]:
    """The case with its lines named by their order, for decks number them; joints of one type stay joints."""
    data = case.model_dump(mode="json", exclude_none=True)
    names = {name: f"{index}" for index, name in enumerate(data["lines"])}
    data["lines"] = {names[name]: line for name, line in data["lines"].items()}
    for item in data.get("attachments", []):
        item["line"] = names[item["line"]]
    return data


@pytest.mark.slow
@settings(max_examples=60, deadline=None)
@given(cases())
def test_what_both_can_say_survives_a_round_trip(data: dict[str, object]) -> None:
    case = parse_case(data)
    again = read_deck(write_deck(case).text, yaml.safe_dump(data)).case
    assert again is not None
    one, two = _numbered(case), _numbered(again)
    bed = two["environment"]["seabed"]  # type: ignore[index]
    assert bed.pop("damping", 0.0) == 0.0
    one["environment"]["seabed"].pop("damping", None)  # type: ignore[index]
    _close(one, two)


def test_bed_damping_and_node_stiffness_go_per_area_and_back() -> None:
    base = read_deck(DECK, VESSEL).case
    assert base is not None
    again = read_deck(write_deck(base).text, VESSEL).case
    assert again is not None
    assert again.environment.seabed.damping == pytest.approx(base.environment.seabed.damping, rel=1e-11)
    data = base.model_dump(mode="json", exclude_none=True)
    data["environment"]["seabed"] = {"node_stiffness": 5e4}
    assert f"{5e4 / (0.333 * 20):.15g} kBot" in write_deck(parse_case(data)).text


def test_attachments_inside_a_segment_cut_it_there() -> None:
    data = yaml.safe_load(read_deck(DECK, VESSEL).yaml)
    data["attachments"] = [{"line": "line-1", "arc_length": 200, "mass": 900, "volume": 0.5, "drag_area": 2}]
    case = parse_case(data)
    again = read_deck(write_deck(case).text, VESSEL).case
    assert again is not None
    (line,) = again.lines.values()
    assert [(piece.type, piece.length, piece.elements) for piece in line.segments] == [
        ("main", 200, 10), ("main", 400, 20), ("rope", 250, 12),
    ]  # fmt: skip
    (item,) = again.attachments
    assert (item.arc_length, item.mass, item.volume, item.drag_area, item.added_mass) == (200, 900, 0.5, 2, 0.5)


def test_pretensions_need_statics_and_what_is_dropped_is_listed() -> None:
    case = load_case((ROOT / "examples" / "fpso-2000m-design.yaml").read_bytes())
    with pytest.raises(CaseError, match="run statics first") as raised:
        write_deck(case)
    assert raised.value.errors[0].field == "lines.bow-port.end_a.anchor.pretension"
    placed = {name: Placed((1.0, 2.0, -2000.0), (0.0, 0.0, -10.0), 3300.0) for name in case.lines}
    written = write_deck(case, placed)
    assert written.text.count("\n1 Fixed 1 2 -2000 ") == 1
    assert written.text.count("wire ") == 1 + 24  # one type, four lines of six
    dropped = " ".join(written.report.dropped)
    assert all(word in dropped for word in ("vessel", "seastates", "breaking_load", "transition", "names of lines"))
    assert "compression" not in dropped
    pushes = load_case((ROOT / "examples" / "fpso-2000m.yaml").read_bytes())
    assert "line_types.wire.compression: allowed; MoorDyn's lines carry no" in " ".join(
        write_deck(pushes, placed).report.dropped
    )


def test_prescribed_motion_is_left_to_the_driver() -> None:
    case = load_case((ROOT / "examples" / "hanging-riser-case1.yaml").read_bytes())
    written = write_deck(case)
    assert "2 Coupled 100 0 -5 " in written.text
    assert any("motion" in text for text in written.report.dropped)


def test_names_with_blanks_stay_apart() -> None:
    text = read_deck(DECK, VESSEL).yaml.replace("main", "a b").replace("rope", "a_b")
    case = load_case(text)
    again = read_deck(write_deck(case).text, VESSEL).case
    assert again is not None
    assert list(again.line_types) == ["a_b-2", "a_b"]
    assert list(again.line_types.values()) == list(case.line_types.values())


def test_radius_and_azimuth_need_no_statics() -> None:
    data = yaml.safe_load(read_deck(DECK, VESSEL).yaml)
    data["lines"]["line-1"]["end_a"] = {"anchor": {"azimuth": "150 deg", "radius": 700}}
    text = write_deck(parse_case(data)).text
    x, y = -58 + 700 * math.cos(math.radians(150)), 700 * math.sin(math.radians(150))
    again = read_deck(text, VESSEL).case
    assert again is not None
    assert again.lines["line-1"].end_a.anchor is not None
    assert again.lines["line-1"].end_a.anchor.point == pytest.approx((x, y))


@pytest.mark.slow
def test_moordyn_itself_finds_the_same_tensions_at_rest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """MoorDyn-C, settled on a deck written here, against our statics with the default transition of the bed: 0.1 %."""
    moordyn = pytest.importorskip("moordyn")
    from solver.run import run

    text = DECK.replace("rope  0.2   30.0 ", "rope  0.1   40.0 ")
    held = read_deck(text.replace("1 Vessel", "1 Fixed")).data
    ours = run(parse_case(held), None).summary["statics"]["lines"]["line-1"]
    case = read_deck(text, VESSEL).case
    assert case is not None
    settle = "1 ICgenDynamic - settle in time\n200 TmaxIC - s\n1e-5 threshIC - share\n"
    monkeypatch.chdir(tmp_path)
    deck = write_deck(case).text
    Path("deck.txt").write_text(
        deck.replace("---------------------- OUTPUTS", settle + "---------------------- OUTPUTS")
    )
    system = moordyn.Create("deck.txt")
    try:
        top = [-58.0, 0.0, -14.0]
        moordyn.Init(system, top, [0.0, 0.0, 0.0])
        force = np.mean([moordyn.Step(system, top, [0.0] * 3, 2.0 * k, 2.0) for k in range(10)], axis=0)
    finally:
        moordyn.Close(system)
    assert force == pytest.approx(np.array(ours["end_b"]["force"]), rel=1e-3, abs=1.0)
