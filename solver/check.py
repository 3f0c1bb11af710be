"""Checks a case against its data before anything is computed; loads no compiled kernels."""

from __future__ import annotations

from .case import Case
from .case.catalogued import catalogue_warnings
from .case.section import floating_lines, floating_types, known_lengths
from .outcome import CaseError, DataError, FieldError
from .vessel.balance import balance_warnings, constant_pull, current_warnings
from .vessel.data import DataSource, HydrodynamicData, open_for
from .vessel.fit import fit, lowest_wave
from .vessel.rigid import buoyancy_minus_weight, hydrostatic_stiffness, mass_matrix, water_warnings
from .waves.spectra import hs_in_band, significant_height

IN_BAND = 0.97  # of Hs: below it the wave band is said to miss part of the sea


def check(case: Case, data: DataSource | None) -> list[str]:
    """Everything that can be said against a case without solving it. Returns warnings.

    Raises CaseError naming each field at fault: data that are missing or unreadable, headings or frequencies outside
    them, drift or hydrostatics they do not hold.
    """
    warnings: list[str] = []
    if case.vessel is not None:
        mass_matrix(case.vessel)
        if case.vessel.hydrodynamics is not None:
            hydro = _opened(case, data)
            warnings += [*fit(case, hydro), *water_warnings(hydro, case.environment, lowest_wave(case))]
        else:
            hydro = None
        hydrostatic_stiffness(case.vessel, hydro)
        if case.vessel.trim == "as_given":
            buoyancy_minus_weight(case.vessel, hydro, case.environment)
        warnings += balance_warnings(case.vessel, hydro, case.environment, constant_pull(case))
        warnings += current_warnings(case)
    lines = [*floating_types(case), *floating_lines(case, known_lengths(case)), *catalogue_warnings(case)]
    return warnings + lines + _bands(case)


def _opened(case: Case, data: DataSource | None) -> HydrodynamicData:
    loc = ("vessel", "hydrodynamics", "data")
    assert case.vessel is not None
    assert case.vessel.hydrodynamics is not None
    reference = case.vessel.hydrodynamics.data
    if data is None:
        raise CaseError([FieldError(loc, "hydrodynamic data are referred to, but none can be opened here", reference)])
    try:
        return open_for(data, case.vessel.hydrodynamics, case.environment)
    except DataError as error:
        raise CaseError([FieldError(loc, str(error), reference)]) from None


def _bands(case: Case) -> list[str]:
    fd = case.analyses.frequency_domain
    warnings = []
    for sea in case.environment.random if fd is not None else ():
        assert fd is not None
        whole, inside = significant_height(sea), hs_in_band(sea, float(fd.wave.from_), float(fd.wave.to))
        if inside < IN_BAND * whole:
            warnings.append(
                f"the wave band {fd.wave.from_:g} to {fd.wave.to:g} rad/s holds Hs {inside:.3g} m of {whole:.3g} m "
                f"(threshold {100 * IN_BAND:g} %); widen analyses.frequency_domain.wave"
            )
    return warnings
