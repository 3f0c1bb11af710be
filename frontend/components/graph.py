"""Every picture goes through here, so that none has a button that would send it to another server."""

from __future__ import annotations

from typing import Any

from dash import dcc

from frontend.figures.base import Figure
from frontend.figures.safe import safe

CONFIG: dict[str, Any] = {
    "displaylogo": False,
    "showSendToCloud": False,
    "showEditInChartStudio": False,
    "sendData": False,
    "plotlyServerURL": "",
    "showLink": False,
    "responsive": True,
    "scrollZoom": False,
    "modeBarButtonsToRemove": ["select2d", "lasso2d", "sendDataToCloud", "autoScale2d"],
}


def figure_graph(figure: Figure, graph_id: str | dict[str, str], label: str, **style: Any) -> dcc.Graph:
    """`label` says in words what the picture shows, for the file name and for those who cannot see it."""
    name = "".join(c if c.isalnum() else "-" for c in label.lower()).strip("-")
    config: Any = {**CONFIG, "toImageButtonOptions": {"format": "png", "scale": 2, "filename": f"slowdrift-{name}"}}
    height = f"{figure['layout']['height']}px"
    return dcc.Graph(
        id=graph_id,
        figure=safe(figure),
        config=config,
        className="sd-graph",
        style={"height": height, "width": "100%"} | style,
    )
