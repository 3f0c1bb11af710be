"""One module per page: `layout(...)` without any call to the service, and `register(app)` for its callbacks."""

from __future__ import annotations

import dash
from dash import Dash

from frontend.pages import compare, new, run, runs


def register(app: Dash) -> None:
    """Pages are named here, not found by walking a folder, so that imports stay plain."""
    dash.register_page("runs", path="/", title="Runs – Slowdrift", name="Runs", layout=runs.layout, order=0)
    dash.register_page("new", path="/new", title="New run – Slowdrift", name="New run", layout=new.layout, order=1)
    dash.register_page("run", path_template="/runs/<run_id>", title="Run – Slowdrift", name="Run", layout=run.layout)
    dash.register_page("compare", path="/compare", title="Compare – Slowdrift", name="Compare", layout=compare.layout)
    for page in (runs, new, run, compare):
        page.register(app)
