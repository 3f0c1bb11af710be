"""How long a browser may keep what the pages are made of: for good where the address names the version."""

from __future__ import annotations

import re
from pathlib import Path

import flask

FOREVER = "public, max-age=31536000, immutable"
_VERSIONED = re.compile(r"\.v[0-9A-Za-z_]+m\d+\.")  # the stamp that Dash writes into the names of its own files


def asset_stamp(name: str) -> int:
    """Changes when the file does."""
    return int((Path(__file__).parent / "assets" / name).stat().st_mtime)


def add_headers(server: flask.Flask) -> None:
    @server.after_request
    def keep(response: flask.Response) -> flask.Response:
        path = flask.request.path
        ours = path.startswith("/assets/") and "m" in flask.request.args
        plotly = path.endswith("/plotly.min.js") and "v" in flask.request.args
        if response.status_code == 200 and (ours or plotly or _VERSIONED.search(path)):
            response.headers["Cache-Control"] = FOREVER
        return response
