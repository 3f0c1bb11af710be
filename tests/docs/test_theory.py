"""Every equation that a docstring cites is in the docs, and every one in the docs is cited."""

from __future__ import annotations

import ast
import re
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LABEL = r"[HLSFTMRVW]\d+"
ONE = rf"{LABEL}(?:-{LABEL})?"
# (L1), (L1-L2), (F1, F14), (docs/theory.md, S1-S4), (W2)-(W5), (R4, as DNV-OS-E301)
CITATION = re.compile(rf"\((?:docs/theory(?:-vessel|-hydrodynamics)?\.md, )?({ONE}(?:, {ONE})*)(?:, [^()]*)?\)")
ACROSS = re.compile(rf"\(({LABEL})\)-\(({LABEL})\)")


def cited_in(text: str) -> set[str]:
    """Labels a docstring cites, ranges spelled out."""
    text = ACROSS.sub(r"(\1-\2)", text)
    return {label for group in CITATION.findall(text) for part in group.split(", ") for label in _spell_out(part)}


def _spell_out(part: str) -> list[str]:
    first, _, last = part.partition("-")
    if not last:
        return [first]
    assert first[0] == last[0], f"{part} runs over two letters"
    assert int(first[1:]) < int(last[1:]), f"{part} does not rise"
    return [f"{first[0]}{number}" for number in range(int(first[1:]), int(last[1:]) + 1)]


def docstrings(path: Path) -> list[str]:
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            found.append(ast.get_docstring(node) or "")
    return found


SOURCES = sorted((ROOT / "solver").rglob("*.py"))
CITED = {path: {label for text in docstrings(path) for label in cited_in(text)} for path in SOURCES if docstrings(path)}


def defined() -> Counter[str]:
    """Labels the docs define, with how often."""
    lines = re.findall(r"\\tag\{(\w+)\}", (ROOT / "docs/theory.md").read_text(encoding="utf-8"))
    vessel = (ROOT / "docs/theory-vessel.md").read_text(encoding="utf-8")
    bodies = (ROOT / "docs/theory-hydrodynamics.md").read_text(encoding="utf-8")
    return Counter([*lines, *re.findall(r"^\(([HVW]\d+)\)", vessel + bodies, flags=re.MULTILINE)])


def test_reads_citations() -> None:
    text = "Adds it (docs/theory.md, L1-L3); again (F1, F14) (W2)-(W4) and (R4, as others do). F2(t), V1, (V + r)."
    assert cited_in(text) == {"L1", "L2", "L3", "F1", "F14", "W2", "W3", "W4", "R4"}


@pytest.mark.parametrize("path", [path for path, labels in CITED.items() if labels], ids=lambda p: p.stem)
def test_what_is_cited_is_defined(path: Path) -> None:
    assert CITED[path] <= set(defined()), f"{path.name} cites equations that the docs do not define"


def test_what_is_defined_is_cited() -> None:
    everywhere = set().union(*CITED.values())
    assert set(defined()) - everywhere == set()


def test_each_number_once_and_none_left_out() -> None:
    labels = defined()
    assert [label for label, count in labels.items() if count > 1] == []
    for letter in "LSFTMRVW":
        numbers = sorted(int(label[1:]) for label in labels if label[0] == letter)
        assert numbers == list(range(1, len(numbers) + 1)), letter


@pytest.mark.parametrize("page", sorted((ROOT / "docs").rglob("*.md")), ids=lambda p: p.name)
def test_links_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#:]+?)(?:#[^)]*)?\)", text):
        assert (page.parent / target).exists(), f"{page.name} links to {target}"
