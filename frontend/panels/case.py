"""What was asked, and what it was computed with: enough to repeat the run."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import html

from frontend.components.attributes import hyphened
from frontend.components.tables import facts
from frontend.format import MISSING, moment, number
from frontend.results import Results

NAMES = {
    "case_hash": "Case, content hash",
    "data_hash": "Hydrodynamic data, content hash",
    "solver_version": "Solver version",
    "seeds": "Seeds",
    "tp": "Peak period Tp [s]",
    "hs_in_band": "Hs within the wave band [m]",
}


def applies(results: Results) -> bool:
    return True


def said(value: Any) -> str:
    if value is None or value == []:
        return MISSING
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, dict):
        return ", ".join(f"{name} {said(part)}" for name, part in value.items())
    if isinstance(value, float):
        return number(value, 4)
    return "; ".join(said(part) for part in value) if isinstance(value, list) else str(value)


def provenance(results: Results) -> list[tuple[str, str]]:
    run = results.run
    rows = [
        ("Run", run["id"]),
        ("Case", str(run.get("case_name"))),
        ("Changed by its study", said(run.get("overrides") or None)),
        ("Started by", said(run.get("created_by"))),
        ("Created", moment(run.get("created_at"))),
        ("Started", moment(run.get("started_at"))),
        ("Finished", moment(run.get("finished_at"))),
        ("Attempt", said(run.get("attempt"))),
    ]
    held = results.summary.get("provenance") or {"solver_version": run.get("solver_version")}
    return rows + [(NAMES.get(key, key.replace("_", " ")), said(value)) for key, value in held.items()]


def render(results: Results) -> list[Any]:
    text = results.stored_case.get("yaml") or "The case is no longer stored."
    listing = html.Pre(text, className="sd-code", id="case-yaml", tabIndex=0, **hyphened(aria_label="Case as YAML"))
    return [
        dmc.Grid(
            [
                dmc.GridCol(
                    [
                        dmc.Group(
                            [
                                dmc.Title("Case", order=4),
                                dmc.CopyButton("Copy", value=text, copiedChildren="Copied", size="xs", variant="light"),
                            ],
                            mb=6,
                        ),
                        listing,
                    ],
                    span={"base": 12, "lg": 8},
                ),
                dmc.GridCol(
                    [dmc.Title("Provenance", order=4, mb=6), facts(provenance(results))], span={"base": 12, "lg": 4}
                ),
            ],
            gutter="lg",
        )
    ]
