"""The runs behind docs/validation-volturnus.md: the example, and variants that take one thing away at a time."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from solver.case import Case, load_case, parse_case
from solver.io.export import describe, write_results
from solver.io.selection import select_channels
from solver.run import run
from solver.vessel.data import FileSource

ROOT = Path(__file__).resolve().parents[1]
EXAMPLE = ROOT / "examples" / "volturnus-s.yaml"
Summary = dict[str, Any]
CHANNELS = ("frequency/vessel/*", "time/vessel/*_spectrum", "time/line/*/top_tension_spectrum", "frequency/line/*/top_tension",
            "frequency/line/*/tension_std_*", "time/line/*/tension_std_*")  # fmt: skip


@dataclass(frozen=True)
class Solved:
    """One run: its summary, and the file of those channels that are drawn."""

    summary: Summary
    path: Path

    def channel(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates of the first axis and values."""
        with h5py.File(self.path) as file:
            item = file[name]
            return np.array(item.dims[0][0]), np.array(item)


class Runner:
    """Solves cases, and keeps them in a folder under their content hash."""

    def __init__(self, folder: Path):
        named = os.environ.get("SLOWDRIFT_VOLTURNUS")
        self.data = Path(named) if named else ROOT.parent / "shared" / "data" / "volturnus-s"
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def __call__(self, case: Case) -> Solved:
        text, path = (self.folder / f"{case.content_hash()[:16]}{ending}" for ending in (".json", ".nc"))
        if not (text.is_file() and path.is_file()):
            result = run(case, FileSource(self.data))
            channels = {channel.name: channel for channel in result.channels}
            dims = {name: channel.dims for name, channel in channels.items()}
            wanted = [item for item in CHANNELS if any(_match(name, item) for name in dims)]
            with path.open("wb+") as file:
                about = describe(result.summary, case.canonical(), case.name)
                chosen = select_channels(dims, channels.__getitem__, wanted or ["modes/*"])
                write_results(file, "netcdf", chosen, about)
            text.write_text(json.dumps(result.summary))
        return Solved(json.loads(text.read_text()), path)


def _match(name: str, pattern: str) -> bool:
    from fnmatch import fnmatchcase

    return fnmatchcase(name, pattern)


def example(seeds: int | None = None, **changes: Any) -> Case:
    """The example with changes by dotted path, `analyses__time_domain__step=0.025`; None takes a key away."""
    data = json.loads(load_case(EXAMPLE.read_bytes()).canonical())
    if seeds is not None:
        data["analyses"]["time_domain"]["seeds"] = seeds
    for path, value in changes.items():
        *parts, last = path.split("__")
        place = data
        for part in parts:
            place = place[part]
        if value is None:
            place.pop(last, None)
        else:
            place[last] = value
    return parse_case(data)


def modes_only(diameter: float, **changes: Any) -> Case:
    """Natural periods about the unloaded position, with a chain of this diameter of displacement."""
    return example(
        environment__seastates=[], analyses={"statics": {}, "modes": {"count": 14}},
        line_types__chain__diameter=diameter, **changes,
    )  # fmt: skip


def linear_hull(solved: Solved) -> dict[str, float]:
    """The linear damping that is statistically equal to the hull's quadratic one: √(8/π) σ of velocity times it."""
    quadratic = load_case(EXAMPLE.read_bytes()).vessel.damping.quadratic  # type: ignore[union-attr]
    found = {}
    for dof in ("surge", "sway", "heave", "roll", "pitch", "yaw"):
        omega, spectrum = solved.channel(f"frequency/vessel/{dof}")
        middle = 0.5 * (omega[1:] + omega[:-1])
        edges = np.concatenate([[2 * omega[0] - middle[0]], middle, [2 * omega[-1] - middle[-1]]])
        speed = float(np.sqrt(np.sum(spectrum * omega**2 * np.diff(edges))))
        found[dof] = float(f"{getattr(quadratic, dof) * np.sqrt(8 / np.pi) * speed:.4g}")
    return found
