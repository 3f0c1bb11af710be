"""Refusals, warnings and emptiness, each with what to do next."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc

from frontend.errors import ApiError


def refusal(error: ApiError) -> dmc.Alert:
    """What the service said, and its fields when it named any."""
    fields = [dmc.ListItem([dmc.Code(e.field), f" {e.message}"] if e.field else e.message) for e in error.errors[:20]]
    children: list[Any] = [dmc.Text(error.detail, size="sm")] if error.detail else []
    if fields:
        children.append(dmc.List(fields, size="sm"))
    return dmc.Alert(children, title=error.title, color="red", variant="light")


def warnings(texts: list[str]) -> dmc.Alert | None:
    if not texts:
        return None
    body = dmc.List([dmc.ListItem(text) for text in texts], size="sm") if len(texts) > 1 else texts[0]
    title = f"{len(texts)} warnings" if len(texts) > 1 else "Warning"
    return dmc.Alert(body, title=title, color="yellow", variant="light", className="sd-warnings")


def empty(title: str, text: Any, *actions: Any) -> dmc.Paper:
    return dmc.Paper(
        dmc.Stack([dmc.Title(title, order=3), dmc.Text(text, c="dimmed", maw=560), dmc.Group(list(actions))], gap="sm"),
        withBorder=True,
        p="xl",
        className="sd-empty",
    )
