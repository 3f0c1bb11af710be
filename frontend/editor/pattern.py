"""Lines made from a line: a copy, its mirror image, a ring of them by azimuth. On trees as `text.read` gives them.

Turning is about the vertical through the vessel's centre of gravity (through the origin without a vessel), for fairleads,
azimuths and points alike.
"""

from __future__ import annotations

import copy as copying
import math
import re
from collections.abc import Callable
from typing import Any

from frontend.editor.text import EditError

Tree = dict[str, Any]
_QUANTITY = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")
_LENGTHS = {"": 1.0, "m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "ft": 0.3048, "in": 0.0254}
Turn = Callable[[float, float], tuple[float, float]]
MOST = 100


def quantity(value: Any, what: str) -> tuple[float, str]:
    """(number, unit) of a scalar as written."""
    found = _QUANTITY.fullmatch(str(value))
    if not found:
        raise EditError(f"{what} {value!r} is not a number with a unit")
    return float(found[1]), found[2]


def metres(value: Any, what: str) -> float:
    number, unit = quantity(value, what)
    if unit not in _LENGTHS:
        raise EditError(f"{what} {value!r} is not a length; use one of {', '.join(u for u in _LENGTHS if u)}")
    return number * _LENGTHS[unit]


def degrees(value: Any, what: str) -> float:
    number, unit = quantity(value, what)
    if unit not in ("deg", "°", "rad"):
        raise EditError(f"{what} {value!r} needs its unit: deg or rad")
    return number * (180 / math.pi if unit == "rad" else 1.0)


def shown(number: float) -> str:
    """Six decimals at most, no minus before a zero."""
    return f"{round(number, 6) + 0.0:.10g}"


def copy(tree: Tree, name: str, edit: dict[str, Any]) -> Tree:
    """The same line under another name."""
    return {str(edit.get("to") or free_name(tree, f"{name} copy")): copying.deepcopy(tree["lines"][name])}


def mirror(tree: Tree, name: str, edit: dict[str, Any]) -> Tree:
    """The image on the other side of the vessel's axis (`axis: x`) or of its midship plane (`axis: y`)."""
    about_x = str(edit.get("axis", "x")) == "x"
    heading = _heading(tree)
    line = copying.deepcopy(tree["lines"][name])

    def flip(x: float, y: float) -> tuple[float, float]:
        return (x, -y) if about_x else (-x, y)

    def angle(value: float) -> float:
        return (2 * heading - value if about_x else 180 + 2 * heading - value) % 360

    _move(tree, line, flip, angle)
    return {str(edit.get("to") or free_name(tree, f"{name} mirrored")): line}


def repeat(tree: Tree, name: str, edit: dict[str, Any]) -> Tree:
    """`count` lines in all, each turned by `step` degrees (360/count when left out) from the one before."""
    try:
        count = int(edit.get("count") or 0)
        step = float(edit.get("step") or 0) or 360.0 / max(count, 1)
    except ValueError:
        raise EditError("a pattern needs a number of lines and an angle in degrees") from None
    if not 2 <= count <= MOST or not math.isfinite(step):
        raise EditError(f"{count} lines in a pattern; allowed: 2 to {MOST}")
    made: Tree = {}
    for index in range(1, count):
        line = copying.deepcopy(tree["lines"][name])
        _move(tree, line, *_rotation(index * step))
        made[free_name({"lines": tree["lines"] | made}, f"{name} {index + 1}")] = line
    return made


def _rotation(step: float) -> tuple[Turn, Callable[[float], float]]:
    """How a point and an azimuth turn by `step` degrees."""
    c, s = math.cos(math.radians(step)), math.sin(math.radians(step))

    def turn(x: float, y: float) -> tuple[float, float]:
        return c * x - s * y, s * x + c * y

    return turn, lambda angle: (angle + step) % 360


def free_name(tree: Tree, wanted: str) -> str:
    """`wanted`, or with a number behind it when there is one of that name."""
    names, number, name = tree.get("lines") or {}, 2, wanted[:60]
    while name in names:
        name, number = f"{wanted[:56]} {number}", number + 1
    return name


def _heading(tree: Tree) -> float:
    heading = (tree.get("vessel") or {}).get("heading")
    return degrees(heading, "vessel.heading") if heading is not None else 0.0


def _centre(tree: Tree) -> tuple[float, float]:
    """Where the vertical axis stands, earth axes [m]."""
    given = (tree.get("vessel") or {}).get("centre_of_gravity") or ["0", "0", "0"]
    x, y = (metres(part, "vessel.centre_of_gravity") for part in given[:2])
    c, s = math.cos(math.radians(_heading(tree))), math.sin(math.radians(_heading(tree)))
    return c * x - s * y, s * x + c * y


def _move(tree: Tree, line: Tree, turn: Turn, angle: Callable[[float], float]) -> None:
    """Both ends of a line moved: fairleads in the vessel's axes, points and azimuths in the earth's."""
    heading = math.radians(_heading(tree))
    cx, cy = _centre(tree)
    c, s = math.cos(heading), math.sin(heading)

    def earth(x: float, y: float) -> tuple[float, float]:
        """About the centre, through the vessel's axes and back: a mirror plane turns with the vessel."""
        dx, dy = x - cx, y - cy
        bx, by = turn(c * dx + s * dy, -s * dx + c * dy)
        return cx + c * bx - s * by, cy + s * bx + c * by

    for name in ("end_a", "end_b"):
        end = line.get(name) or {}
        anchor = end.get("anchor") or {}
        if end.get("fairlead"):
            end["fairlead"] = _moved(end["fairlead"], turn, f"{name}.fairlead")
        if end.get("pinned"):
            end["pinned"] = _moved(end["pinned"], earth, f"{name}.pinned")
        if end.get("motion"):
            raise EditError(f"{name} moves by itself (motion); mirror or turn it by hand")
        if anchor.get("point"):
            anchor["point"] = _moved(anchor["point"], earth, f"{name}.anchor.point")
        if anchor.get("azimuth") is not None:
            anchor["azimuth"] = f"{shown(angle(degrees(anchor['azimuth'], f'{name}.anchor.azimuth')))} deg"


def _moved(point: list[Any], turn: Turn, what: str) -> list[Any]:
    x, y = turn(metres(point[0], what), metres(point[1], what))
    return [shown(x), shown(y), *point[2:]]
