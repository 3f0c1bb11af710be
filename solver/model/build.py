"""Case and data → Model: everything the analyses share, in the solver's frame.

The frame's x axis points where the bow points in the design position (the earth's x axis without a vessel), so that
surge is along the vessel; positions, directions and currents are turned into it here and back in `solver.results`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..case import Case
from ..case.analysis import Statics
from ..case.catalogued import catalogue_warnings
from ..case.environment import RegularWave
from ..case.section import floating_types
from ..outcome import DataError
from ..vessel.balance import current_warnings
from ..vessel.data import DataSource, HydrodynamicData, open_for
from .line import LineModel, build_line
from .vessel import VesselModel, build_vessel

Array = np.ndarray


@dataclass(frozen=True)
class Model:
    """A case ready to be solved. frame [rad] is the angle of the solver's x axis from the earth's."""

    case: Case
    frame: float
    lines: tuple[LineModel, ...]
    vessel: VesselModel | None
    data: HydrodynamicData | None
    warnings: tuple[str, ...] = ()

    @property
    def statics(self) -> Statics:
        return self.case.analyses.statics or Statics()

    @property
    def wave_systems(self) -> list[tuple[object, float]]:
        """Each seastate with its direction in the solver's frame [rad]."""
        return [(sea, float(sea.direction) - self.frame) for sea in self.case.environment.seastates]

    def mean_drift(self, yaw: float) -> Array:
        """Mean wave drift force at a static yaw, frame axes (6,) [N, N m]; zero where excluded or unknown."""
        if self.vessel is None or self.case.vessel is None or self.case.vessel.mean_drift == "exclude":
            return np.zeros(6)
        return self.vessel.mean_drift(self.wave_systems, yaw)


def build(case: Case, data: DataSource | None) -> Model:
    """Build the model of a case; opens the hydrodynamic data it refers to.

    Raises DataError when data are missing or do not fit, CaseError when a line cannot be built.
    """
    frame = float(case.vessel.heading) if case.vessel is not None else 0.0
    lines = tuple(build_line(case, name, frame) for name in case.lines)
    hydro = None
    if case.vessel is not None and case.vessel.hydrodynamics is not None:
        if data is None:
            raise DataError("the case refers to hydrodynamic data, but no source of data was given")
        hydro = open_for(data, case.vessel.hydrodynamics, case.environment)
    vessel, warnings = build_vessel(case, hydro) if case.vessel is not None else (None, ())
    warnings = (*warnings, *current_warnings(case), *floating_types(case), *catalogue_warnings(case))
    return Model(case, frame, lines, vessel, hydro, (*warnings, *_left_out(case)))


def _left_out(case: Case) -> list[str]:
    """What an analysis asked for does not take into account."""
    others = [name.replace("_", " ") for name in case.analyses.requested() if name != "time_domain"]
    if not case.environment.seabed.friction or not others:
        return []
    return [f"environment.seabed.friction acts in the time domain only: {', '.join(others)} leave it out"]


def is_regular(sea: object) -> bool:
    return isinstance(sea, RegularWave)
