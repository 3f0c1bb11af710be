"""Response amplitude operators of the vessel."""

from __future__ import annotations

from typing import Any

from frontend.components.cards import grid, picture
from frontend.figures.raos import rao
from frontend.format import DOFS
from frontend.results import Results


def _name(dof: str, part: str) -> str:
    return f"frequency/vessel/{dof}_rao_{part}"


def applies(results: Results) -> bool:
    return any(_name(dof, "amplitude") in results.names for dof in DOFS)


def render(results: Results) -> list[Any]:
    found = results.channels(_name(dof, part) for dof in DOFS for part in ("amplitude", "phase"))
    drawn = [
        picture(dof.capitalize(), rao(found[_name(dof, "amplitude")], found.get(_name(dof, "phase"))), f"rao-{dof}")
        for dof in DOFS
        if _name(dof, "amplitude") in found
    ]
    return [grid(drawn, wide=3)]
