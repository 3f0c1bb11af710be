"""Lines turned round so that the march finds every fairlead at end b, and what it recorded turned back (T9)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..kernels.arrays import GROUNDED, TENSION_A, TENSION_B, TOUCHDOWN, VERTICAL_A, VERTICAL_B
from ..model.line import LineModel
from ..outcome import CaseError, FieldError
from ..statics.solve import StaticState

Array = np.ndarray
SWAPPED = [TENSION_A, TENSION_B, VERTICAL_A, VERTICAL_B]  # rows of the two ends exchanged
WHOLE = ("depth", "contact", "current_z", "current_v")  # of a line, not of its elements or nodes


def facing(static: StaticState) -> tuple[StaticState, tuple[int, ...]]:
    """The same equilibrium with every fairlead at end b, and the indices of the lines turned round for it.

    Raises CaseError for a line with a fairlead at both ends.
    """
    lines, shapes = list(static.lines), list(static.state.shapes)
    forces, turned = list(static.state.end_forces), []
    for index, line in enumerate(lines):
        if line.end_a.kind != "fairlead":
            continue
        if line.end_b.kind == "fairlead":
            raise CaseError([FieldError(
                ("lines", line.name, "end_a", "fairlead"), "the time domain takes a fairlead at one end of a line only"
            )])  # fmt: skip
        lines[index], shapes[index] = _turned(line), np.ascontiguousarray(shapes[index][::-1])
        forces[index] = np.concatenate([forces[index][3:], forces[index][:3]])
        turned.append(index)
    if not turned:
        return static, ()
    state = replace(static.state, shapes=shapes, end_forces=forces)
    return replace(static, lines=tuple(lines), state=state), tuple(turned)


def _turned(line: LineModel) -> LineModel:
    parts = {name: values for name, values in line.arrays._asdict().items() if name not in WHOLE}
    turned: dict[str, Any] = {name: np.ascontiguousarray(values[::-1]) for name, values in parts.items()}
    arrays = line.arrays._replace(**turned)
    return replace(line, arrays=arrays, end_a=line.end_b, end_b=line.end_a, anchor_at_b=not line.anchor_at_b)


def turn_back(
    static: StaticState, turned: tuple[int, ...], elements: tuple[Array, ...], ends: Array, ends_range: Array
) -> None:
    """Bring what was recorded of turned lines into the order of the case, in place.

    elements : arrays (..., N, L, S), padding first; ends : (n, 6, L, S), rows ENDS; ends_range : (2, 4, L, S), the first four.
    """
    most = max(line.nodes for line in static.lines)
    for index in turned:
        real = slice(most - static.lines[index].nodes, None)
        for values in elements:
            values[..., real, index, :] = values[..., real, index, :][..., ::-1, :].copy()
        for values in (ends, ends_range):
            values[:, :4, index] = values[:, SWAPPED, index]
        touching = ends[:, GROUNDED, index] > 0.0
        ends[:, TOUCHDOWN, index] = np.where(touching, static.lines[index].length - ends[:, TOUCHDOWN, index], 0.0)
