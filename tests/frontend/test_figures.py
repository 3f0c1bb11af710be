"""Pictures say what they show: units of people, axis names, both bands, legends."""

from __future__ import annotations

import numpy as np
import pytest

from frontend.figures import lines, raos, shape, spectra
from frontend.format import DEG
from frontend.panels.spectra import sigmas
from tests.frontend import fake_results as results

CHANNELS = results.fpso_channels()


@pytest.mark.parametrize("dof", results.DOFS)
def test_spectrum_shows_both_bands_with_their_sigma(dof: str) -> None:
    turning = dof in ("roll", "pitch", "yaw")
    drawn = spectra.spectrum(CHANNELS[f"frequency/vessel/{dof}"], 0.2, (dof, "deg" if turning else "m"), {"lf": 1.0})
    assert [len(trace["x"]) for trace in drawn["data"]] == [160, 200]
    layout = drawn["layout"]
    assert layout["yaxis"]["title"]["text"] == ("S [deg²·s/rad]" if turning else "S [m²·s/rad]")
    assert layout["xaxis"]["title"]["text"] == layout["xaxis2"]["title"]["text"] == "ω [rad/s]"
    assert [words["text"].split("=")[0] for words in layout["annotations"]] == ["LF  σ ", "WF"]


def test_sigmas_come_from_the_summary_in_units_of_people() -> None:
    summary = results.fpso_summary("x")
    assert sigmas(summary, "frequency/vessel/roll")["wf"] == pytest.approx(results.WF_SIGMA["roll"] * DEG)
    assert sigmas(summary, "frequency/line/bow-port/top_tension")["lf"] == pytest.approx(50.0)
    assert sigmas({}, "frequency/vessel/roll") == {}


def test_log_axis_keeps_both_bands_in_one_picture() -> None:
    drawn = spectra.spectrum(CHANNELS["frequency/line/bow-port/top_tension"], 0.2, ("Top", "kN"), {}, spectra.LOG)
    assert drawn["layout"]["yaxis"]["type"] == "log"
    assert drawn["layout"]["yaxis"]["title"]["text"] == "S [kN²·s/rad]"
    assert [trace["name"][:2] for trace in drawn["data"]] == ["LF", "WF"]


def test_the_narrow_peak_fills_its_panel() -> None:
    low, wave = spectra.split(results.OMEGA, results.spectrum("surge"), 0.2)
    assert spectra.energetic(low)[1] < 0.06
    assert spectra.energetic(wave)[0] >= 0.2


@pytest.mark.parametrize(
    ("case", "expected"),
    [
        ({"analyses": {"frequency_domain": {"wave": {"from": 0.25}, "low": {"to": 0.2}}}}, 0.2),
        ({"analyses": {"frequency_domain": {"wave": {"from": 0.25}, "low": {"to": 0.37}}}}, 0.37),
        ({"analyses": {"frequency_domain": {"wave": {"from": 0.25}}}}, 0.25),
        ({"analyses": {"frequency_domain": {"low": {"to": 0.15}}}}, 0.15),
        ({"analyses": {"frequency_domain": {}}}, 0.2),
        (None, 0.2),
    ],
)
def test_border_between_the_bands(case: dict | None, expected: float) -> None:
    assert spectra.border(case, results.OMEGA) == pytest.approx(expected, abs=0.005)


def test_a_frequency_that_is_there_twice_splits_the_bands() -> None:
    omega = np.array([0.1, 0.15, 0.2, 0.2, 0.25])
    low, wave = spectra.split(omega, np.ones(5), 0.2)
    assert list(low.omega) == [0.1, 0.15, 0.2]
    assert list(wave.omega) == [0.2, 0.25]


def test_rao_in_degrees_per_metre() -> None:
    drawn = raos.rao(CHANNELS["frequency/vessel/roll_rao_amplitude"], CHANNELS["frequency/vessel/roll_rao_phase"])
    assert drawn["layout"]["yaxis"]["title"]["text"] == "amplitude [deg/m]"
    assert drawn["layout"]["yaxis2"]["title"]["text"] == "phase [deg]"
    shown = np.asarray(drawn["data"][0]["y"])
    assert shown == pytest.approx(np.asarray(CHANNELS["frequency/vessel/roll_rao_amplitude"]["values"]) * DEG)


def test_bands_along_a_line_in_kilonewtons() -> None:
    names = {"wf": "tension_std_wf", "lf": "tension_std_lf", "total": "tension_std"}
    drawn = lines.bands_along("σ", {band: CHANNELS[f"frequency/line/bow-port/{n}"] for band, n in names.items()})
    assert [trace["name"] for trace in drawn["data"]] == ["wave frequency (WF)", "low frequency (LF)", "total"]
    assert drawn["layout"]["yaxis"]["title"]["text"] == "σ [kN]"
    assert drawn["layout"]["showlegend"]
    assert len({trace["line"]["color"] for trace in drawn["data"]}) == 3


def positions() -> dict:
    return {line: CHANNELS[f"static/line/{line}/position"] for line in results.LINES}


def test_scene_knows_depth_and_vessel() -> None:
    case = {
        "environment": {"depth": "2 km"},
        "vessel": {"centre_of_gravity": [0, 0, 5]},
        "lines": {name: {"end_b": {"fairlead": [1, 2, 3]}} for name in results.LINES},
    }
    made = shape.scene(positions(), case, [1.0, 0, 0, 0, 0, 0])
    assert made.depth == 2000.0
    assert made.vessel == (1.0, 0.0, 5.0)
    assert made.hull is not None
    assert len(made.hull) == 5
    drawn, stretch = shape.in_space(made)
    assert stretch == pytest.approx(1.0)
    names = {trace["name"] for trace in drawn["data"]}
    assert {"still water", "seabed", "fairleads", "bow-port"} <= names
    assert drawn["layout"]["scene"]["zaxis"]["title"]["text"] == "z [m]"
    assert shape.plan(made)["layout"]["yaxis"]["scaleanchor"] == "x"


def test_the_vessel_lies_where_its_heading_turns_it() -> None:
    case = {"vessel": {"centre_of_gravity": [10, 0, 5], "heading": "90 deg"}}
    assert shape.scene(positions(), case, [2.0, 3.0, 0, 0, 0, 0]).vessel == pytest.approx((-3.0, 12.0, 5.0))
    case["vessel"]["heading"] = "90 d"  # somebody is still writing
    assert shape.scene(positions(), case, None).vessel == (10.0, 0.0, 5.0)


def test_fairleads_at_end_a_are_the_hull_too() -> None:
    hulls = []
    for end, step in (("end_b", 1), ("end_a", -1)):
        case = {"lines": {name: {end: {"fairlead": [1, 2, 3]}} for name in results.LINES}}
        told = {name: {**channel, "values": channel["values"][::step]} for name, channel in positions().items()}
        hulls.append(shape.scene(told, case, None).hull)
    np.testing.assert_array_equal(*hulls)


def test_a_shallow_spread_is_stretched_and_says_so() -> None:
    flat = {name: {**c, "values": (np.asarray(c["values"]) * [1, 1, 0.02]).tolist()} for name, c in positions().items()}
    drawn, stretch = shape.in_space(shape.scene(flat, {"environment": {"depth": 40}}, None))
    assert stretch > 2
    ratio = drawn["layout"]["scene"]["aspectratio"]
    assert ratio["z"] / ratio["x"] > 0.25


def test_a_riser_without_vessel_has_no_hull() -> None:
    found = results.riser_channels()["static/line/riser/position"]
    made = shape.scene({"riser": found}, {"environment": {"depth": 100}, "lines": {}}, None)
    assert made.hull is None
    assert made.vessel is None
    drawn, _ = shape.in_space(made)
    assert "fairleads" not in {trace["name"] for trace in drawn["data"]}
    assert shape.profile(made)["layout"]["shapes"]
