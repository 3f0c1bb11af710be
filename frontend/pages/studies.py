"""All studies, and the form that starts one: a saved case, what to vary, and the values."""

from __future__ import annotations

import math
from typing import Any

import dash_mantine_components as dmc
from dash import ALL, Dash, Input, Output, State, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components.attributes import hyphened
from frontend.components.links import button_link, page_path
from frontend.components.messages import empty, refusal
from frontend.components.tables import table
from frontend.errors import ApiError, FieldError
from frontend.format import analysis_name, moment, percent, seconds
from frontend.pointers import MOST, places, said, values

AXES = 3
PAGE = 50


def layout(**_: Any) -> Any:
    return dmc.Stack(
        [
            dmc.Group([dmc.Title("Studies", order=1), button_link("New study", "/new-study")], justify="space-between"),
            html.Div(dmc.Skeleton(h=160), id="studies-list"),
            dcc.Interval(id="studies-tick", interval=5000),
        ],
        id="studies-page",
        gap="md",
    )


def new_layout(case: str | None = None, **_: Any) -> Any:
    """`/new-study?case=ID` starts from that saved case."""
    return dmc.Stack(
        [
            dcc.Store(id="study-asked", data=case),
            dmc.Title("New study", order=1),
            dmc.Text(
                "A study runs one saved case many times. Each row below is a value of the case and what it takes in turn; "
                "all combinations are run.",
                c="dimmed", maw=720,
            ),
            html.Div(id="study-message"),
            dmc.Select(id="study-case", label="Case", data=[], searchable=True, maw=520, placeholder="A saved case"),
            dmc.TextInput(id="study-name", label="Name", placeholder="drag and sea", maw=520),
            *[_axis(index) for index in range(AXES)],
            dmc.MultiSelect(id="study-analyses", label="Analyses", data=[], maw=520),
            dmc.Text(id="study-size", size="sm", **hyphened(aria_live="polite")),
            dmc.Group([dmc.Button("Start the study", id="study-start", disabled=True)]),
        ],
        id="study-new",
        gap="sm",
    )  # fmt: skip


def _axis(index: int) -> dmc.Group:
    words = ("Vary", "and vary", "and vary")[index]
    return dmc.Group(
        [
            dmc.Select(
                id={"type": "study-pointer", "index": index}, label=words, data=[], searchable=True, clearable=True, w=420,
                placeholder="nothing", nothingFoundMessage="No such value in this case",
            ),
            dmc.TextInput(
                id={"type": "study-values", "index": index}, label="Values", placeholder="8, 10, 12 m or 8..16 in 5", w=320,
            ),
        ],
        align="flex-start",
    )  # fmt: skip


def register(app: Dash) -> None:
    app.callback(Output("studies-list", "children"), Input("studies-page", "id"), Input("studies-tick", "n_intervals"))(
        show
    )
    app.callback(
        Output("study-case", "data"), Output("study-case", "value"), Output("study-message", "children"),
        Input("study-new", "id"), State("study-asked", "data"),
    )(offer)  # fmt: skip
    app.callback(
        Output({"type": "study-pointer", "index": ALL}, "data"), Output("study-analyses", "data"),
        Output("study-analyses", "value"), Input("study-case", "value"), State({"type": "study-pointer", "index": ALL}, "id"),
        prevent_initial_call=True,
    )(about)  # fmt: skip
    app.callback(
        Output("study-size", "children"), Output("study-start", "disabled"),
        Output({"type": "study-values", "index": ALL}, "error"), Input({"type": "study-pointer", "index": ALL}, "value"),
        Input({"type": "study-values", "index": ALL}, "value"), State("study-case", "value"),
    )(count)  # fmt: skip
    app.callback(
        Output("location", "pathname", allow_duplicate=True), Output("study-message", "children", allow_duplicate=True),
        Input("study-start", "n_clicks"), State("study-case", "value"), State("study-name", "value"),
        State({"type": "study-pointer", "index": ALL}, "value"), State({"type": "study-values", "index": ALL}, "value"),
        State("study-analyses", "value"), prevent_initial_call=True,
    )(start)  # fmt: skip


def show(_page: str, _tick: int | None) -> Any:
    page, error = attempt(lambda: client().get("/studies", limit=PAGE))
    if error:
        return refusal(error)
    if not page["items"]:
        text = "A study answers how results depend on a value: drag, sea state, pretension, water depth."
        return empty("No studies yet", text, button_link("New study", "/new-study"))
    rows = [
        [dcc.Link(item["name"] or "study", href=page_path(f"/studies/{item['id']}")), str(item["size"]), item["state"],
         percent(item["progress"]), left(item), ", ".join(said(p) for p in item["pointers"]), moment(item["created_at"])]
        for item in page["items"]
    ]  # fmt: skip
    head = ["Study", "runs", "state", "done", "time left", "varies", "created"]
    note = f"The newest {PAGE}." if page.get("next_cursor") else None
    return table("", head, rows, min_width=860, note=note, words=True)


def left(item: dict[str, Any]) -> str:
    return seconds(item["eta_seconds"]) if item.get("eta_seconds") is not None else ""


def offer(_page: str, asked: str | None) -> tuple[Any, Any, Any]:
    page, error = attempt(lambda: client().get("/cases", limit=100))
    if error:
        return no_update, no_update, refusal(error)
    data = [
        {"value": item["id"], "label": f"{item['name']}, version {item['version']}, {moment(item['created_at'])[:10]}"}
        for item in page["items"]
    ]
    if asked and all(item["value"] != asked for item in data):
        found, _ = attempt(lambda: client().get(f"/cases/{asked}"))
        data += [{"value": asked, "label": found["name"]}] if found else []
    return data, asked or (data[0]["value"] if data else None), None


def about(case_id: str | None, ids: list[dict[str, Any]]) -> tuple[Any, Any, Any]:
    """What this case has that can be varied, and its analyses; the time domain is left out unless asked for."""
    if not case_id:
        return [[] for _ in ids], [], []
    stored, error = attempt(lambda: client().get(f"/cases/{case_id}"))
    if error:
        return [[] for _ in ids], [], []
    case = stored["case"]
    data = [{"value": pointer, "label": f"{said(pointer)} = {value}"} for pointer, value in places(case)]
    analyses = [name for name, spec in (case.get("analyses") or {}).items() if spec is not None]
    offered = [{"value": name, "label": analysis_name(name)} for name in analyses]
    return [data for _ in ids], offered, [name for name in analyses if name != "time_domain"] or analyses


def _grid(pointers: list[str | None], texts: list[str | None]) -> tuple[dict[str, list[Any]], list[str | None]]:
    grid, faults = {}, []
    for pointer, text in zip(pointers, texts, strict=True):
        fault = None
        if pointer and text:
            try:
                grid[pointer] = values(text)
            except ValueError as error:
                fault = str(error)
        elif text and not pointer:
            fault = "choose what takes these values"
        faults.append(fault)
    return grid, faults


def count(pointers: list[str | None], texts: list[str | None], case_id: str | None) -> tuple[Any, bool, Any]:
    """How many runs it will be; the button works when there is at least one and nothing is wrong."""
    grid, faults = _grid(pointers, texts)
    size = math.prod(len(found) for found in grid.values()) if grid else 0
    wrong = any(faults) or not case_id
    if size > MOST:
        return f"{size} runs; at most {MOST} here. Larger studies go over REST: POST /api/v1/studies.", True, faults
    words = f"{size} runs" if size != 1 else "1 run"
    return (words if size else "Choose at least one value to vary."), bool(wrong or not size), faults


def start(
    clicks: int | None, case_id: str, name: str | None, pointers: list[str | None], texts: list[str | None],
    analyses: list[str] | None,
) -> tuple[Any, Any]:  # fmt: skip
    if not clicks:
        return no_update, no_update
    grid, faults = _grid(pointers, texts)
    if any(faults):
        wrong = [FieldError(pointer or "", fault) for pointer, fault in zip(pointers, faults, strict=True) if fault]
        return no_update, refusal(ApiError(422, "The study cannot start", errors=wrong))
    body = {"name": name or ", ".join(said(pointer) for pointer in grid)[:200], "case_id": case_id, "grid": grid}
    made, error = attempt(lambda: client().post("/studies", body | ({"analyses": analyses} if analyses else {})))
    if error:
        return no_update, refusal(error)
    return page_path(f"/studies/{made['id']}"), None
