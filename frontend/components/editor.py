"""A YAML editor of our own: a text area over its coloured copy, line numbers with marks, errors that lead to lines."""

from __future__ import annotations

from typing import Any

import dash_mantine_components as dmc
from dash import dcc, html

from frontend.components.attributes import hyphened
from frontend.errors import ApiError, FieldError

PLACEHOLDER = "slowdrift: 1\nname: …\n\nChoose an example above, or paste a case here."


def yaml_editor(text_id: str, label: str) -> html.Div:
    """`assets/editor.js` colours the copy below the text area and numbers the lines."""
    area = dcc.Textarea(
        id=text_id,
        value="",
        placeholder=PLACEHOLDER,
        spellCheck=False,
        wrap="off",
        className="sd-editor-text",
    )
    hidden = dmc.VisuallyHidden(html.Label(label, htmlFor=text_id))
    gutter = html.Div(id="case-gutter", className="sd-editor-gutter", **hyphened(aria_hidden="true"))
    paint = html.Pre(id="case-paint", className="sd-editor-paint", **hyphened(aria_hidden="true"))
    return html.Div(
        [gutter, html.Div([hidden, paint, area], className="sd-editor-main")], className="sd-editor", id="editor"
    )


def complaint(title: str, detail: str = "") -> dmc.Alert:
    return dmc.Alert(detail, title=title, color="red", variant="light", mb="xs")


def problems(error: ApiError) -> Any:
    """All field errors; each is a button that puts the cursor on its line."""
    if not error.errors:
        return complaint(error.title, error.detail)
    count = len(error.errors)
    title = f"{count} things to mend" if count > 1 else "One thing to mend"
    return dmc.Alert(
        html.Ul([html.Li(_entry(entry)) for entry in error.errors], className="sd-problems"),
        title=title, color="red", variant="light",
    )  # fmt: skip


def _entry(entry: FieldError) -> html.Button:
    where = [html.Span(f"Line {entry.line}", className="sd-problem-line")] if entry.line else []
    field = [html.Code(entry.field)] if entry.field else []
    return html.Button(
        [*where, *field, html.Span(entry.message)],
        type="button", className="sd-problem", **hyphened(data_line=entry.line or 0, data_field=entry.field),
    )  # fmt: skip
