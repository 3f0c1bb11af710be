"""The static shape: in space, from above, from the side."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc

from frontend.components.cards import picture
from frontend.figures import shape as figures
from frontend.format import number
from frontend.results import Results

POSITION = "static/line/{line}/position"


def applies(results: Results) -> bool:
    return any(POSITION.format(line=line) in results.names for line in results.lines)


def render(results: Results) -> list[Any]:
    vessel = ((results.summary.get("statics") or {}).get("vessel") or {}).get("position")
    scene = figures.scene(results.per_line(POSITION), results.case, vessel)
    space, stretch = figures.in_space(scene)
    note = "True to scale." if stretch < 1.02 else f"The vertical is stretched {number(stretch, 2)} times."
    legend = "Drag to turn. The grey outline joins the fairleads."
    space_card = picture("In space", space, "shape-3d", f"{note} {legend if scene.on_vessel else 'Drag to turn.'}")
    plan_card = picture("From above", figures.plan(scene, 520), "plan", "Squares mark end a (anchor or bottom).")
    side_card = picture("From the side", figures.profile(scene), "profile")
    half, wide = {"base": 12, "lg": 5}, {"base": 12, "lg": 7}
    return [
        dmc.Grid(
            [dmc.GridCol(space_card, span=wide), dmc.GridCol(plan_card, span=half), dmc.GridCol(side_card, span=12)],
            gutter="md",
        )
    ]
