"""Texts in pictures are shown as they are: Plotly takes `<a href=…>` and other marks in a text for what they say.

Names of runs, cases and lines come from anybody, so every picture passes here on its way to the browser
(frontend/components/graph.py), and nobody who draws one has to think of it.
"""

from __future__ import annotations

from typing import Any

import numpy as np

TEXTS = frozenset({"name", "text", "hovertext", "ticktext", "title", "x", "y", "z", "labels", "texttemplate"})
"""Where Plotly shows texts; values along an axis too, where they are texts."""
TEMPLATE, EXTRA = "hovertemplate", "<extra></extra>"
"""The one mark that we put into a template ourselves: no second box with the trace's name."""


def safe(figure: Any) -> Any:
    """The same picture; whatever would be a mark in its texts is a letter. Arrays of numbers are not copied."""
    if isinstance(figure, dict):
        return {key: _value(key, value) for key, value in figure.items()}
    if isinstance(figure, list | tuple):
        return (
            [safe(each) for each in figure] if any(isinstance(each, dict | list | tuple) for each in figure) else figure
        )
    return figure


def _value(key: Any, value: Any) -> Any:
    if key == TEMPLATE:
        return _template(value)
    return _texts(value) if key in TEXTS else safe(value)


def _texts(value: Any) -> Any:
    if isinstance(value, str):
        return letters(value)
    if isinstance(value, np.ndarray):
        return value if value.dtype.kind not in "OUS" else _texts(value.tolist())
    if isinstance(value, list | tuple):
        return [_texts(each) for each in value] if any(not isinstance(each, int | float) for each in value) else value
    return safe(value)


def _template(value: Any) -> Any:
    if isinstance(value, str):
        return EXTRA.join(letters(part) for part in value.split(EXTRA))
    return [_template(each) for each in value] if isinstance(value, list | tuple) else value


def letters(text: str) -> str:
    """Plotly writes these again as the letters they stand for."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
