"""A YAML editor of our own: a text area over its coloured copy, line numbers with marks."""

from __future__ import annotations

import dash_mantine_components as dmc
from dash import dcc, html

from frontend.components.attributes import hyphened

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
