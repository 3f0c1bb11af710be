"""Decks read into cases: conventions, what is reported, what is refused and with which line."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.case import load_case
from solver.io.moordyn import read_deck
from solver.outcome import CaseError

from .decks import DECK, HEAD, LINES, OPTIONS, POINTS, TYPES, V1, VESSEL, volturnus


def test_a_deck_with_a_vessel_becomes_a_case() -> None:
    found = read_deck(DECK, VESSEL)
    case = found.case
    assert case is not None
    assert load_case(found.yaml) == case
    line = case.lines["line-1"]
    assert [(piece.type, piece.length, piece.elements) for piece in line.segments] == [
        ("main", 600, 30),
        ("rope", 250, 12),
    ]
    assert line.end_a.anchor is not None
    assert line.end_a.anchor.point == (-837.6, 0.0)
    assert line.end_b.fairlead == (-58.0, 0.0, -12.3)  # -14 from the water level, the centre of gravity at -1.7
    (clump,) = case.attachments
    assert (clump.arc_length, clump.mass, clump.volume, clump.drag_area, clump.added_mass) == (600, 1500, 1.2, 3.5, 0.6)
    assert case.environment.depth == 200
    assert case.environment.seabed.soil == 3e6
    assert case.environment.seabed.damping == pytest.approx(3e5 * 0.333 * 20)


def test_tangential_drag_is_on_the_surface_there_and_on_the_diameter_here() -> None:
    case = read_deck(DECK, VESSEL).case
    assert case is not None
    assert case.line_types["main"].drag.tangential == pytest.approx(0.4 * math.pi, rel=1e-15)
    assert case.line_types["main"].drag.normal == 2.0
    assert case.line_types["main"].added_mass.tangential == 0.27
    assert case.line_types["rope"].EI == 1e3


def test_the_older_order_of_columns_is_read() -> None:
    found = read_deck(V1, VESSEL)
    assert found.case is not None
    kind = found.case.line_types["Bot"]
    assert (kind.added_mass.normal, kind.added_mass.tangential, kind.drag.normal) == (1.0, 0.5, 1.4)
    assert kind.drag.tangential == pytest.approx(0.2 * math.pi)
    assert [piece.length for piece in found.case.lines["line-1"].segments] == [3.25, 1.5]
    assert found.case.environment.water.density == 1000


def test_without_a_vessel_there_is_a_template_that_the_check_names() -> None:
    found = read_deck(DECK)
    assert found.case is None
    with pytest.raises(CaseError) as raised:
        load_case(found.yaml)
    fields = {error.field for error in raised.value.errors}
    assert fields == {error.field for error in found.errors}
    assert {"vessel.mass", "vessel.centre_of_gravity", "lines.line-1.end_b.fairlead.2"} <= fields
    assert found.report.missing


def test_lines_between_fixed_points_need_no_vessel() -> None:
    found = read_deck(DECK.replace("1 Vessel", "1 Fixed"))
    assert found.case is not None
    assert found.case.vessel is None
    ends = (found.case.lines["line-1"].end_a, found.case.lines["line-1"].end_b)
    assert {end.pinned for end in ends if end.pinned} == {(-58.0, 0.0, -14.0)}


def test_the_base_keeps_its_sea_and_analyses_and_a_different_depth_is_refused() -> None:
    base = (
        VESSEL
        + "environment: {depth: 200 m, current: {depths: [0], speeds: [1], direction: 0 deg}}\nanalyses: {modes: {}}"
    )
    case = read_deck(DECK, base).case
    assert case is not None
    assert case.environment.current is not None
    assert case.analyses.requested() == ("modes",)
    with pytest.raises(CaseError, match="180 m, the deck one of 200 m"):
        read_deck(DECK, base.replace("200 m", "180 m"))


def test_a_turned_vessel_gets_its_fairleads_in_its_own_axes() -> None:
    from solver.case import end_point

    found = read_deck(DECK, VESSEL.replace("mass:", "heading: 30 deg\n  mass:").replace("[0, 0, -1.7]", "[3, 1, -1.7]"))
    assert found.case is not None
    assert end_point(found.case, found.case.lines["line-1"].end_b) == pytest.approx((-58, 0, -14), abs=1e-9)


def test_equal_lines_become_one_with_a_multiplicity() -> None:
    copies = DECK.replace("2 main 2 3 600 30 -", "2 main 2 3 600 30 -\n3 main 2 1 900 40 -\n4 main 2 1 900 40 -")
    case = read_deck(copies, VESSEL).case
    assert case is not None
    assert {name: line.multiplicity for name, line in case.lines.items()} == {"line-1": 1, "line-3": 2}


def test_a_body_that_is_the_vessel_carries_its_points() -> None:
    body = "------ BODIES ------\nID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG* I* Volume CdA* Ca*\n(#) (-) (m)\n"
    row = "1 Coupled 0 0 -4 0 0 0 0 0 0 0 0 0\n"
    points = POINTS.replace("1 Vessel -58 0 -14", "1 Body1 -58 0 -10")
    assert read_deck(HEAD + TYPES + body + row + points + LINES + OPTIONS, VESSEL).case == read_deck(DECK, VESSEL).case
    with pytest.raises(CaseError, match="second vessel"):
        read_deck(HEAD + TYPES + body + row.replace("Coupled", "Free") + points + LINES + OPTIONS, VESSEL)


REPORTED = [
    ("200 WtrDpth - depth", "200 WtrDpth - depth\n0.4 FrictionCoefficient - bed", "friction"),
    ("200 WtrDpth - depth", "200 WtrDpth - depth\nSEASTATE WaterKin - file", "WaterKin"),
    ("200 WtrDpth - depth", "200 WtrDpth - depth\n7 dtFoo - what", "dtFoo"),
    ("1 Vessel -58 0 -14 0", "1 Vessel -58 0 -14 500", "vessel.mass"),
    ("200 WtrDpth - depth\n", "", "depth 200 m, that of the deepest fixed point"),
    (OPTIONS, "------ FAILURE ------\nID Point Lines Time Ten\n() () () () ()\n1 1 1 0 1e6\n" + OPTIONS, "FAILURE"),
    ("g", "g", "internal damping"), ("g", "g", "density 1025"), ("g", "g", "seabed.transition"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "said"), REPORTED)
def test_what_a_case_cannot_say_is_reported(old: str, new: str, said: str) -> None:
    found = read_deck(DECK.replace(old, new, 1) if old != "g" else DECK, VESSEL)
    report = found.report
    assert any(said in text for text in (*report.dropped, *report.assumed))
    assert any(said in " ".join(line.split()) for line in found.yaml.splitlines() if line.startswith("#"))


RODS = (
    "------ RODS ------\nID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs Outputs\n(#)\n1 Can Body1 0 0 2 0 0 15 8 p\n"
)
VIV = "main 0.333 685 3.27E9 -1 0 2 0.82 0.4 0.27 0.8 0.08 0.18"
CHAIN = "main  0.333 685.00   3.27E+09  -1.0 0  2.0 0.82 0.4  0.27"
REFUSED = [
    (POINTS, RODS + POINTS, "rods are rigid bodies", "1 Can"),
    ("3.27E+09", "3.27E+09|5e9", "static and a dynamic stiffness", "main  0.333"),
    ("3.27E+09", "chain.dat", "nonlinear law", "main  0.333"),
    (CHAIN, VIV, "vortex", "main 0.333"), ("0.333", "-0.333", "out of range", "main"),
    ("0.333", "NaN", "is not a number", "main"), ("685.00", "1e999", "out of range", "main"),
    ("3 Free", "3 Sliding", "not known as an attachment", "3 Sliding"),
    ("2 main 2 3 600 30 -", "2 main 2 9 600 30 -", "no point '9'", "2 main"),
    ("2 main 2 3 600 30 -", "2 steel 2 3 600 30 -", "no line type 'steel'", "2 steel"),
    ("2 main 2 3 600 30 -", "2 main 2 3 600 30.5 -", "must be whole", "2 main"),
    ("2 main 2 3 600 30 -", "2 main 2 3 600 0 -", "out of range", "2 main"),
    ("2 main 2 3 600 30 -", "2 main 2 2 600 30 -", "both ends", "2 main"),
    ("2 main 2 3 600 30 -", "2 main 2 3", "4 columns; allowed: 6 to 7", "2 main"),
    ("2 main 2 3 600 30 -", "1 main 2 3 600 30 -", "given twice", "1 main"),
    ("1 rope 1 3 250 12 p\n", "", "1 line(s) end at this free point", "3 Free"),
    ("1 rope 1 3 250 12 p\n", "1 rope 1 3 250 12 p\n3 rope 1 3 240 12 p\n", "bridle", "3 Free"),
    ("200 WtrDpth - depth", "bed.txt WtrDpth - depth", "bathymetry", "bed.txt"),
    ("200 WtrDpth - depth", "200 WtrDpth - depth\n190 depth - again", "given twice", "190"),
    ("(-) (-) (-) (-) (m) (-) (-)\n1 rope", "1 rope", "line of units is missing", "1 rope"),
    ("ID LineType AttachA AttachB UnstrLen NumSegs", "ID LineType NumSegs AttachA AttachB UnstrLen", "reads by place", "ID"),
    ("------ LINES ------", "------ SYROPE ------", "none of its key words", "------ SYROPE"),
    ("3 Free  -300 0 -100 1500 1.2 3.5 0.6", "3 Free  -300 0 -100 1500 1.2 3.5", "8 columns", "3 Free"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "said", "at"), REFUSED)
def test_a_wrong_deck_is_refused_with_its_line(old: str, new: str, said: str, at: str) -> None:
    if "SYROPE" in new:
        text = DECK.replace("---------------------- LINES -----------------------", "------ SYROPE ------", 1)
    else:
        text = DECK.replace(old, new, 1)
    assert text != DECK
    with pytest.raises(CaseError) as raised:
        read_deck(text, VESSEL)
    lines = text.splitlines()
    errors = [error for error in raised.value.errors if said in error.message]
    assert errors, raised.value
    assert any(error.line is not None and lines[error.line - 1].startswith(at) for error in errors)


def test_steady_forces_of_the_older_format_are_refused() -> None:
    with pytest.raises(CaseError, match="steady force"):
        read_deck(V1.replace("2.47e-04 0 0 0 1 1", "2.47e-04 0 0 5 1 1"), VESSEL)


def test_fortran_numbers_are_read() -> None:
    case = read_deck(DECK.replace("3.27E+09", "3.27D+09").replace("3.0e6 kbot", "3.0+006 kbot"), VESSEL).case
    assert case == read_deck(DECK, VESSEL).case


def test_size_is_bounded_and_bytes_that_are_no_text_are_refused() -> None:
    with pytest.raises(CaseError, match="at most 1000000"):
        read_deck(b"x" * 1_000_001)
    with pytest.raises(CaseError, match="not a text file"):
        read_deck(b"\x00\x01" * 40)
    with pytest.raises(CaseError, match="no lines; is it a MoorDyn deck"):
        read_deck("hello\nworld\n")
    with pytest.raises(CaseError, match="at most 20000"):
        read_deck("\n" * 30_000)


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_a_damaged_deck_gives_a_case_or_a_clear_refusal(data: st.DataObject) -> None:
    text = data.draw(st.sampled_from([DECK, V1]))
    for _ in range(data.draw(st.integers(1, 4))):
        lines = text.split("\n")
        at = data.draw(st.integers(0, len(lines) - 1))
        kind = data.draw(st.integers(0, 4))
        words = lines[at].split()
        if kind == 0:
            del lines[at]
        elif kind == 1:
            lines.insert(at, data.draw(st.text(max_size=60)))
        elif kind == 2 and words:
            place = data.draw(st.integers(0, len(words) - 1))
            words[place] = data.draw(
                st.sampled_from(
                    ["nan", "1e400", "-1", "0", "****", "1.0-100", "Free", "Vessel", "|", "7", "R1A", "é", "1e30"]
                )
            )
            lines[at] = " ".join(words)
        elif kind == 3:
            lines = lines[:at]
        else:
            lines[at] = lines[at][: len(lines[at]) // 2]
        text = "\n".join(lines)
    try:
        found = read_deck(text, VESSEL)
    except CaseError as error:
        refused = [fault.message for fault in error.errors]
    else:
        refused = None
        assert found.case is not None
        assert load_case(found.yaml) == found.case
    assert refused is None or all(refused)


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=400) | st.text(max_size=400))
def test_bytes_of_any_kind_never_break_the_reader(payload: bytes | str) -> None:
    with pytest.raises(CaseError):
        read_deck(payload)


def test_decks_of_windows_and_counts_of_the_oldest_format_are_read() -> None:
    counted = DECK.replace("Name  Diam", "2  NTypes - number of line types\nName  Diam").replace(
        "ID LineType", "2 NLines - lines\nID LineType"
    )
    assert counted != DECK
    assert read_deck(counted.replace("\n", "\r\n").encode("latin-1"), VESSEL).case == read_deck(DECK, VESSEL).case


def test_names_that_a_case_cannot_take_stay_apart() -> None:
    text = (
        DECK.replace("\nmain ", "\na/b ")
        .replace("\nrope ", "\na:b ")
        .replace(" main ", " a/b ")
        .replace(" rope ", " a:b ")
    )
    case, plain = read_deck(text, VESSEL).case, read_deck(DECK, VESSEL).case
    assert case is not None
    assert plain is not None
    assert list(case.line_types) == ["a_b", "a_b-2"]
    assert list(case.line_types.values()) == list(plain.line_types.values())
    assert [piece.type for piece in case.lines["line-1"].segments] == ["a_b", "a_b-2"]


def test_control_characters_of_a_deck_do_not_reach_the_text_of_the_case() -> None:
    text = DECK.replace("a semi", "a\x1b\x07 semi").replace("0.001 dtM", "1 \x1bfoo - x\n2 ba\x85r - y\n0.001 dtM")
    found = read_deck(text, VESSEL)
    assert found.case is not None
    assert load_case(found.yaml) == found.case
    assert found.case.name.isprintable()


def test_the_public_deck_of_volturnus() -> None:
    text = (volturnus() / "umainesemi_MoorDyn.dat").read_bytes()
    case = read_deck(text, VESSEL).case
    assert case is not None
    assert len(case.lines) == 3
    assert case.lines["line-2"].end_b.fairlead == (29.0, 50.229, -12.3)
    assert case.environment.depth == 200
