"""The statistics of a summary as tables, both domains side by side: kN, m, deg (docs/export.md)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ..case import DOF, Case

Cell = str | int | float | None
Summary = Mapping[str, Any]
KILO = 1e-3
ENDS = {"end_a": 0, "end_b": -1}
BANDS = {"wf": "WF", "lf": "LF"}


@dataclass(frozen=True)
class Table:
    """One table: a header for each column, with its unit, and rows of as many cells."""

    title: str
    headers: list[str]
    rows: list[list[Cell]]


def statistics_tables(summary: Summary, case: Case) -> list[Table]:
    """The tables that a summary has something for; a column that would be empty is left out."""
    made = [_vessel(summary), _ends(summary), _lines(summary, case), _modes(summary), _statics(summary)]
    return [*(table for table in made if table is not None), _warnings(summary), _provenance(summary)]


@dataclass(frozen=True)
class _Column:
    header: str
    value: Callable[[Any], Cell]


def _table(title: str, columns: list[_Column], keys: Iterable[Any]) -> Table | None:
    """Rows of `keys`, columns without any number left out; None where only the first column is left."""
    keys = list(keys)
    cells = [[column.value(key) for key in keys] for column in columns]
    kept = [at for at, values in enumerate(cells) if at == 0 or any(value is not None for value in values)]
    if not keys or len(kept) < 2:
        return None
    rows = [[cells[at][row] for at in kept] for row in range(len(keys))]
    return Table(title, [columns[at].header for at in kept], rows)


def _found(data: Any, *path: Any) -> Any:
    """What stands at a path of keys and indices; None where it ends before."""
    for key in path:
        if isinstance(data, Mapping):
            data = data.get(key)
        elif isinstance(data, list) and isinstance(key, int) and -len(data) <= key < len(data):
            data = data[key]
        else:
            return None
    return data


def _times(factor: float, value: Any) -> float | None:
    return None if value is None else factor * float(value)


def _domains(header: str, unit: str, fd: Callable[[Any], Cell], td: Callable[[Any], Cell]) -> list[_Column]:
    return [
        _Column(f"{header}, frequency domain [{unit}]", fd), _Column(f"{header}, time domain [{unit}]", td)
    ]  # fmt: skip


def _vessel(summary: Summary) -> Table | None:
    fd, td, statics = (summary.get(key, {}) for key in ("frequency_domain", "time_domain", "statics"))
    unit = "m, deg"

    def scale(dof: str) -> float:
        return math.degrees(1.0) if dof in DOF[3:] else 1.0

    def at(data: Any, *path: Any) -> Callable[[str], Cell]:
        return lambda dof: _times(scale(dof), _found(data, *path, dof))

    def twice(data: Any, *path: Any) -> Callable[[str], Cell]:
        return lambda dof: _times(2.0 * scale(dof), _found(data, *path, dof))

    columns = [
        _Column("degree of freedom", lambda dof: dof),
        _Column(f"static position from the design position [{unit}]",
                lambda dof: _times(scale(dof), _found(statics, "vessel", "position", DOF.index(dof)))),
        _Column("mean wave drift force [kN, kN m]",
                lambda dof: _times(KILO, _found(statics, "vessel", "mean_drift", DOF.index(dof)))),
        _Column(f"mean about the static position, time domain [{unit}]", at(td, "vessel_mean")),
    ]  # fmt: skip
    for band, label in BANDS.items():
        columns += _domains(f"{label} σ", unit, at(fd, "vessel_std", band), at(td, "vessel_std", band))
        columns.append(_Column(f"{label} standard error of σ, time domain [{unit}]", at(td, "vessel_std_error", band)))
    for band, label in BANDS.items():
        columns += _domains(
            f"{label} significant (2σ)", unit, at(fd, "vessel_significant", band), twice(td, "vessel_std", band)
        )
    for band, label in (*BANDS.items(), ("combined", "combined")):
        header = f"{label} most probable maximum, frequency domain [{unit}]"
        columns.append(_Column(header, at(fd, "vessel_most_probable_max", band)))
    columns.append(_Column(f"amplitude, frequency domain [{unit}]", at(fd, "vessel_amplitude")))
    return _table("Vessel", columns, DOF) if any("vessel" in key for key in (*fd, *td, *statics)) else None


def _names(summary: Summary) -> list[str]:
    found: dict[str, None] = {}
    for key in ("statics", "frequency_domain", "time_domain"):
        found |= dict.fromkeys(_found(summary, key, "lines") or {})
    return list(found)


def _ends(summary: Summary) -> Table | None:
    """A row for each end of a line; axial forces are those of the element at the end."""
    fd, td, statics = (_found(summary, key, "lines") for key in ("frequency_domain", "time_domain", "statics"))

    def reaction(data: Any, *path: Any) -> Callable[[tuple[str, str]], Cell]:
        """Of the end itself: a number at (line, end or end_tension, …)."""
        return lambda key: _times(KILO, _found(data, key[0], path[0].format(key[1]), *path[1:]))

    def along(data: Any, *path: Any, factor: float = 1.0) -> Callable[[tuple[str, str]], Cell]:
        """Of the element at the end: the first or last of a list."""
        return lambda key: _times(factor * KILO, _found(data, key[0], *path, ENDS[key[1]]))

    columns = [
        _Column("line, end", lambda key: f"{key[0]}, {key[1].replace('_', ' ')}"),
        _Column("static tension [kN]", reaction(statics, "{}", "tension")),
        *_domains("mean axial force", "kN", along(fd, "tension_mean"), along(td, "tension_mean")),
    ]
    for band, label in BANDS.items():
        columns += _domains(f"{label} σ", "kN", along(fd, "tension_std", band), along(td, "tension_std", band))
        error = along(td, "tension_std_error", band)
        columns.append(_Column(f"{label} standard error of σ, time domain [kN]", error))
    for band, label in BANDS.items():
        fd_value = along(fd, "tension_significant", band)
        td_value = along(td, "tension_std", band, factor=2.0)
        columns += _domains(f"{label} significant (2σ)", "kN", fd_value, td_value)
    columns += [
        _Column("most probable maximum, frequency domain [kN]", along(fd, "tension_most_probable_max")),
        _Column("largest axial force, time domain [kN]", along(td, "tension_max")),
        _Column("least axial force, time domain [kN]", along(td, "tension_min")),
        _Column("largest reaction, time domain [kN]", reaction(td, "{}_tension", "max")),
        _Column("least reaction, time domain [kN]", reaction(td, "{}_tension", "min")),
        *_domains("amplitude", "kN", along(fd, "tension_amplitude"), along(td, "tension_first_harmonic")),
    ]
    return _table("Line ends", columns, [(name, end) for name in _names(summary) for end in ENDS])


def _lines(summary: Summary, case: Case) -> Table | None:
    """A row for each line: what it is, and its extremes with their places and utilisation."""
    fd, td, statics = (_found(summary, key, "lines") for key in ("frequency_domain", "time_domain", "statics"))

    def plain(key: str, factor: float = 1.0) -> Callable[[str], Cell]:
        return lambda name: _times(factor, _found(statics, name, key))

    columns = [
        _Column("line", lambda name: name),
        _Column("number of real lines [1]", lambda name: _found(statics, name, "multiplicity")),
        _Column("unstretched length [m]", plain("length")),
        _Column("length on the bed [m]", plain("grounded_length")),
        _Column("lowest breaking load [kN]", lambda name: _times(KILO, _breaking(case, name))),
        *_extreme("largest static axial force", statics, "tension", max, case),
        *_extreme("most probable maximum, frequency domain", fd, "tension_most_probable_max", max, case),
        *_extreme("largest axial force, time domain", td, "tension_max", max, case),
        *_extreme("least axial force, time domain", td, "tension_min", min, None),
        *_extreme("largest amplitude, frequency domain", fd, "tension_amplitude", max, None),
        *_extreme("largest amplitude, time domain", td, "tension_first_harmonic", max, None),
    ]
    return _table("Lines", columns, _names(summary))


def _extreme(header: str, data: Any, key: str, pick: Any, case: Case | None) -> list[_Column]:
    """The extreme of a list along each line, its arc length from end a and, with a case, its utilisation."""

    def value(name: str) -> float | None:
        values = _found(data, name, key)
        return None if not values else float(pick(values))

    def place(name: str) -> float | None:
        values, arc = _found(data, name, key), _found(data, name, "arc_length")
        return None if not values else _times(1.0, _found(arc, values.index(pick(values))))

    def utilisation(name: str) -> float | None:
        load, largest = None if case is None else _breaking(case, name), value(name)
        return None if load is None or largest is None else largest / load

    found = [
        _Column(f"{header} [kN]", lambda name: _times(KILO, value(name))),
        _Column(f"{header}: arc length from end a [m]", place),
    ]
    return [*found, _Column(f"{header}: utilisation [1]", utilisation)] if case is not None else found


def _breaking(case: Case, name: str) -> float | None:
    """The lowest breaking load of a line's types [N]."""
    loads = [case.line_types[segment.type].breaking_load for segment in case.lines[name].segments]
    return min((float(load) for load in loads if load is not None), default=None)


def _modes(summary: Summary) -> Table | None:
    modes = summary.get("modes") or []
    columns = [
        _Column("mode", lambda at: at + 1),
        _Column("largest motion", lambda at: modes[at].get("label")),
        _Column("period [s]", lambda at: modes[at].get("period")),
        _Column("damping by vessel [%]", lambda at: _times(100.0, modes[at].get("damping_vessel"))),
        _Column("damping by lines [%]", lambda at: _times(100.0, modes[at].get("damping_lines"))),
        _Column("mass of lines [%]", lambda at: _times(100.0, modes[at].get("mass_lines"))),
    ]
    return _table("Modes", columns, range(len(modes)))


def _statics(summary: Summary) -> Table | None:
    lines = _found(summary, "statics", "lines")

    def part(key: str, at: int, factor: float) -> Callable[[tuple[str, str]], Cell]:
        return lambda row: _times(factor, _found(lines, *row, key, at))

    columns = [
        _Column("line, end", lambda row: f"{row[0]}, {row[1].replace('_', ' ')}"),
        _Column("tension [kN]", lambda row: _times(KILO, _found(lines, *row, "tension"))),
        *(_Column(f"force {axis} on the support [kN]", part("force", at, KILO)) for at, axis in enumerate("xyz")),
        *(_Column(f"position {axis} [m]", part("position", at, 1.0)) for at, axis in enumerate("xyz")),
    ]
    return _table("Statics", columns, [(name, end) for name in lines or {} for end in ENDS])


def _warnings(summary: Summary) -> Table:
    rows: list[list[Cell]] = [["warning", "", text] for text in summary.get("warnings", [])]
    rows += [["not done", name, reason] for name, reason in summary.get("failures", {}).items()]
    return Table("Warnings", ["kind", "analysis", "text"], rows or [["none", "", ""]])


UNITS = {
    "tp": "s",
    "hs": "m",
    "hs_in_band": "m",
    "storm_duration": "s",
    "duration": "s",
    "build_up": "s",
    "time_step": "s",
}
OF_RUN = {
    "frequency_domain": ("storm_duration", "linearisation", "iterations"),
    "time_domain": ("realisations", "duration", "build_up", "time_step"),
}


def _provenance(summary: Summary) -> Table:
    rows: list[list[Cell]] = [["case", summary.get("case", ""), ""], ["analyses", ", ".join(summary["analyses"]), ""]]
    for key, value in (summary.get("provenance") or {}).items():
        if key == "seastates":
            for at, sea in enumerate(value):
                rows += [[f"sea {at + 1}, {name}", number, UNITS.get(name, "")] for name, number in sea.items()]
        else:
            rows.append([key, ", ".join(map(str, value)) if isinstance(value, list) else value, UNITS.get(key, "")])
    for analysis, keys in OF_RUN.items():
        held = summary.get(analysis, {})
        rows += [[f"{analysis}, {key}", held[key], UNITS.get(key, "")] for key in keys if key in held]
    return Table("Provenance", ["what", "value", "unit"], rows)
