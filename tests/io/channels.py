"""Channels of every shape, for the tests of exports."""

from __future__ import annotations

import numpy as np

from solver.io.selection import Selection, select_channels
from solver.results.channel import Axis, Channel


def made(dtype: type = np.float64) -> dict[str, Channel]:
    generator = np.random.default_rng(7)

    def channel(name: str, unit: str, *axes: Axis, band: str = "total") -> Channel:
        shape = tuple(len(axis.values) for axis in axes)
        return Channel(name, generator.normal(size=shape).astype(dtype), axes, unit, f"what {name} is", band)

    time, seed = Axis("time", "s", 0.5 * np.arange(40)), Axis("seed", "", np.arange(3.0, 6.0))
    omega, wave = Axis("omega", "rad/s", np.linspace(0.01, 1.2, 30)), Axis("omega", "rad/s", np.linspace(0.2, 1.2, 20))
    nodes, elements = Axis("arc_length", "m", np.linspace(0, 100, 11)), Axis("arc_length", "m", np.linspace(5, 95, 10))
    axis, mode, dof = (
        Axis("axis", "", np.arange(3.0)),
        Axis("mode", "", np.arange(1.0, 3)),
        Axis("dof", "", np.arange(6.0)),
    )
    found = [
        channel("static/line/bow-port/position", "m", nodes, axis), channel("static/line/bow-port/tension", "N", elements),
        channel("frequency/vessel/surge", "m2 s/rad", omega),
        channel("frequency/vessel/surge_rao_amplitude", "m/m", wave, band="wf"),
        channel("frequency/line/bow-port/tension", "N2 s/rad", omega, elements), channel("modes/vessel/shape", "1", mode, dof),
        channel("time/vessel/surge", "m", time, seed), channel("time/vessel/heave", "m", time, seed),
        channel("time/line/bow 2.b/top_tension", "N", time, seed),
    ]  # fmt: skip
    return {item.name: item for item in found}


def selection(patterns: tuple[str, ...] = (), seed: int | None = None, dtype: type = np.float64) -> Selection:
    channels = made(dtype)
    return select_channels({name: item.dims for name, item in channels.items()}, channels.__getitem__, patterns, seed)
