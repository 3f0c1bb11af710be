"""Links inside the pages, wherever they are mounted."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import get_relative_path

from frontend.client import API


def page_path(path: str) -> str:
    """`/runs/x` as the browser sees it."""
    return str(get_relative_path(path))


def button_link(text: str, path: str, **props: Any) -> dmc.Anchor:
    """A link that looks like a button and changes the page without reloading it."""
    kind = props.pop("kind", "filled")
    return dmc.Anchor(text, href=page_path(path), className=f"sd-button sd-button-{kind}", underline="never", **props)


def rest(path: str) -> str:
    """An address of the REST API for the browser itself (downloads, event streams)."""
    return API + path
