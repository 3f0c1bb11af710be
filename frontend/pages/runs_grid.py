"""The grid of runs: its columns, its filters as the address has them, one page of rows from the service."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Any

import dash_ag_grid as dag
import dash_mantine_components as dmc
from dash import dcc, html

from frontend.components.attributes import hyphened
from frontend.components.links import button_link
from frontend.components.messages import empty
from frontend.theme import STATE_COLOUR

PAGE_SIZE = 25
FILTERS = ("q", "state", "tag", "since", "sort", "study", "pinned")
SINCE = {"1": "Last day", "7": "Last week", "30": "Last month"}
COLUMNS: list[dict[str, Any]] = [
    {"colId": "case_name", "valueGetter": {"function": "runName(params)"}, "headerName": "Run",
     "cellRenderer": "RunLink", "flex": 3, "minWidth": 130, "cellClass": "sd-wrap"},
    {"colId": "state", "valueGetter": {"function": "runProgress(params)"}, "headerName": "State",
     "cellRenderer": "RunState", "width": 210, "minWidth": 110},
    {"colId": "analyses", "headerName": "Analyses", "valueGetter": {"function": "runAnalyses(params)"}, "flex": 1,
     "minWidth": 150, "tooltipValueGetter": {"function": "params.value"}},
    {"field": "created_by", "headerName": "Who", "width": 120, "valueFormatter": {"function": "params.value || '–'"}},
    {"field": "created_at", "headerName": "Created", "valueFormatter": {"function": "runMoment(params)"}, "width": 188},
    {"colId": "duration", "headerName": "Duration", "valueGetter": {"function": "runSeconds(params)"},
     "valueFormatter": {"function": "runDuration(params)"}, "width": 108},
    {"colId": "action", "valueGetter": {"function": "params.data.state"}, "headerName": "Do",
     "cellRenderer": "RunAction", "width": 262, "minWidth": 84, "resizable": False},
]  # fmt: skip


def filter_bar(chosen: dict[str, Any]) -> dmc.Group:
    """Search and filters; `chosen` is what the address says."""
    states = [{"value": s, "label": s} for s in STATE_COLOUR]
    since = [{"value": value, "label": text} for value, text in SINCE.items()]
    orders = [{"value": "-created", "label": "Newest first"}, {"value": "created", "label": "Oldest first"}]
    return dmc.Group(
        [
            dmc.TextInput(id="runs-q", placeholder="Search names", value=chosen.get("q") or "", debounce=300, w=190,
                          **hyphened(aria_label="Search names")),
            dmc.MultiSelect(id="runs-state", data=states, value=_listed(chosen.get("state")), placeholder="Any state", w=210,
                            clearable=True, **hyphened(aria_label="State")),
            dmc.TextInput(id="runs-tag", placeholder="Tag", value=chosen.get("tag") or "", debounce=300, w=110,
                          **hyphened(aria_label="Tag")),
            dmc.Select(id="runs-since", data=since, value=chosen.get("since"), placeholder="Any time", clearable=True, w=130,
                       **hyphened(aria_label="Created")),
            dmc.Select(id="runs-sort", data=orders, value=chosen.get("sort") or "-created", allowDeselect=False, w=140,
                       **hyphened(aria_label="Order")),
            dmc.Switch(id="runs-pinned", label="Pinned", checked=chosen.get("pinned") == "true"),
        ],
        gap="xs",
    )  # fmt: skip


def _listed(text: str | None) -> list[str]:
    return [part for part in (text or "").split(",") if part in STATE_COLOUR]


def asked(chosen: dict[str, Any]) -> dict[str, Any]:
    """The filters as `GET /runs` takes them."""
    since = SINCE.get(str(chosen.get("since"))) and datetime.now(UTC) - timedelta(days=int(chosen["since"]))
    wanted = {
        "q": chosen.get("q"),
        "state": chosen.get("state"),
        "tag": chosen.get("tag"),
        "study": chosen.get("study"),
        "pinned": "true" if chosen.get("pinned") == "true" else None,
        "from": since.isoformat() if since else None,
        "sort": chosen.get("sort") if chosen.get("sort") == "created" else None,
    }
    return {key: value for key, value in wanted.items() if value}


def grid() -> list[Any]:
    made = dag.AgGrid(
        id="runs-grid",
        rowData=[],
        columnDefs=COLUMNS,
        getRowId="params.data.id",
        defaultColDef={"sortable": False, "resizable": True, "suppressMovable": True},
        dashGridOptions={
            "domLayout": "autoHeight",
            "rowHeight": 62,
            "theme": {"function": "runsTheme(themeQuartz)"},
            "suppressCellFocus": False,
            "animateRows": False,
            "tooltipShowDelay": 300,
            "rowSelection": {
                "mode": "multiRow",
                "checkboxes": True,
                "headerCheckbox": False,
                "enableClickSelection": False,
            },
            "selectionColumnDef": {"field": "nothing"},  # without a field its cells are drawn anew with any new rows
        },
        style={"width": "100%"},
    )
    return [made, _pager()]


def _pager() -> dmc.Group:
    return dmc.Group(
        [
            dmc.Text(id="runs-total", size="sm", c="dimmed", **hyphened(aria_live="polite")),
            dmc.Group(
                [
                    dmc.Button("Newer", id="runs-newer", variant="default", size="xs", disabled=True),
                    dmc.Button("Older", id="runs-older", variant="default", size="xs", disabled=True),
                ],
                gap="xs",
            ),
        ],
        justify="space-between",
        mt="sm",
    )


def count(total: int | None, here: int) -> str:
    if total is None:
        return f"{here} runs"
    return f"{total} run{'s' if total != 1 else ''}" + (f", {here} on this page" if total > here else "")


def nothing(chosen: dict[str, Any]) -> Any:
    if asked(chosen).keys() - {"sort"}:
        return dmc.Text("No run is like that. Change or clear the filters.", c="dimmed")
    return empty(
        "No runs yet",
        "A run computes one case: where the vessel settles, how it moves in waves and in slow drift, and what its "
        "mooring lines carry. Start from an example; it takes a few seconds.",
        button_link("Start from an example", "/new"),
    )


def confirm() -> dmc.Modal:
    return dmc.Modal(
        [
            dmc.Text("Its results go with it. The case stays.", size="sm"),
            dmc.Group(
                [
                    dmc.Button("Keep", id="runs-keep", variant="default"),
                    dmc.Button("Delete", id="runs-delete", color="red.9"),
                ],
                justify="flex-end",
                mt="md",
            ),
        ],
        id="runs-confirm",
        title="Delete this run?",
        centered=True,
    )


def rename() -> dmc.Modal:
    return dmc.Modal(
        [
            dmc.TextInput(id="runs-name", label="Name", description="Shown in place of the case's name."),
            dmc.TagsInput(id="runs-tags", label="Tags", description="Enter after each.", mt="sm"),
            dmc.Switch(id="runs-keep-results", label="Pinned: kept whatever the retention says", mt="md"),
            html.Div(id="runs-rename-error"),
            dmc.Group([dmc.Button("Save", id="runs-save")], justify="flex-end", mt="md"),
        ],
        id="runs-rename",
        title="Name and tags",
        centered=True,
    )


def stores(chosen: dict[str, Any]) -> list[Any]:
    return [
        dcc.Store(id="runs-refresh", data=0),
        dcc.Store(id="runs-at", data=0),
        dcc.Store(id="runs-trail", data=[None]),
        dcc.Store(id="runs-asked"),
        dcc.Store(id="runs-filters", data=chosen),
    ]
