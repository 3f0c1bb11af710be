"""Colours and fonts, once: a colour-blind-safe palette for pictures and the Mantine theme of the pages."""

from __future__ import annotations

from typing import Any

# Okabe & Ito (2008): distinguishable with every common colour vision
BLUE, ORANGE, GREEN, VERMILION = "#0072B2", "#E69F00", "#009E73", "#D55E00"
SKY, PURPLE, YELLOW, BLACK = "#56B4E9", "#CC79A7", "#F0E442", "#000000"
CYCLE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK)

BAND_COLOUR = {"wf": BLUE, "lf": VERMILION, "total": BLACK}
BAND_NAME = {"wf": "wave frequency (WF)", "lf": "low frequency (LF)", "total": "total"}

INK, FAINT, GRID, PAPER = "#212529", "#5c636a", "#e3e7eb", "#ffffff"
FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Liberation Sans', 'DejaVu Sans', sans-serif"
MONO = "ui-monospace, 'SF Mono', Menlo, Consolas, 'DejaVu Sans Mono', monospace"

MANTINE: dict[str, Any] = {
    "fontFamily": FONT,
    "fontFamilyMonospace": MONO,
    "primaryColor": "marine",
    "primaryShade": 7,
    "defaultRadius": "sm",
    "colors": {
        "marine": [
            "#eaf4fb", "#d5e7f3", "#a8cde5", "#78b2d7", "#519bcb",
            "#398dc4", "#2a86c1", "#0b6aa6", "#005f98", "#004f80",
        ],
    },
    "headings": {"fontFamily": FONT, "fontWeight": "600"},
}  # fmt: skip

STATE_COLOUR = {
    "queued": "gray",
    "running": "blue",
    "cancelling": "yellow",
    "succeeded": "green",
    "failed": "red",
    "cancelled": "gray",
}
FINAL = ("succeeded", "failed", "cancelled")
