"""One boundary-element job: how far it is, and where its data are."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import Dash, Input, Output, State, dcc, html, no_update

from frontend.client import attempt, client
from frontend.components.attributes import hyphened
from frontend.components.links import button_link, page_path
from frontend.components.messages import refusal, warnings
from frontend.components.shell import notice
from frontend.components.tables import facts
from frontend.format import duration, moment, number
from frontend.theme import FINAL


def layout(job_id: str = "", **_: Any) -> Any:
    return dmc.Stack(
        [
            dcc.Store(id="hull-job-id", data=job_id),
            dcc.Interval(id="hull-job-tick", interval=1000),
            dcc.Link("All hydrodynamic data", href=page_path("/data"), className="sd-back"),
            html.Div(dmc.Skeleton(h=160), id="hull-job"),
            dmc.Group(dmc.Button("Cancel", id="hull-job-cancel", variant="default", style={"display": "none"})),
        ],
        id="hull-job-page",
        gap="md",
    )


def register(app: Dash) -> None:
    app.callback(
        Output("hull-job", "children"), Output("hull-job-tick", "disabled"), Output("hull-job-cancel", "style"),
        Input("hull-job-tick", "n_intervals"), State("hull-job-id", "data"),
    )(show)  # fmt: skip
    app.callback(
        Output("notices", "sendNotifications", allow_duplicate=True), Input("hull-job-cancel", "n_clicks"),
        State("hull-job-id", "data"), prevent_initial_call=True,
    )(cancel)  # fmt: skip


def show(_tick: int | None, job_id: str) -> tuple[Any, bool, Any]:
    job, error = attempt(lambda: client().get(f"/hydrodynamics/{job_id}"))
    if error:
        return refusal(error), error.status != 0, {"display": "none"}
    over = job["state"] in FINAL
    badge = html.Span(job["state"], className=f"sd-badge sd-badge-{job['state']}")
    parts: list[Any] = [dmc.Group([dmc.Title(job["name"], order=1), badge])]
    if not over:
        share = 100.0 * (job.get("progress") or 0.0)
        parts.append(dmc.Progress(value=share, size="lg", animated=True, **hyphened(aria_label="Progress")))
        words = " · ".join(part for part in (f"{share:.0f} %", job.get("message") or "") if part)
        parts.append(dmc.Text(words, size="sm", c="dimmed", **hyphened(aria_live="polite")))
    if job.get("reason"):
        parts.append(dmc.Alert(job["reason"], title="The job failed", color="red", variant="light"))
    noted = warnings([str(text) for text in job.get("warnings") or []])
    parts += [noted] if noted else []
    if job.get("data_set_id"):
        parts.append(dmc.Group(button_link("Look at the data", f"/data/{job['data_set_id']}")))
    parts.append(facts(about(job)))
    return dmc.Stack(parts, gap="sm"), over, {"display": "none"} if over else {}


def about(job: dict[str, Any]) -> list[tuple[str, Any]]:
    estimate = job.get("estimate") or {}
    rows = [("Created", moment(job.get("created_at")))]
    if job.get("finished_at"):
        rows.append(("Took", duration(job)))
    if estimate:
        rows.append(("Panels", f"{estimate.get('panels')}, lid {estimate.get('lid_panels')}"))
        rows.append(("Memory, estimated", f"{number(estimate.get('memory_mb'))} MB"))
        rows.append(("Solutions", str(estimate.get("solutions"))))
    return rows


def cancel(clicks: int | None, job_id: str) -> Any:
    if not clicks:
        return no_update
    _, error = attempt(lambda: client().post(f"/hydrodynamics/{job_id}/cancel"))
    return notice("Not cancelled", error.text, "red") if error else notice("Cancelling", "The job stops shortly.")
