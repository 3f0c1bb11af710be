"""Names of the channels that a run of a case can have, before it is run."""

from __future__ import annotations

from ..case import DOF, Case
from ..results import time  # noqa: F401 (registers the channels of the time domain)
from ..results.channels import CHANNELS

OF_ANALYSIS = {"frequency_domain": "frequency", "time_domain": "time", "modes": "modes"}


def possible_channels(case: Case) -> list[str]:
    """All names, those among them that only a random sea or only a harmonic case has."""
    asked = case.analyses.requested()
    domains = {OF_ANALYSIS[name] for name in asked if name in OF_ANALYSIS}
    if set(asked) - {"time_domain"}:
        domains.add("static")
    names: list[str] = []
    for item in CHANNELS:
        if item.domain not in domains:
            continue
        if item.owner == "line":
            names += [f"{item.domain}/line/{name}/{item.quantity}" for name in case.lines]
        elif item.owner != "vessel" or case.vessel is not None:
            plain = f"{item.domain}/{item.owner}/{item.quantity}"
            names += [plain.format(dof=dof) for dof in DOF] if "{dof}" in plain else [plain]
    return names
