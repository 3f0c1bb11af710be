"""From a hull to hydrodynamic data: its shape or a mesh, what its panels are worth, and the job that computes them."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, State, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components.attributes import hyphened
from frontend.components.cards import picture
from frontend.components.links import page_path
from frontend.components.messages import refusal
from frontend.components.tables import facts, table
from frontend.errors import ApiError, FieldError
from frontend.figures.mesh import mesh
from frontend.format import MISSING, number
from frontend.theme import MONO

COMMON = """water: {density: 1025, gravity: 9.80665}   # depth: 200 m; infinite when left out
body: {centre_of_gravity: [0, 0, %s], radii_of_gyration: %s}   # mass: that of the water when left out
frequencies: {from: 0.1, to: 1.5, step: 0.05}
limits: true                               # zero and infinite frequency too
headings: {from: 0 deg, to: 345 deg, step: 15 deg}
mean_drift: free                           # free, fixed or none
lid: true                                  # against irregular frequencies
"""
SHAPES = {
    "barge": "  hull: {kind: barge, length: 240 m, breadth: 46 m, draft: 10 m}\n",
    "ship": "  hull: {kind: ship, length: 260 m, breadth: 46 m, draft: 16 m, bow: 40 m, stern: 40 m, bilge_radius: 3 m}\n",
    "spar": "  hull:\n    kind: spar\n    profile:\n    - {depth: 0 m, diameter: 6.5 m}\n    - {depth: 4 m, diameter: 6.5 m}\n"
    "    - {depth: 12 m, diameter: 9.4 m}\n    - {depth: 120 m, diameter: 9.4 m}\n",
    "semisubmersible": "  hull:\n    kind: semisubmersible\n    columns:\n"
    + "".join(
        f"    - {{position: [{x}, {y}], profile: [{{depth: 0 m, diameter: 12 m}}, {{depth: 20 m, diameter: 12 m}}]}}\n"
        for x, y in ((30, 30), (30, -30), (-30, -30), (-30, 30))
    )
    + "    pontoons:\n"
    + "".join(
        f"    - {{between: [{a}, {b}], width: 10 m, top: 12 m, bottom: 20 m}}\n" for a, b in ((0, 3), (1, 2))
    ),
}  # fmt: skip
# panel size, height of the centre of gravity, radii of gyration [m]: to begin with
FIRST = {
    "barge": (5, 5, [18, 60, 60]),
    "ship": (5, 2, [18, 65, 65]),
    "spar": (2, -80, [40, 40, 4]),
    "semisubmersible": (3, -8, [30, 30, 35]),
}


def template(kind: str) -> str:
    size, height, radii = FIRST[kind]
    return f"name: {kind}\ngeometry:\n{SHAPES[kind]}  panel_size: {size} m\n{COMMON % (height, radii)}"


def layout(**_: Any) -> Any:
    return dmc.Stack(
        [
            dcc.Store(id="mesh-added"),
            dcc.Link("All hydrodynamic data", href=page_path("/data"), className="sd-back"),
            dmc.Title("Data from a hull", order=1),
            dmc.Text("Boundary elements (Capytaine) compute what a hull of this shape feels in waves.", c="dimmed"),
            dmc.Group(
                [
                    dmc.Select(
                        id="hull-kind", label="Start from", data=[{"value": k, "label": k} for k in SHAPES], value="barge",
                        allowDeselect=False, w=200,
                    ),
                    dmc.Button("Upload a mesh", id="mesh-upload", variant="default"),
                    dmc.Button("Look at the panels", id="hull-look", variant="default"),
                    dmc.Button("Compute", id="hull-start"),
                ],
                align="flex-end",
            ),
            html.Div(id="hull-message", **hyphened(aria_live="polite")),
            dmc.Grid(
                [
                    dmc.GridCol(
                        dmc.Textarea(
                            id="hull-text", label="The job as YAML", value=template("barge"), autosize=True, minRows=16,
                            styles={"input": {"fontFamily": MONO, "fontSize": 13, "whiteSpace": "pre", "overflowX": "auto"}},
                        ),
                        span={"base": 12, "lg": 5},
                    ),
                    dmc.GridCol(html.Div(id="hull-seen"), span={"base": 12, "lg": 7}),
                ]
            ),
        ],
        id="hull-page", gap="md",
    )  # fmt: skip


def register(app: Dash) -> None:
    app.callback(Output("hull-text", "value"), Input("hull-kind", "value"), prevent_initial_call=True)(template)
    app.clientside_callback(
        ClientsideFunction("slowdrift", "uploadMesh"), Output("hull-page", "data-upload"),
        Input("mesh-upload", "n_clicks"), prevent_initial_call=True,
    )  # fmt: skip
    app.callback(
        Output("hull-text", "value", allow_duplicate=True), Output("hull-message", "children", allow_duplicate=True),
        Output("hull-seen", "children", allow_duplicate=True), Input("mesh-added", "data"), prevent_initial_call=True,
    )(uploaded)  # fmt: skip
    app.callback(
        Output("hull-seen", "children"), Output("hull-message", "children"), Input("hull-look", "n_clicks"),
        State("hull-text", "value"), prevent_initial_call=True, running=[(Output("hull-look", "loading"), True, False)],
    )(look)  # fmt: skip
    app.callback(
        Output("location", "pathname", allow_duplicate=True), Output("hull-message", "children", allow_duplicate=True),
        Input("hull-start", "n_clicks"), State("hull-text", "value"), prevent_initial_call=True,
        running=[(Output("hull-start", "loading"), True, False)],
    )(start)  # fmt: skip


def uploaded(added: dict[str, Any] | None) -> tuple[Any, Any, Any]:
    """A job for the mesh that has just come in, and its panels."""
    if not added:
        return no_update, no_update, no_update
    if added.get("problem"):
        problem = added["problem"]
        fields = [FieldError.from_json(entry) for entry in problem.get("errors") or [] if isinstance(entry, dict)]
        return (
            no_update,
            refusal(ApiError(422, str(problem.get("title")), str(problem.get("detail") or ""), fields)),
            no_update,
        )
    name = added["name"]
    place = f"  mesh: {added['id']}   # {name}\n"
    words = f"name: {name.rsplit('.', 1)[0]}\ngeometry:\n{place}{COMMON % (0, [10, 10, 10])}"
    return words, None, seen(added)


def look(clicks: int | None, text: str) -> tuple[Any, Any]:
    if not clicks:
        return no_update, no_update
    found, error = attempt(lambda: client().post_yaml("/hydrodynamics/mesh", text))
    return (None, refusal(error)) if error else (seen(found), None)


def start(clicks: int | None, text: str) -> tuple[Any, Any]:
    if not clicks:
        return no_update, no_update
    made, error = attempt(lambda: client().post_yaml("/hydrodynamics", text))
    return (no_update, refusal(error)) if error else (page_path(f"/hull/{made['id']}"), None)


def seen(found: dict[str, Any]) -> Any:
    """The panels in space, what they are worth, and what to mend."""
    quality, shown = found["quality"], found.get("preview")
    drawn: list[Any] = []
    if shown:
        few = f"{shown['shown']} of {shown['panels']} panels." if shown["shown"] < shown["panels"] else "All panels."
        drawn.append(picture("Panels", mesh(shown), "hull-mesh", f"{few} The sheet is the still water. Drag to turn."))
    for warning in found.get("warnings") or []:
        title = str(warning.get("check", "")).replace("_", " ").capitalize()
        drawn.append(dmc.Alert(warning["message"], title=title, color="yellow", variant="light"))
    drawn.append(dmc.SimpleGrid([worth(quality), cost(found.get("estimate"))], cols={"base": 1, "sm": 2}))
    return dmc.Stack(drawn, gap="sm")


def worth(quality: dict[str, Any]) -> Any:
    edge, aspect = quality.get("panel_edge") or {}, quality.get("aspect_ratio") or {}
    rows = [
        ("Panels", str(quality.get("panels"))),
        ("Volume", f"{number(quality.get('volume'), 5)} m³"),
        ("Water plane", f"{number(quality.get('waterplane_area'), 4)} m²"),
        ("Centre of buoyancy", ", ".join(number(v) for v in quality.get("centre_of_buoyancy") or []) + " m"),
        ("Block coefficient", number(quality.get("block_coefficient"))),
        ("Closed; normals outward", f"{_yes(quality.get('closed'))}; {_yes(quality.get('normals_outward'))}"),
        ("Mirror images", " and ".join(quality.get("symmetry") or []) or "none"),
        ("Panel edge, mean and largest", f"{number(edge.get('mean'))} m, {number(edge.get('max'))} m"),
        ("Longest side to shortest", f"{number(aspect.get('mean'))}, at most {number(aspect.get('max'))}"),
        ("Panels in the shortest wave", number(quality.get("panels_per_wavelength"))),
    ]
    return dmc.Box([dmc.Title("Mesh", order=4, mb=6), facts(rows)])


def _yes(value: Any) -> str:
    return "yes" if value else "no"


def cost(estimate: dict[str, Any] | None) -> Any:
    if not estimate:
        return html.Div()
    head = ["", ""]
    planes = estimate.get("symmetry_planes")
    said = str(len(planes)) if isinstance(planes, list) else str(planes) if planes is not None else MISSING
    rows = [
        ["panels solved for", str(estimate.get("panels"))], ["panels of the lid", str(estimate.get("lid_panels"))],
        ["planes of symmetry used", said], ["memory", f"{number(estimate.get('memory_mb'))} MB"],
        ["solutions", str(estimate.get("solutions"))],
    ]  # fmt: skip
    return table("What the job needs", head, rows, min_width=240)
