"""The upper part of a run page: name, state, progress, what went wrong and what to do about it."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import ClientsideFunction, Dash, Input, Output, dcc, html

from frontend.components.attributes import hyphened
from frontend.components.links import button_link, page_path, rest
from frontend.components.messages import warnings
from frontend.format import analysis_name, duration, moment
from frontend.theme import FINAL

HIDDEN = {"display": "none"}


def layout(run_id: str) -> Any:
    title = dmc.Group(
        [
            dmc.Title("Run", order=1, id="run-title"),
            html.Span("…", id="run-badge", className="sd-badge"),
        ],
        gap="sm",
    )
    cancel = dmc.Button("Cancel run", id="run-cancel", variant="default", size="xs", style=HIDDEN)
    return html.Header(
        [
            dcc.Link("All runs", href=page_path("/"), className="sd-back"),
            dmc.Group(
                [
                    html.Div([title, dmc.Text(id="run-facts", size="sm", c="dimmed", mt=2)]),
                    dmc.Group([cancel, *sharing("run"), dmc.Group(id="run-actions", gap="xs")], gap="xs"),
                ],
                justify="space-between",
            ),
            dmc.Box(
                [
                    dmc.Progress(
                        id="run-progress", value=0, size="lg", animated=True, **hyphened(aria_label="Progress")
                    ),
                    dmc.Text(id="run-progress-text", size="sm", c="dimmed", mt=4, **hyphened(aria_live="polite")),
                ],
                id="run-progress-box",
                style=HIDDEN,
                mt="sm",
            ),
        ]
    )


def sharing(page: str) -> list[Any]:
    """Share and Print, of a run or a comparison."""
    return [
        dmc.Button("Share", id=f"{page}-share", variant="default", size="xs", className="sd-own"),
        dmc.Button("Print", id=f"{page}-print", variant="default", size="xs", className="sd-no-print"),
    ]


def register_sharing(app: Dash, page: str) -> None:
    for act in ("share", "print"):
        app.clientside_callback(
            ClientsideFunction("slowdrift", act),
            Output(f"{page}-{act}", "data-asked"),
            Input(f"{page}-{act}", "n_clicks"),
            prevent_initial_call=True,
        )


def facts(run: dict[str, Any]) -> str:
    parts = [", ".join(analysis_name(name) for name in run.get("analyses") or [])]
    if run.get("name"):
        parts.append(f"case “{run.get('case_name')}”")
    if run.get("created_at"):
        by = f" by {run['created_by']}" if run.get("created_by") else ""
        parts.append(f"created {moment(run['created_at'])}{by}")
    if run.get("finished_at") and run.get("started_at"):
        parts.append(f"took {duration(run)}")
    if (run.get("attempt") or 0) > 1:
        parts.append(f"attempt {run['attempt']}")
    parts += run.get("tags") or []
    return " · ".join(part for part in parts if part)


def actions(run: dict[str, Any], has_summary: bool) -> list[Any]:
    made: list[Any] = [button_link("Edit as new", f"/new?run={run['id']}", kind="default")]
    made.append(
        dmc.Button(
            "Run again", id="run-again", variant="default", size="xs", style=None if run["state"] in FINAL else HIDDEN
        )
    )
    if has_summary:
        name = f"summary-{run['id']}.json"
        for text, path, saved in (("Summary (JSON)", "summary", name), ("Export all", "export", "")):
            address = rest(f"/runs/{run['id']}/{path}")
            made.append(html.A(text, href=address, download=saved, className="sd-button sd-button-default"))
    return made


def told(run: dict[str, Any], summary: dict[str, Any]) -> list[Any]:
    """Failures first, each with its reason as the solver says it (with the remedy), then warnings."""
    said: list[Any] = []
    failures = dict(summary.get("failures") or {})
    if run["state"] == "failed" and run.get("reason") and run["reason"] not in failures.values():
        failures = {"run": run["reason"], **failures}
    for name, reason in failures.items():
        title = "The run failed" if name == "run" else f"{analysis_name(name).capitalize()} failed"
        said.append(dmc.Alert(reason, title=title, color="red", variant="light", className="sd-failure"))
    if run["state"] == "cancelled":
        said.append(dmc.Alert("It was stopped before it ended.", title="Cancelled", color="gray", variant="light"))
    texts = list(dict.fromkeys([*(run.get("warnings") or []), *(summary.get("warnings") or [])]))
    noted = warnings(texts)
    return [dmc.Stack([*said, *([noted] if noted else [])], gap="sm", mt="md")] if said or noted else []
