"""One module per page: `layout(...)` without any call to the service, and `register(app)` for its callbacks."""

from __future__ import annotations

import dash
from dash import Dash

from frontend.pages import (
    account,
    compare,
    data,
    data_set,
    hull,
    hull_job,
    new,
    run,
    runs,
    shared,
    sign_in,
    studies,
    study,
    teams,
)


def register(app: Dash) -> None:
    """Pages are named here, not found by walking a folder, so that imports stay plain."""
    dash.register_page("runs", path="/", title="Runs – Slowdrift", name="Runs", layout=runs.layout, order=0)
    dash.register_page("new", path="/new", title="New run – Slowdrift", name="New run", layout=new.layout, order=1)
    dash.register_page("run", path_template="/runs/<run_id>", title="Run – Slowdrift", name="Run", layout=run.layout)
    dash.register_page("compare", path="/compare", title="Compare – Slowdrift", name="Compare", layout=compare.layout)
    dash.register_page("studies", path="/studies", title="Studies – Slowdrift", name="Studies", layout=studies.layout)
    dash.register_page(
        "study-new", path="/new-study", title="New study – Slowdrift", name="New study", layout=studies.new_layout
    )
    dash.register_page(
        "study", path_template="/studies/<study_id>", title="Study – Slowdrift", name="Study", layout=study.layout
    )
    dash.register_page("data", path="/data", title="Hydrodynamic data – Slowdrift", name="Data", layout=data.layout)
    dash.register_page(
        "data-set", path_template="/data/<data_set_id>", title="Hydrodynamic data – Slowdrift", name="Data set",
        layout=data_set.layout,
    )  # fmt: skip
    dash.register_page("hull", path="/hull", title="Data from a hull – Slowdrift", name="Hull", layout=hull.layout)
    dash.register_page(
        "hull-job", path_template="/hull/<job_id>", title="Data from a hull – Slowdrift", name="Hull job",
        layout=hull_job.layout,
    )  # fmt: skip
    dash.register_page("sign-in", path="/sign-in", title="Sign in – Slowdrift", name="Sign in", layout=sign_in.layout)
    dash.register_page(
        "invitation", path_template="/invitations/<token>", title="Invitation – Slowdrift", name="Invitation",
        layout=sign_in.invitation,
    )  # fmt: skip
    dash.register_page("account", path="/account", title="Account – Slowdrift", name="Account", layout=account.layout)
    dash.register_page("teams", path="/teams", title="Teams – Slowdrift", name="Teams", layout=teams.layout)
    dash.register_page(
        "shared", path_template="/shared/<token>", title="Shared – Slowdrift", name="Shared", layout=shared.layout
    )
    for page in (
        shared,
        sign_in,
        account,
        teams,
        runs,
        new,
        run,
        compare,
        studies,
        study,
        data,
        data_set,
        hull,
        hull_job,
    ):
        page.register(app)
