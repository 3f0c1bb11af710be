"""Choices inside a panel: each is one entry of the run page's options and of its address."""

from __future__ import annotations

from collections.abc import Sequence

import dash_mantine_components as dmc

from frontend.components.attributes import hyphened


def option_id(name: str, owner: str = "run") -> dict[str, str]:
    return {"type": f"{owner}-option", "name": name}


def pick_line(lines: Sequence[str], chosen: str | None, owner: str = "run") -> dmc.Select:
    return dmc.Select(
        id=option_id("line", owner), label="Line", data=list(lines), value=chosen, allowDeselect=False, w=240,
        searchable=len(lines) > 12,
    )  # fmt: skip


def pick_response(choices: Sequence[tuple[str, str]], chosen: str) -> dmc.Select:
    """(value, text) of what there is a history of."""
    data = [{"value": value, "label": text} for value, text in choices]
    return dmc.Select(
        id=option_id("response"), label="Response", data=data, value=chosen, allowDeselect=False, w=280,
        searchable=len(data) > 18,
    )  # fmt: skip


def pick_seed(seeds: Sequence[str], chosen: str) -> dmc.Select:
    return dmc.Select(
        id=option_id("seed"), label="Seed", data=list(seeds), value=chosen, allowDeselect=False, w=110,
        searchable=len(seeds) > 12,
    )  # fmt: skip


def pick_one(name: str, label: str, choices: Sequence[tuple[str, str]], chosen: str, width: int) -> dmc.Select:
    """One of many, as a list: (value, text)."""
    data = [{"value": value, "label": text} for value, text in choices]
    return dmc.Select(
        id=option_id(name),
        label=label,
        data=data,
        value=chosen,
        allowDeselect=False,
        w=width,
        searchable=len(data) > 12,
    )


def pick(name: str, label: str, choices: Sequence[tuple[str, str]], chosen: str, owner: str = "run") -> dmc.Stack:
    """A few alternatives side by side: (value, text)."""
    data = [{"value": value, "label": text} for value, text in choices]
    control = dmc.SegmentedControl(
        id=option_id(name, owner), data=data, value=chosen, size="sm", **hyphened(aria_label=label)
    )
    return dmc.Stack([dmc.Text(label, size="sm", fw=500), control], gap=2)


def bar(*controls: object) -> dmc.Group:
    return dmc.Group(list(controls), gap="lg", align="flex-end", mb="sm")
