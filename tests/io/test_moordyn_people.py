"""Decks as people have them: headings, columns, several vessels, anchors off the bed, ends held without a vessel."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from cli.main import main
from solver.case import load_case
from solver.io.moordyn import read_deck
from solver.outcome import CaseError

from .decks import DECK, HEAD, LINES, OPTIONS, POINTS, TYPES, V1, VESSEL

BODIES = "------ BODIES ------\nID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG* I* Volume CdA* Ca*\n(#) (-) (m)\n"


def errors(text: str, base: str | None = VESSEL, **options: bool) -> list[tuple[int | None, str]]:
    with pytest.raises(CaseError) as raised:
        read_deck(text, base, **options)
    return [(error.line, error.message) for error in raised.value.errors]


def line_of(text: str, start: str) -> int:
    return next(number for number, line in enumerate(text.splitlines(), 1) if line.startswith(start))


# --- headings


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("---------------------- LINE TYPES ------------------", "------ LINE TYPES Chain studless 0.018m ------"),
        ("---------------------- POINTS ----------------------", "--- All POINTS, anchors first"),
        ("---------------------- LINES -----------------------", "---------- LINES (anchor to fairlead) ----------"),
        ("---------------------- LINES -----------------------", "LINES ------------------------------------------"),
        ("---------------------- SOLVER OPTIONS ---------------", "--- options of the solver ---"),
        ("------ MoorDyn Input File ------", "--- project 12 ---\n------ MoorDyn Input File ------"),
        ("------ MoorDyn Input File ------", "----- a ----- b -----\n\n--------\n------ MoorDyn Input File ------"),
        ("------------------------- need this line ------------", "--- need this line ---\nstored by hand\n--- end ---\n1 2"),
        ("FairTen1\nEND\n", "FairTen1\nEND\nand a remark\n"),
    ],
)  # fmt: skip
def test_key_words_are_found_anywhere_in_a_heading_and_other_headings_are_skipped(old: str, new: str) -> None:
    text = DECK.replace(old, new)
    assert text != DECK
    found = read_deck(text, VESSEL).case
    assert found is not None
    assert found.lines == read_deck(DECK, VESSEL).case.lines  # type: ignore[union-attr]
    assert found.environment == read_deck(DECK, VESSEL).case.environment  # type: ignore[union-attr]


def test_a_heading_with_two_key_words_opens_the_section_that_moordyn_looks_for_first() -> None:
    same = DECK.replace("- LINE TYPES -", "- LINE TYPES of all LINES -")
    assert read_deck(same, VESSEL).case == read_deck(DECK, VESSEL).case
    text = DECK.replace("- LINES -", "- LINES between POINTS -")
    found = errors(text)
    assert (line_of(text, "---------------------- LINES between"), "given twice") in [
        (line, "given twice") for line, message in found if "given twice" in message
    ]


@pytest.mark.parametrize("heading", ["------ LNIES ------", "-----", "--- anchors ---"])
def test_rows_below_a_heading_that_moordyn_skips_are_refused(heading: str) -> None:
    text = DECK.replace("---------------------- LINES -----------------------", heading)
    number = text.splitlines().index(heading) + 1
    assert (number, True) in [(line, "skips the rows" in message) for line, message in errors(text)]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("0.001 dtM - time step", "0.001 dtM --- time step"),
        ("2 main 2 3 600 30 -", "2 main 2 3 600 30 ---"),
        ("1 Vessel -58 0 -14 0 0 0 0", "1 Vessel -58 0 -14 0 0 0 0 --- bow"),
    ],
)
def test_dashes_inside_a_row_end_the_section_in_moordyn_and_are_refused(old: str, new: str) -> None:
    text = DECK.replace(old, new)
    assert (line_of(text, new), True) in [(line, "write one dash" in message) for line, message in errors(text)]


def test_dashes_in_a_comment_end_nothing() -> None:
    text = DECK.replace("0.001 dtM - time step", "0.001 dtM ! --- time step").replace(
        "3 Free", "# --- the clump\n3 Free"
    )
    assert read_deck(text, VESSEL).case == read_deck(DECK, VESSEL).case


# --- columns


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ("Cd  Ca  CdAx  CaAx", "Cd_n Cd_t Ca_n Ca_t", "Cd_n"),
        ("Attachment X Y Z M V CdA CA", "Attachment X Y Z W V CdA CA", "W"),
        ("AttachA AttachB UnstrLen NumSegs", "AttachA AttachB UnstrLen dL", "dL"),
        ("BA/-zeta  EI", "EI  GJ", "GJ"),
    ],
)
def test_a_column_that_moordyn_does_not_have_is_refused(old: str, new: str, word: str) -> None:
    text = DECK.replace(old, new)
    assert text != DECK
    ((_, message),) = errors(text)
    assert f"the column {word!r} is not one of MoorDyn's" in message


def test_the_names_that_the_refusal_proposes_are_read() -> None:
    text = DECK.replace("Cd  Ca  CdAx  CaAx", "Cd_n Cd_t Ca_n Ca_t")
    ((_, message),) = errors(text)
    names = message.split("(v2: ")[1].split(" or ")[0].split()
    header = "Name  Diam  MassDen  EA  BA/-zeta  EI  Cd  Ca  CdAx  CaAx"
    assert read_deck(DECK.replace(header, " ".join(names[:10])), VESSEL).case == read_deck(DECK, VESSEL).case


def test_a_header_without_any_known_name_is_taken_by_place_and_said() -> None:
    text = DECK.replace("Name  Diam  MassDen  EA  BA/-zeta  EI  Cd  Ca  CdAx  CaAx", "c1 c2 c3 c4 c5 c6 c7 c8 c9 c10")
    found = read_deck(text, VESSEL)
    assert found.case == read_deck(DECK, VESSEL).case
    assert any("types: the names of the columns are not known; taken by place" in text for text in found.report.assumed)


# --- several vessels


def two_bodies(second: str, kind: str = "Coupled") -> str:
    """A line from an anchor to each of two bodies, and one between them; the second body at `second` along x."""
    rows = f"1 Coupled 0 0 0 0 0 0 0 0 0 0 0 0\n2 {kind} {second} 0 0 0 0 0 0 0 0 0 0 0\n"
    points = (
        "------ POINTS ------\nID Attachment X Y Z M V CdA CA\n(-)\n1 Fixed -700 0 -200 0 0 0 0\n2 Body1 -20 0 -10 0 0 0 0\n"
        "3 Body1 20 0 -10 0 0 0 0\n4 Body2 -20 0 -10 0 0 0 0\n"
    )
    lines = "------ LINES ------\nID LineType AttachA AttachB UnstrLen NumSegs Outputs\n(-)\n1 main 1 2 730 40 -\n"
    lines += "2 main 3 4 1000 40 -\n"
    return HEAD + TYPES + BODIES + rows + points + lines + OPTIONS


@pytest.mark.parametrize("second", ["1000", "60", "0"])
def test_a_second_coupled_body_is_refused_wherever_it_is(second: str) -> None:
    text = two_bodies(second)
    ((line, message),) = errors(text)
    assert line == line_of(text, "2 Coupled")
    assert "a second coupled body is a second vessel" in message


@pytest.mark.parametrize("kind", ["Free", "CoupledPinned", "Pinned"])
def test_a_body_that_moves_on_its_own_is_refused_once(kind: str) -> None:
    text = two_bodies("1000", kind)
    ((line, message),) = errors(text)
    assert line == line_of(text, f"2 {kind}")
    assert "moves on its own" in message


def test_a_fixed_second_body_is_a_place() -> None:
    found = read_deck(two_bodies("1000", "Fixed"), VESSEL)
    assert found.case is not None
    assert found.case.lines["line-2"].end_a.pinned == (980.0, 0.0, -10.0)


@pytest.mark.parametrize("kind", ["Vessel", "Coupled"])
def test_coupled_points_farther_apart_than_a_hull_are_refused(kind: str) -> None:
    points = POINTS.replace("1 Vessel", f"1 {kind}") + f"4 {kind} 620 0 -14 0 0 0 0\n"
    text = HEAD + TYPES + points + LINES + "3 main 2 4 1500 30 -\n" + OPTIONS
    ((line, message),) = errors(text)
    assert line == line_of(text, f"4 {kind}")
    assert "points 1 and 4 are 678 m apart; allowed on one vessel: 500 m" in message
    near = text.replace(f"4 {kind} 620", f"4 {kind} 60")
    assert len(read_deck(near, VESSEL).case.lines) == 2  # type: ignore[union-attr]


def test_a_turbine_of_a_farm_is_refused_with_its_name() -> None:
    messages = [message for _, message in errors(DECK.replace("1 Vessel", "1 Turbine2"))]
    assert any("'Turbine2' is a turbine of FAST.Farm, whose decks hold several vessels" in text for text in messages)


def test_what_looks_like_two_vessels_is_said() -> None:
    """A shared line, and points eight radii of gyration apart (47 m here)."""
    points = POINTS + "4 Vessel 360 0 -14 0 0 0 0\n"
    found = read_deck(HEAD + TYPES + points + LINES + "3 main 1 4 500 30 -\n" + OPTIONS, VESSEL)
    assert any(
        "line-3 runs from the vessel to itself, points 1 and 4, 418 m apart" in text for text in found.report.assumed
    )
    assert any("418 m apart, 8.9 times its radius of gyration of 47.03 m" in text for text in found.report.assumed)
    plain = read_deck(DECK, VESSEL).report.assumed
    assert not any("radius of gyration" in text or "to itself" in text for text in plain)


# --- anchors and the bed


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("200 WtrDpth", "250 WtrDpth", "fixed point 2 is 50 m above the bed"),
        ("2 Fixed -837.6 0 -200", "2 Fixed -837.6 0 -20", "fixed point 2 is 180 m above the bed"),
        ("2 Fixed -837.6 0 -200", "2 Fixed -837.6 0 -199.5", "fixed point 2 is 0.5 m above the bed"),
    ],
)
def test_an_anchor_that_is_not_on_the_bed_is_said(old: str, new: str, said: str) -> None:
    found = read_deck(DECK.replace(old, new), VESSEL)
    assert any(said in text for text in found.report.assumed)
    assert any("no anchor is on the bed" in text for text in found.report.assumed)
    assert said in " ".join(found.yaml.replace("# ", " ").split())


def test_anchors_on_the_bed_and_held_upper_ends_need_no_word() -> None:
    for text in (DECK, DECK.replace("1 Vessel", "1 Fixed")):
        assert not any("the bed" in line and "fixed point" in line for line in read_deck(text, VESSEL).report.assumed)


def test_one_of_two_anchors_off_the_bed_is_named() -> None:
    text = DECK.replace("3 Free", "4 Fixed 800 0 -20 0 0 0 0\n3 Free").replace(
        "2 main 2 3 600 30 -", "2 main 2 3 600 30 -\n3 main 4 1 900 30 -"
    )
    said = read_deck(text, VESSEL).report.assumed
    assert any("fixed point 4 is 180 m above" in line for line in said)
    assert not any("fixed point 2" in line or "no anchor" in line for line in said)


def test_a_fixed_point_below_the_bed_is_refused_or_said() -> None:
    text = DECK.replace("2 Fixed -837.6 0 -200", "2 Fixed -837.6 0 -230")
    found = errors(text)
    assert any("-230" in message or "bed" in message for _, message in found)


@pytest.mark.parametrize("word", ["seabed", "Ground", "SEAFLOOR"])
def test_z_may_be_the_seabed(word: str) -> None:
    """MoorDyn-F: a word with seabed, ground or floor in it is minus the depth."""
    text = DECK.replace("2 Fixed -837.6 0 -200", f"2 Fixed -837.6 0 {word}")
    assert read_deck(text, VESSEL).case == read_deck(DECK, VESSEL).case
    without = text.replace("200 WtrDpth - depth\n", "")
    assert any("z is" in message and "gives no WtrDpth" in message for _, message in errors(without))
    base = VESSEL + "environment: {depth: 200 m}\n"
    assert read_deck(without, base).case.lines == read_deck(DECK, VESSEL).case.lines  # type: ignore[union-attr]


def test_seabed_as_z_of_a_bodys_point_is_refused() -> None:
    text = two_bodies("0", "Fixed").replace("2 Body1 -20 0 -10", "2 Body1 -20 0 seabed")
    assert any("z is from the body" in message for _, message in errors(text))


# --- ends held without a vessel


@pytest.mark.slow
def test_pinned_makes_a_case_that_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deck, out, answer = tmp_path / "deck.dat", tmp_path / "case.yaml", tmp_path / "answer.json"
    deck.write_text(DECK)
    assert main(["moordyn", "read", str(deck), "--pinned", "-o", str(out)]) == 0
    assert "coupled points are pinned" in capsys.readouterr().err
    assert main(["run", str(out), "--quiet", "--json", str(answer)]) == 0
    assert load_case(out.read_bytes()).vessel is None


def test_pinned_holds_the_coupled_points_of_any_number_of_vessels() -> None:
    case = read_deck(DECK, pinned=True).case
    assert case is not None
    assert case.vessel is None
    assert case.lines["line-1"].end_b.pinned == (-58.0, 0.0, -14.0)
    two = read_deck(two_bodies("1000"), pinned=True).case
    assert two is not None
    assert {end.pinned for line in two.lines.values() for end in (line.end_a, line.end_b) if end.pinned} == {
        (-20.0, 0.0, -10.0), (20.0, 0.0, -10.0), (980.0, 0.0, -10.0),
    }  # fmt: skip
    old = read_deck(V1, pinned=True).case
    assert old is not None
    assert math.isclose(old.lines["line-1"].end_b.pinned[2], -0.132)  # type: ignore[index]


def test_pinned_and_a_vessel_exclude_each_other(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match="exclude each other"):
        read_deck(DECK, VESSEL, pinned=True)
    with pytest.raises(SystemExit):
        main(["moordyn", "read", "deck.dat", "--pinned", "--vessel", "case.yaml"])
