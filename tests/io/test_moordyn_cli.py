"""`slowdrift moordyn`: read and write, exit status and messages."""

from __future__ import annotations

from pathlib import Path

import pytest

from cli.main import main
from solver.case import load_case

from .decks import DECK, ROOT, VESSEL


def test_read_and_write(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deck, vessel, case, back = (tmp_path / name for name in ("deck.dat", "vessel.yaml", "case.yaml", "back.dat"))
    deck.write_text(DECK)
    vessel.write_text(VESSEL)
    assert main(["moordyn", "read", str(deck), "--vessel", str(vessel), "-o", str(case)]) == 0
    assert "Left out: line type main: internal damping" in capsys.readouterr().err
    assert main(["moordyn", "write", str(case), "-o", str(back)]) == 0
    again = tmp_path / "again.yaml"
    assert main(["moordyn", "read", str(back), "--vessel", str(vessel), "-o", str(again)]) == 0
    one, two = load_case(case.read_bytes()), load_case(again.read_bytes())
    assert one.line_types == two.line_types
    assert list(one.lines.values()) == list(two.lines.values())


def test_a_template_says_what_is_to_be_filled_in(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deck = tmp_path / "deck.dat"
    deck.write_text(DECK)
    assert main(["moordyn", "read", str(deck)]) == 0
    shown = capsys.readouterr()
    assert "FILL IN" in shown.out
    assert "to be filled in: vessel.mass" in shown.err
    case = tmp_path / "case.yaml"
    case.write_text(shown.out)
    assert main(["run", str(case), "--quiet"]) == 2
    assert "vessel.mass" in capsys.readouterr().err


def test_wrong_input_ends_with_status_2_and_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    deck, out = tmp_path / "deck.dat", tmp_path / "case.yaml"
    deck.write_text(DECK.replace("2 main 2 3", "2 main 2 9"))
    assert main(["moordyn", "read", str(deck), "-o", str(out)]) == 2
    assert "(line 19)" in capsys.readouterr().err
    assert main(["moordyn", "read", str(tmp_path / "none.dat"), "-o", str(out)]) == 2
    assert main(["moordyn", "write", str(deck), "-o", str(out)]) == 2
    assert not out.exists()


def test_a_pretension_is_solved_before_writing(tmp_path: Path) -> None:
    text = (ROOT / "examples" / "fpso-2000m.yaml").read_text()
    case = tmp_path / "fpso.yaml"
    case.write_text(text.replace("data: barge", f"data: {ROOT}/examples/barge"))
    out = tmp_path / "deck.dat"
    assert main(["moordyn", "write", str(case), "-o", str(out)]) == 0
    rows = [line.split() for line in out.read_text().splitlines() if " Fixed " in line]
    assert len(rows) == 4
    radius = {round((float(x) ** 2 + float(y) ** 2) ** 0.5) for _, _, x, y, *_ in rows}
    assert len(radius) == 1
    assert 2000 < radius.pop() < 2700
