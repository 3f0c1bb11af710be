"""The time domain on the pages: histories in units of people, closer looks from the server, both domains side by side."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from dash import dcc

from frontend import panels
from frontend.figures import lines, spectra
from frontend.figures.history import history, seen
from frontend.format import DEG
from frontend.pages import run
from frontend.panels import history as panel
from frontend.panels import overview
from tests.frontend import fake_results as results
from tests.frontend import fake_time
from tests.frontend.test_pages import components, results_of, texts

CHANNELS = results.fpso_channels() | fake_time.fpso_time_channels()
in_request = pytest.mark.usefixtures("request_context")


def one_seed(name: str) -> dict[str, Any]:
    return fake_time.look(CHANNELS[name], None, None, None, 2)


@pytest.mark.parametrize(
    ("name", "title", "factor"),
    [("time/vessel/surge", "x [m]", 1.0), ("time/vessel/roll", "x [deg]", DEG),
     ("time/line/bow-port/end_b_tension", "x [kN]", 1e-3)],
)  # fmt: skip
def test_a_history_has_units_and_zooms_along_time_only(name: str, title: str, factor: float) -> None:
    drawn = history(one_seed(name), "x")
    [trace] = drawn["data"]
    assert trace["y"] == pytest.approx(factor * np.asarray(CHANNELS[name]["values"])[:, 1])
    assert drawn["layout"]["yaxis"]["title"]["text"] == title
    assert drawn["layout"]["xaxis"]["title"]["text"].endswith("[s]")
    assert drawn["layout"]["yaxis"]["fixedrange"]


@pytest.mark.parametrize(
    ("change", "expected"),
    [({"xaxis.range[0]": 20, "xaxis.range[1]": 10.5}, (10.5, 20.0)), ({"xaxis.range": [1, 2]}, (1.0, 2.0)),
     ({"xaxis.autorange": True}, "all"), ({"autosize": True}, None), (None, None)],
)  # fmt: skip
def test_what_a_change_of_layout_shows(change: dict[str, Any] | None, expected: Any) -> None:
    assert seen(change) == expected


@pytest.mark.parametrize("scale", [spectra.PANELS, spectra.LOG])
def test_both_domains_in_a_spectrum(scale: str) -> None:
    beside = ("time domain, 2 seeds", CHANNELS["time/vessel/surge_spectrum"])
    drawn = spectra.spectrum(CHANNELS["frequency/vessel/surge"], 0.2, ("surge", "m"), {}, scale, beside=beside)
    assert len(drawn["data"]) == 4
    named = [trace["name"] for trace in drawn["data"] if trace.get("showlegend")]
    assert named[-1] == "time domain, 2 seeds"
    if scale == spectra.PANELS:
        assert named == ["frequency domain", "time domain, 2 seeds"]
        assert [trace["xaxis"] for trace in drawn["data"]] == ["x", "x2", "x", "x2"]
    assert drawn["layout"]["showlegend"]


def test_domains_along_a_line_have_a_legend() -> None:
    both = {"a": CHANNELS["frequency/line/bow-port/tension_std_wf"], "b": CHANNELS["time/line/bow-port/tension_std_wf"]}
    drawn = lines.domains_along("σ WF of tension", both)
    assert [trace["name"] for trace in drawn["data"]] == ["a", "b"]
    assert drawn["layout"]["yaxis"]["title"]["text"] == "σ WF of tension [kN]"


@in_request
def test_the_tab_draws_the_chosen_response_decimated(timed_run: dict[str, Any]) -> None:
    found = results_of(timed_run, response="line:stern-port", seed="2")
    made = panels.find("time").render(found)
    [graph] = [part for part in components(made) if isinstance(part, dcc.Graph)]
    assert 1000 < len(graph.figure["data"][0]["x"]) <= panel.POINTS
    assert graph.id == {"type": "history", "name": "time/line/stern-port/end_b_tension?2"}
    assert found.used == {"response": "line:stern-port", "seed": "2"}
    said = texts(made)
    for words in ("Tension at end b, stern-port, seed 2", "4\u2009520", "2 seeds of 50 min 00 s", "[kN]"):
        assert words in said


@in_request
def test_a_closer_look_comes_from_the_server(timed_run: dict[str, Any]) -> None:
    graph = {"type": "history", "name": "time/vessel/surge?1"}
    patch = panel.closer({"xaxis.range[0]": 100.0, "xaxis.range[1]": 200.0}, graph, timed_run["id"])
    values = {tuple(step["location"]): step["params"]["value"] for step in patch.to_plotly_json()["operations"]}
    assert len(values["data", 0, "x"]) == 201
    assert values["layout", "xaxis", "range"] == [100.0, 200.0]
    assert panel.closer({"autosize": True}, graph, timed_run["id"]) is run.no_update
    assert panel.closer({"xaxis.autorange": True}, graph | {"name": "time/none?1"}, timed_run["id"]) is run.no_update


@in_request
def test_spectra_and_lines_show_both_domains(timed_run: dict[str, Any], vessel_run: dict[str, Any]) -> None:
    for key in ("spectra", "lines"):
        assert "time domain, 2 seeds" in texts(panels.find(key).render(results_of(timed_run)))
        assert "time domain" not in texts(panels.find(key).render(results_of(vessel_run)))


@in_request
def test_a_riser_compares_amplitudes(timed_riser: dict[str, Any]) -> None:
    found = results_of(timed_riser)
    assert [p.key for p in panels.available(found)] == ["overview", "time", "lines", "shape", "case"]
    said = texts(panels.find("lines").render(found))
    for words in ("frequency domain", "time domain, first harmonic", "time domain, half the range"):
        assert words in said
    assert overview.domains_table(found.summary) is None
    assert panels.find("time").render(found)


def test_domains_side_by_side_in_numbers() -> None:
    summary = results.fpso_summary("x")
    assert overview.domains_table(summary) is None
    made = texts(overview.domains_table(fake_time.fpso_with_time(summary)))
    for words in ("surge WF [m]", "1.25 ± 0.024", "96.2 %", "95.2 %", "same waves", "yaw LF [deg]"):
        assert words in made
