"""How long a browser may keep what the pages are made of: for good where the address names the version."""

from __future__ import annotations

import re
from pathlib import Path

import flask

FOREVER = "public, max-age=31536000, immutable"
NOT_KEPT = "(not kept)"
_VERSIONED = re.compile(r"\.v[0-9A-Za-z_]+m\d+\.")  # the stamp that Dash writes into the names of its own files


class Compressed:
    """Files of the pages, compressed once and kept, as flask-compress asks for it; answers of callbacks never are."""

    MOST = 200

    def __init__(self) -> None:
        self._held: dict[str, bytes] = {}

    def get(self, key: str) -> bytes | None:
        return None if key.endswith(NOT_KEPT) else self._held.get(key)

    def set(self, key: str, value: bytes) -> None:
        if not key.endswith(NOT_KEPT) and len(self._held) < self.MOST:
            self._held[key] = value


def compressed_key(request: flask.Request) -> str:
    """The address of a file that names its version; anything else is not to be kept."""
    kept = request.method == "GET" and versioned(request)
    return f"{request.path}?{request.query_string.decode('ascii', 'replace')}" if kept else NOT_KEPT


def versioned(request: flask.Request) -> bool:
    """Whether the address changes when the file does."""
    path, asked = request.path, request.args
    ours, plotly = path.startswith("/assets/") and "m" in asked, path.endswith("/plotly.min.js") and "v" in asked
    return bool(ours or plotly or _VERSIONED.search(path))


def asset_stamp(name: str) -> int:
    """Changes when the file does."""
    return int((Path(__file__).parent / "assets" / name).stat().st_mtime)


def add_headers(server: flask.Flask) -> None:
    @server.after_request
    def keep(response: flask.Response) -> flask.Response:
        if response.status_code == 200 and versioned(flask.request):
            response.headers["Cache-Control"] = FOREVER
        return response
