"""Frames for pictures and key figures, in a grid that folds to one column."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import dash_mantine_components as dmc
from dash import html

from frontend.components.attributes import hyphened
from frontend.components.graph import figure_graph
from frontend.figures.base import Figure


def picture(title: str, figure: Figure, key: str, note: str | None = None, kind: str = "graph") -> dmc.Paper:
    """`kind` and `key` make the graph's id; `note` stands below."""
    graph = figure_graph(figure, {"type": kind, "name": key}, title)
    parts: list[Any] = [html.H3(title, className="sd-picture-title"), graph]
    if note:
        parts.append(dmc.Text(note, size="xs", c="dimmed", px="xs", pb=4))
    return dmc.Paper(html.Section(parts, **hyphened(aria_label=title)), withBorder=True, className="sd-picture")


def grid(children: Sequence[Any], wide: int = 2) -> dmc.SimpleGrid:
    return dmc.SimpleGrid(list(children), cols={"base": 1, "md": min(2, wide), "xl": wide}, spacing="md")


def figure_card(label: str, value: str, note: str = "") -> dmc.Paper:
    return dmc.Paper(
        [
            dmc.Text(label, size="sm", c="dimmed"),
            dmc.Text(value, fw=600, className="sd-key-value"),
            dmc.Text(note, size="xs", c="dimmed"),
        ],
        withBorder=True,
        p="sm",
    )
