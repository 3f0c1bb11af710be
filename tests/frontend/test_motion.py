"""The system in motion: frames go once round about the static shape, and say by how much they exaggerate."""

from __future__ import annotations

from typing import Any

import flask
import numpy as np
import pytest

from frontend.client import client
from frontend.figures.motion import FRAMES, SHARE, exaggeration, oscillation
from frontend.figures.shape import Scene
from frontend.panels import motion
from frontend.results import Results

NODES = np.stack([np.linspace(0.0, 300.0, 7), np.zeros(7), np.linspace(-100.0, 0.0, 7)], axis=1)
MOVED = np.zeros((7, 3), dtype=complex)
MOVED[:, 1] = 1j * np.linspace(0.0, 2.0, 7)


def test_frames_are_the_real_part_through_one_turn() -> None:
    figure, _ = oscillation(Scene({"a": NODES}, 100.0), {"a": MOVED}, 5.0)
    assert len(figure["frames"]) == FRAMES == len(figure["layout"]["sliders"][0]["steps"])
    quarter = figure["frames"][FRAMES // 4]["data"][0]
    np.testing.assert_allclose(quarter["y"], -5.0 * np.linspace(0.0, 2.0, 7), atol=1e-12)
    np.testing.assert_allclose(quarter["x"], NODES[:, 0])
    mean = np.mean([frame["data"][0]["y"] for frame in figure["frames"]], axis=0)
    np.testing.assert_allclose(mean, 0.0, atol=1e-12)


def test_axes_hold_every_frame() -> None:
    figure, _ = oscillation(Scene({"a": NODES}, 100.0), {"a": MOVED}, 5.0)
    low, high = figure["layout"]["scene"]["yaxis"]["range"]
    assert low < -10.0
    assert high > 10.0
    assert figure["layout"]["scene"]["zaxis"]["range"][0] < -100.0


def test_exaggeration_makes_the_largest_a_share_of_the_picture() -> None:
    scale = exaggeration(Scene({"a": NODES}, 100.0), {"a": MOVED})
    assert scale * 2.0 == pytest.approx(SHARE * 300.0)
    assert exaggeration(Scene({"a": NODES}, 100.0), {"a": 0 * MOVED}) == 1.0


def test_modes_and_waves_are_offered_and_drawn(request_context: flask.Flask, vessel_run: dict[str, Any]) -> None:
    for chosen, words in (("mode:1", "mode 2, sway"), ("wave:3", "waves of 0.500 rad/s")):
        results = Results(client(), vessel_run["id"], {"motion": chosen})
        offered = motion.choices(results)
        assert offered[chosen].startswith(words)
        motion.render(results)
        assert results.used["motion"] == chosen
        moved, _ = motion.displacements(results, chosen)
        assert moved["bow-port"].shape == (51, 3)
