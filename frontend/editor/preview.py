"""The preview beside the form: the system at rest, drawn from what POST /preview answered, and the sea as described."""

from __future__ import annotations

import math
from typing import Any

import dash_mantine_components as dmc
from dash import Dash, Input, Output, dcc, html

from frontend.components.attributes import hyphened
from frontend.components.graph import figure_graph
from frontend.components.tables import table
from frontend.editor.text import EditError, read
from frontend.figures import preview as figures
from frontend.figures.sea import sea_figure
from frontend.format import MISSING, number

VIEWS = (("space", "3D"), ("plan", "Plan"), ("profile", "Profile"), ("sea", "Sea"))
HEAD = ("Line", "end a [kN]", "end b [kN]", "grounded [m]", "in water [kN]")
TYPES = ("Line type", "mass [kg/m]", "in water [N/m]", "EA [MN]", "breaking load [kN]")


def layout() -> Any:
    data = [{"value": value, "label": text} for value, text in VIEWS]
    switch = dmc.SegmentedControl(
        id="preview-view", data=data, value="space", fullWidth=True, **hyphened(aria_label="View")
    )
    return html.Section(
        [
            dcc.Store(id="case-preview"),
            switch,
            html.Div(_idle(), id="preview-picture", className="sd-preview-picture"),
            dmc.Text("", id="preview-note", size="xs", c="dimmed", **hyphened(aria_live="polite")),
            html.Div(id="preview-facts"),
        ],
        **hyphened(aria_label="Preview"),
    )


def _idle(words: str = "Statics appear here as soon as the case is complete.") -> Any:
    return dmc.Center(dmc.Text(words, c="dimmed", size="sm", ta="center", maw=380), h=460)


def register(app: Dash) -> None:
    app.callback(
        Output("preview-picture", "children"),
        Output("preview-note", "children"),
        Output("preview-facts", "children"),
        Input("case-preview", "data"),
        Input("preview-view", "value"),
    )(show)


def show(held: dict[str, Any] | None, view: str) -> tuple[Any, str, Any]:
    """One picture at a time, so that an edit is on the screen within a second."""
    tree = _tree((held or {}).get("text") or "")
    seas = (tree.get("environment") or {}).get("seastates") or []
    if view == "sea":
        return (*_sea(seas), None)
    if not held:
        return _idle(), "", None
    if held.get("problem"):
        problem = held["problem"]
        return _idle(problem.get("detail") or problem.get("title") or "No equilibrium."), "", None
    shape = held["shape"]
    if not shape.get("lines"):
        return _idle("The case has no lines to draw."), "", None
    return figure_graph(*_picture(shape, tree, view)), _said(shape, tree, view), facts(shape)


def _tree(text: str) -> dict[str, Any]:
    try:
        found: dict[str, Any] = read(text)
        return found
    except EditError:
        return {}


def _picture(shape: dict[str, Any], tree: dict[str, Any], view: str) -> tuple[Any, str, str]:
    if view == "plan":
        return figures.plan(shape, tree), "preview-plan", "Plan view with azimuths"
    if view == "profile":
        return figures.profile(shape, tree), "preview-profile", "Lines from the side"
    return figures.in_space(shape, tree)[0], "preview-space", "The system at rest in space"


def _said(shape: dict[str, Any], tree: dict[str, Any], view: str) -> str:
    position = ((shape.get("statics") or {}).get("vessel") or {}).get("position")
    words = ["Static equilibrium."]
    if position:
        words.append(f"Offset {number(math.hypot(*position[:2]))} m.")
    if view == "space":
        stretch = figures.in_space(shape, tree)[1]
        words.append("True to scale." if stretch < 1.02 else f"Vertical stretched {number(stretch, 2)} times.")
    if view == "profile":
        words.append("Triangles: touchdown.")
    return " ".join([*words, *(shape.get("warnings") or [])])


def _sea(seas: list[dict[str, Any]]) -> tuple[Any, str]:
    if not seas:
        return _idle("Still water: the case has no wave systems."), ""
    try:
        return figure_graph(
            sea_figure(seas), "preview-sea", "Wave spectra"
        ), "Elevation spectra as described; no run needed."
    except (EditError, ValueError, TypeError) as error:
        return _idle(f"The sea cannot be drawn yet: {error}."), ""


def facts(shape: dict[str, Any]) -> Any:
    """Tensions at both ends, what lies on the seabed, and what lines and their types weigh in water."""
    rows = []
    for name, line in ((shape.get("statics") or {}).get("lines") or {}).items():
        ends = [(line.get(end) or {}).get("tension") for end in ("end_a", "end_b")]
        told = [_scaled(value, 1e3) for value in ends]
        rows.append([name, *told, number(line.get("grounded_length")), _scaled(line.get("weight_in_water"), 1e3)])
    if not rows:
        return None
    kinds = [
        [name, number(kind["mass"], 4), number(kind["weight_in_water"], 4), _scaled(kind["EA"], 1e6),
         _scaled(kind.get("breaking_load"), 1e3)]
        for name, kind in (shape.get("line_types") or {}).items()
    ]  # fmt: skip
    return [table("", HEAD, rows, min_width=320), *([table("", TYPES, kinds, min_width=320)] if kinds else [])]


def _scaled(value: float | None, unit: float) -> str:
    return MISSING if value is None else number(value / unit, 4)
