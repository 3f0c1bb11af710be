"""Small tables with a caption, numbers to the right, scrolling inside themselves on a narrow screen."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import dash_mantine_components as dmc
from dash import html

from frontend.components.attributes import hyphened


def table(
    caption: str,
    head: Sequence[Any],
    rows: Sequence[Sequence[Any]],
    min_width: int = 320,
    note: str | None = None,
    words: bool = False,
) -> dmc.Box:
    """The first column is text, the others are numbers as text; with `words` all are text."""
    other: dict[str, Any] = {} if words else {"ta": "right", "className": "sd-number"}
    align: list[dict[str, Any]] = [{}] + [other] * (len(head) - 1)
    body = [dmc.TableTr([dmc.TableTd(cell, **a) for cell, a in zip(row, align, strict=True)]) for row in rows]
    return dmc.Box(
        [
            *([dmc.Title(caption, order=4, mb=6)] if caption else []),
            html.Div(
                dmc.Table(
                    [
                        dmc.TableThead(
                            dmc.TableTr([dmc.TableTh(cell, **a) for cell, a in zip(head, align, strict=True)])
                        ),
                        dmc.TableTbody(body),
                    ],
                    withTableBorder=True,
                    verticalSpacing=5,
                    className="sd-table",
                    miw=min_width,
                ),
                className="sd-scroll",
                tabIndex=0,
                role="region",
                **hyphened(aria_label=caption or str(head[0])),
            ),
            html.Button(
                "Copy", type="button", className="sd-copy-table", **hyphened(aria_label=f"Copy table {caption}".strip())
            ),
            *([dmc.Text(note, size="xs", c="dimmed", mt=4)] if note else []),
        ],
        className="sd-table-box",
    )


def facts(rows: Sequence[tuple[str, Any]]) -> dmc.Table:
    """Names and values, one a line."""
    body = [
        dmc.TableTr([dmc.TableTh(name, c="dimmed", fw=500, w="40%"), dmc.TableTd(value, className="sd-break")])
        for name, value in rows
    ]
    return dmc.Table(dmc.TableTbody(body), verticalSpacing=4, className="sd-facts")
