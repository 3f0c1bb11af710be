"""Tables of a summary for a terminal: kN (N at model scale), m, degrees."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from rich.console import Console
from rich.table import Table

from cli.catalogue import value_lines

DOF = ("surge", "sway", "heave", "roll", "pitch", "yaw")


def show(summary: dict[str, Any], console: Console | None = None) -> None:
    """Print what a summary holds, one table an analysis, and its warnings."""
    console = console or Console()
    console.print(f"[bold]{summary['case']}[/bold]")
    for name, make in (
        ("line_types", _line_types),
        ("statics", _statics),
        ("modes", _modes),
        ("frequency_domain", _frequency),
        ("time_domain", _time),
    ):
        if name in summary:
            for table in make(summary[name]):
                console.print(table, highlight=False, markup=False, soft_wrap=isinstance(table, str))
    for warning in summary.get("warnings", []):
        console.print(f"[yellow]warning:[/yellow] {warning}", highlight=False)


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify="left", title_style="bold")
    for index, column in enumerate(columns):
        table.add_column(column, justify="left" if index == 0 else "right")
    return table


def _line_types(types: dict[str, Any]) -> list[Table | str]:
    if not types:
        return []
    table = _table("Line types", "type", "diameter mm", "mass kg/m", "in water N/m", "EA MN", "breaking load kN")
    told: list[Table | str] = [table]
    for name, kind in types.items():
        load = kind.get("breaking_load")
        table.add_row(
            name, f"{1e3 * kind['diameter']:g}", f"{kind['mass']:.2f}", f"{kind['weight_in_water']:.2f}",
            f"{kind['EA'] / 1e6:.2f}", "" if load is None else f"{load / 1e3:.1f}",
        )  # fmt: skip
        if "catalogue" in kind:
            lines = value_lines(kind["catalogue"]["values"])
            told.append("\n  ".join([f"{name}, from the catalogue, {kind['catalogue']['name']}:", *lines]))
    return told


def _force_unit(forces: Iterable[float]) -> tuple[float, str]:
    """Size and name of the unit of forces: N where all of them are below 1 kN, so that a model in a tank has digits."""
    return (1.0, "N") if max(map(abs, forces), default=1e3) < 1e3 else (1e3, "kN")


def _statics(statics: dict[str, Any]) -> list[Table]:
    size, unit = _force_unit(line[end]["tension"] for line in statics["lines"].values() for end in ("end_a", "end_b"))
    table = _table(
        "Statics",
        "line, end",
        f"tension {unit}",
        f"force x {unit}",
        f"force y {unit}",
        f"force z {unit}",
        "length m",
        "on the bed m",
        f"in water {unit}",
    )
    for name, line in statics["lines"].items():
        for end in ("end_a", "end_b"):
            forces = [f"{value / size:.2f}" for value in line[end]["force"]]
            first = end == "end_a"
            table.add_row(
                f"{name}, {end[-1]}", f"{line[end]['tension'] / size:.2f}", *forces,
                f"{line['length']:.2f}" if first else "", f"{line['grounded_length']:.1f}" if first else "",
                f"{line['weight_in_water'] / size:.1f}" if first else "",
            )  # fmt: skip
    tables = [table]
    if "vessel" in statics:
        offset = _table("Static position", *("from the design position", *DOF))
        offset.add_row(
            "m, deg", *(_motion(dof, value) for dof, value in zip(DOF, statics["vessel"]["position"], strict=True))
        )
        tables.append(offset)
    return tables


def _motion(dof: str, value: float) -> str:
    return f"{math.degrees(value):.3f}" if dof in DOF[3:] else f"{value:.3f}"


def _modes(modes: list[dict[str, Any]]) -> list[Table]:
    table = _table("Modes", "mode", "period s", "damping by vessel %", "damping by lines %", "mass of lines %")
    for mode in modes:
        shares = (100 * mode[key] for key in ("damping_vessel", "damping_lines", "mass_lines"))
        table.add_row(mode["label"], f"{mode['period']:.1f}", *(f"{share:.2f}" for share in shares))
    return [table]


def _frequency(result: dict[str, Any]) -> list[Table]:
    tables = []
    if "vessel_std" in result:
        table = _table("Motion, standard deviation (m, deg)", "band", *DOF)
        for band, label in (("wf", "wave frequency"), ("lf", "low frequency")):
            table.add_row(label, *(_motion(dof, result["vessel_std"][band][dof]) for dof in DOF))
        tables.append(table)
    if any("tension_std" in line for line in result["lines"].values()):
        size, unit = _force_unit(line["largest"]["tension"] for line in result["lines"].values())
        table = _table(
            f"Tension, standard deviation ({unit})",
            "line",
            "WF end a",
            "WF end b",
            "LF end a",
            "LF end b",
            "maximum 3 h",
        )
        for name, line in result["lines"].items():
            wf, lf = line["tension_std"]["wf"], line["tension_std"]["lf"]
            values = (wf[0], wf[-1], lf[0], lf[-1], line["largest"]["tension"])
            table.add_row(name, *(f"{value / size:.1f}" for value in values))
    else:
        size, unit = _force_unit(max(line["tension_amplitude"]) for line in result["lines"].values())
        table = _table(f"Tension, amplitude ({unit})", "line", "end a", "end b", "largest", "mean")
        for name, line in result["lines"].items():
            values = line["tension_amplitude"]
            shown = (values[0], values[-1], max(values), sum(values) / len(values))
            table.add_row(name, *(f"{value / size:.2f}" for value in shown))
    return [*tables, table]


def _time(result: dict[str, Any]) -> list[Table]:
    tables = []
    count = result["realisations"]
    if "vessel_std" in result:
        table = _table(f"Time domain, motion, standard deviation ± error of {count} seeds (m, deg)", "band", *DOF)
        for band, label in (("wf", "wave frequency"), ("lf", "low frequency")):
            std, error = result["vessel_std"][band], result["vessel_std_error"][band]
            table.add_row(label, *(f"{_motion(dof, std[dof])} ± {_motion(dof, error[dof])}" for dof in DOF))
        tables.append(table)
    size, unit = _force_unit(line["largest"]["tension"] for line in result["lines"].values())
    table = _table(
        f"Time domain, tension ({unit})",
        "line",
        "WF σ end a",
        "WF σ end b",
        "LF σ end b",
        "least at end b",
        "largest at end b",
        "largest at end a",
        "anchor up, max.",
    )
    for name, line in result["lines"].items():
        wf, lf, end = line["tension_std"]["wf"], line["tension_std"]["lf"], line["end_b_tension"]
        anchor = (line["end_a_tension"]["max"], line["anchor_vertical"]["max"])
        values = (wf[0], wf[-1], lf[-1], end["min"], end["max"], *anchor)
        table.add_row(name, *(f"{value / size:.1f}" for value in values))
    return [*tables, table]
