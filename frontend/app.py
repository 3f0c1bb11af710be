"""The dashboard as one WSGI application; `cli/serve.py` mounts it beside the REST API."""

from __future__ import annotations

import importlib.util
from importlib.metadata import version

import flask
from dash import Dash

from frontend import caching, pages, security
from frontend.client import Client
from frontend.components import shell
from frontend.editor import routes

TITLE = "Slowdrift"
PLOTLY = f"_dash-component-suites/plotly/package_data/plotly.min.js?v={version('plotly')}"
FIRST = "first.js"  # in the head: the scheme is known before anything is drawn


def create_app(api_base_url: str | None = None, prefix: str = "/app/") -> flask.Flask:
    """The Flask server behind the pages.

    api_base_url : origin of the REST API for server-side calls, e.g. ``http://127.0.0.1:8000``; None = the socket on
        which the page's own request arrived (API and pages served together).
    prefix : the path under which the browser sees the pages. The WSGI mount strips it (SCRIPT_NAME), so routes inside
        start at ``/``.
    """
    prefix = "/" + prefix.strip("/") + "/" if prefix.strip("/") else "/"
    server = flask.Flask("frontend")
    server.config["SLOWDRIFT_CLIENT"] = Client(api_base_url)
    server.config["COMPRESS_ALGORITHM"] = ["zstd", "br", "gzip", "deflate"]
    server.config["COMPRESS_BR_LEVEL"] = 4
    server.config["COMPRESS_CACHE_BACKEND"] = caching.Compressed
    server.config["COMPRESS_CACHE_KEY"] = caching.compressed_key
    app = Dash(
        __name__,
        server=server,  # type: ignore[arg-type]  # Dash takes a Flask app, its hint does not say so
        title=TITLE,
        update_title="",
        use_pages=True,
        pages_folder="",
        requests_pathname_prefix=prefix,
        routes_pathname_prefix="/",
        serve_locally=True,
        compress=importlib.util.find_spec("flask_compress") is not None,
        suppress_callback_exceptions=True,
        assets_ignore=FIRST.replace(".", r"\."),
        meta_tags=[{"name": "viewport", "content": "width=device-width, initial-scale=1"}],
    )
    app.index_string = app.index_string.replace("<html>", '<html lang="en">', 1).replace(
        "{%css%}",
        f'{{%css%}}\n        <script src="{prefix}assets/{FIRST}?m={caching.asset_stamp(FIRST)}"'
        f' data-plotly="{prefix}{PLOTLY}"></script>',
        1,
    )
    pages.register(app)
    app.layout = shell.shell(prefix)
    shell.register(app)
    app.enable_dev_tools(debug=False)
    routes.register(server)
    security.add_headers(server, app.csp_hashes)
    caching.add_headers(server)
    _set_up(server)
    return server


def _set_up(server: flask.Flask) -> None:
    """Dash lists its scripts and callbacks at the first request, and a second one that comes meanwhile is answered with
    a page that lacks them. So that work is done before there are requests."""
    with server.test_request_context():
        server.preprocess_request()
