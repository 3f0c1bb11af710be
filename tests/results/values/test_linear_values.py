"""Every value of statics, frequency domain and modes, and every channel of them, against plain formulas."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from .compare import differences
from .linear import Raw
from .linear_channels import as_dict, channels
from .scenes import Linear
from .whole import summary

Array = np.ndarray
SCENES = ("storm", "calm", "regular", "shaken")


@pytest.mark.parametrize("scene", SCENES)
def test_every_value_of_the_summary(linear: dict[str, Linear], scene: str) -> None:
    found = linear[scene].fresh()
    assert differences(summary(found), found.summary()) == []


@pytest.mark.parametrize("scene", SCENES)
def test_every_channel(linear: dict[str, Linear], scene: str) -> None:
    found = linear[scene]
    assert channel_differences(found) == []


def channel_differences(scene: Linear) -> list[str]:
    made = {name: as_dict(one) for name, one in scene.channels().items()}
    return differences(channels(Raw(scene)), made)


@pytest.mark.parametrize("scene", SCENES)
def test_forces_at_the_ends_hold_the_last_half_elements(linear: dict[str, Linear], scene: str) -> None:
    """The force on a support is the pull of the element next to it and half of that element's weight in water."""
    raw = Raw(linear[scene])
    for name in raw.names:
        x, tension, weight = raw.shapes[name], raw.tension(name), raw.weights(name)
        for end, beside, element, rows in ((-1, -2, -1, slice(0, 3)), (0, 1, 0, slice(3, 6))):
            along = (x[beside] - x[end]) / np.linalg.norm(x[beside] - x[end])
            expected = tension[element] * along - np.array([0.0, 0.0, 0.5 * weight[element]])
            size = np.linalg.norm(expected)
            np.testing.assert_allclose(raw.forces[name][rows], expected, atol=0.01 * size)


def test_scenes_have_what_they_claim(linear: dict[str, Linear]) -> None:
    """Slow drift that reaches into the wave band, a turned vessel, unlike ropes, an anchor at end b, curvature that two
    stiffnesses part: without them a wrong formula would pass."""
    storm: dict[str, Any] = linear["storm"].summary()["frequency_domain"]
    assert min(storm["origin_std"]["second_order"][dof] for dof in ("surge", "sway", "yaw")) > 1e-4
    solved = linear["storm"].solved
    assert solved.omega_low[-1] > solved.omega_wave[0]
    assert abs(solved.model.frame) > 0.3
    assert [line.anchor_end for line in solved.lines] == ["end_a", "end_b", "end_a"]
    EI = Raw(linear["shaken"]).along("riser", "EI")
    assert EI.min() > 0
    assert EI.max() / EI.min() == pytest.approx(3)
