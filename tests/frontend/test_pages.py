"""Layouts and callbacks over the fake service, without a browser."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import flask
import pytest
from dash import dcc
from dash.development.base_component import Component
from fastapi.testclient import TestClient
from plotly.utils import PlotlyJSONEncoder

import frontend
from frontend import panels
from frontend.client import Client, client
from frontend.components.graph import CONFIG, figure_graph
from frontend.errors import ApiError
from frontend.pages import new, run, run_head, runs
from frontend.results import Results

pytestmark = pytest.mark.usefixtures("request_context")


def components(root: Any) -> Iterator[Component]:
    if isinstance(root, list | tuple):
        for item in root:
            yield from components(item)
    elif isinstance(root, Component):
        yield root
        yield from components(getattr(root, "children", None))


def texts(root: Any) -> str:
    return json.dumps(root, cls=PlotlyJSONEncoder, ensure_ascii=False)


def results_of(made: dict[str, Any], **options: str) -> Results:
    return Results(client(), made["id"], dict(options))


@pytest.mark.parametrize("key", [panel.key for panel in panels.PANELS])
def test_every_panel_of_a_vessel_renders(vessel_run: dict[str, Any], timed_run: dict[str, Any], key: str) -> None:
    for made in (vessel_run, timed_run):
        found = results_of(made)
        panel = panels.find(key)
        assert panel.applies(found) == (key != "time" or made is timed_run)
        assert not panel.applies(found) or list(components(panel.render(found)))


def test_every_graph_keeps_to_itself(vessel_run: dict[str, Any], riser_run: dict[str, Any]) -> None:
    layouts: list[Any] = [runs.layout(), new.layout(), run.layout("x")]
    for made in (vessel_run, riser_run):
        found = results_of(made)
        layouts += [panel.render(found) for panel in panels.available(found)]
    graphs = [part for part in components(layouts) if isinstance(part, dcc.Graph)]
    assert len(graphs) > 20
    for graph in graphs:
        assert graph.config["displaylogo"] is False
        assert graph.config["showSendToCloud"] is False
        assert graph.config["plotlyServerURL"] == ""
    assert CONFIG["showEditInChartStudio"] is False


def test_graphs_are_made_in_one_place_only() -> None:
    [root] = frontend.__path__
    makers = [path.name for path in Path(root).rglob("*.py") if "dcc.Graph(" in path.read_text()]
    assert makers == ["graph.py"]
    made = figure_graph({"data": [], "layout": {"height": 300}}, "g", "σ of tension")
    assert made.config["toImageButtonOptions"]["filename"] == "slowdrift-σ-of-tension"


def test_the_seven_spectra(vessel_run: dict[str, Any]) -> None:
    found = results_of(vessel_run, line="stern-port")
    made = panels.find("spectra").render(found)
    graphs = [part for part in components(made) if isinstance(part, dcc.Graph)]
    assert len(graphs) == 7
    assert "Tension at end b, stern-port" in texts(made)
    assert found.used == {"line": "stern-port", "scale": "panels"}


def test_a_riser_has_its_own_tabs(riser_run: dict[str, Any]) -> None:
    found = results_of(riser_run)
    assert [panel.key for panel in panels.available(found)] == ["overview", "lines", "shape", "case"]
    assert "Amplitude of tension" in texts(panels.find("lines").render(found))
    overview = texts(panels.find("overview").render(found))
    assert "Largest tension amplitude" in overview
    assert "Vessel motion" not in overview


def test_overview_answers_in_metres_degrees_and_kilonewtons(vessel_run: dict[str, Any]) -> None:
    made = texts(panels.find("overview").render(results_of(vessel_run)))
    for said in ("surge [m]", "yaw [deg]", "Largest static tension", "4\u2009332 kN", "300 s"):
        assert said in made


def test_head_and_panel_of_a_finished_run(vessel_run: dict[str, Any]) -> None:
    title, facts, actions, told, tabs = run.head("succeeded", vessel_run["id"])
    assert title == "FPSO 2000 m"
    assert "frequency domain" in facts
    assert f"/api/v1/runs/{vessel_run['id']}/summary" in texts(actions)
    assert "Synthetic" in texts(told)
    assert len(tabs) == 8
    drawn, used = run.panel("spectra", {}, "succeeded", vessel_run["id"])
    assert used["line"] == "bow-port"
    assert drawn


def test_a_missing_run_says_so() -> None:
    title, *rest = run.head("missing", "nothing")
    assert title == "No such run"
    assert "All runs" in texts(rest)


def test_choices_change_only_when_the_reader_changes_them() -> None:
    ids = [{"type": "run-option", "name": "line"}]
    assert run.choose(["a"], ids, {}, {"line": "a", "scale": "log"}) is run.no_update
    assert run.choose(["b"], ids, {"scale": "log"}, {"line": "a"}) == {"scale": "log", "line": "b"}


def test_failure_comes_with_its_reason_once() -> None:
    failed = {"state": "failed", "reason": "Statics did not converge. Try a smaller step.", "warnings": ["w"]}
    told = texts(run_head.told(failed, {"failures": {"statics": failed["reason"]}, "warnings": ["w"]}))
    assert told.count("did not converge") == 1
    assert "Statics failed" in told
    assert told.count('"w"') == 1


def test_a_wrong_case_names_its_line(service: TestClient) -> None:
    listed = {item["name"]: item["yaml"] for item in service.get("/api/v1/examples").json()}
    text = listed["fpso-2000m"].replace("length: 3300 m", "length: -5 m", 1)
    with pytest.raises(ApiError) as refused:
        client().post_yaml("/cases/check", text)
    [error] = refused.value.errors
    assert error.field == "lines.bow-port.segments.0.length"
    assert error.message == "must be more than 0 m"
    assert error.line is not None
    assert "length: -5 m" in text.split("\n")[error.line - 1]


def test_pages_forward_the_cookie_and_nothing_else_of_the_caller(server: flask.Flask, service: TestClient) -> None:
    pages: Client = server.config["SLOWDRIFT_CLIENT"]
    service.get("/api/v1/runs")
    client().get("/runs")
    sent = pages._http._transport.seen[-1]  # type: ignore[attr-defined]
    assert sent.headers["cookie"] == "session=abc"


def test_a_silent_service_is_an_error_with_words() -> None:
    with pytest.raises(ApiError) as silent:
        Client("http://127.0.0.1:9", timeout=2).get("/runs")
    assert silent.value.status == 0
    assert "does not answer" in silent.value.title
