"""What people wrote stands in pictures as they wrote it, never as a link or other mark."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from frontend.components.graph import figure_graph
from frontend.figures.base import axis, curve, figure, note
from frontend.figures.compare import Curve, along, study_curves
from frontend.figures.safe import safe

LINK = '<a href="https://evil.example">Open</a> & <b>more</b>'
SHOWN = '&lt;a href="https://evil.example"&gt;Open&lt;/a&gt; &amp; &lt;b&gt;more&lt;/b&gt;'
FRONTEND = Path(__file__).resolve().parents[2] / "frontend"


def texts(value: Any) -> list[str]:
    if isinstance(value, dict):
        return [text for each in value.values() for text in texts(each)]
    if isinstance(value, list | tuple):
        return [text for each in value for text in texts(each)]
    if isinstance(value, np.ndarray) and value.dtype.kind in "OUS":
        return texts(value.tolist())
    return [value] if isinstance(value, str) else []


def channel(unit: str = "m") -> dict[str, Any]:
    return {"values": [1.0, 2.0], "unit": unit, "axes": [{"name": "arc_length", "unit": "m", "values": [0.0, 1.0]}]}


PICTURES = {
    "legend": figure([curve([0.0], [1.0], LINK, "#000", "m")]),
    "unit of the hover": figure([curve([0.0], [1.0], "a", "#000", LINK)]),
    "title of an axis": figure([], xaxis=axis(LINK), yaxis=axis(LINK)),
    "annotation": figure([], annotations=[note(LINK)]),
    "values along an axis": figure([curve(np.array([LINK, "b"]), [1.0, 2.0], "a", "#000", "m")]),
    "colour bar": figure([{"type": "heatmap", "colorbar": {"title": {"text": LINK}}}]),
    "own template": figure([{"hovertemplate": f"{LINK} %{{x:.1f}} m out<extra></extra>", "text": [LINK], "x": [LINK]}]),
    "compared runs": along(LINK, [Curve(LINK, 0, "frequency", channel(LINK))]),
    "a study": study_curves([(LINK, [0.0, 1.0], [1.0, 2.0])] * 2, LINK, LINK),
    "frames": figure([]) | {"frames": [{"name": LINK, "data": [{"name": LINK}]}]},
}


@pytest.mark.parametrize("name", PICTURES)
def test_marks_are_letters(name: str) -> None:
    assert any("<a" in text for text in texts(PICTURES[name]))
    made = figure_graph(PICTURES[name], "a-picture", "a picture").figure
    found = [text for text in texts(made) if "href" in text]
    assert found
    assert all(SHOWN in text for text in found)
    assert not any("<" in text.replace("<extra></extra>", "") for text in texts(made))


def test_numbers_are_not_copied() -> None:
    values = np.zeros(10)
    assert safe({"data": [{"x": values}]})["data"][0]["x"] is values


def test_every_picture_passes() -> None:
    """Another `dcc.Graph`, or a callback that puts a figure into one, would go around it."""
    found = {
        path.relative_to(FRONTEND).as_posix()
        for path in FRONTEND.rglob("*.py")
        if re.search(r"\bGraph\(|\"figure\"\)", path.read_text())
    }
    assert found == {"components/graph.py", "panels/history.py"}  # the latter changes numbers only
