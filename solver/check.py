"""Checks a case against its data before anything is computed; loads no compiled kernels."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from .case import Case
from .case.catalogued import catalogue_warnings
from .case.partial import noted
from .case.section import floating_lines, floating_types, known_lengths
from .case.vessel import Hydrodynamics, WamitFiles
from .outcome import CaseError, DataError, FieldError, Unread
from .vessel.balance import balance_warnings, constant_pull, current_warnings
from .vessel.data import DataSource, HydrodynamicData, open_for
from .vessel.fit import fit, lowest_wave
from .vessel.rigid import buoyancy_minus_weight, hydrostatic_stiffness, mass_matrix, water_warnings
from .waves.spectra import hs_in_band, significant_height
from .waves.steepness import steepness_warnings

DATA = ("vessel", "hydrodynamics", "data")
IN_BAND = 0.97  # of Hs: below it the wave band is said to miss part of the sea


def check(case: Case, data: DataSource | None) -> list[str]:
    """Everything that can be said against a case without solving it. Returns warnings.

    Raises CaseError naming each field at fault: data that are missing or unreadable, headings or frequencies outside
    them, drift or hydrostatics they do not hold.
    """
    errors, warnings = examine(case, data)
    if errors:
        raise CaseError(errors)
    return warnings


def examine(case: Case, data: DataSource | None) -> tuple[list[FieldError], list[str]]:
    """As `check`, for a case that may be read in part (case/partial.py): all faults, and the warnings."""
    errors: list[FieldError] = []
    warnings: list[str] = []
    for look in (_vessel, _line_types, _steepness, _bands):
        try:
            warnings += look(case, data, errors)
        except Unread:
            continue
    return errors, warnings


def _vessel(case: Case, data: DataSource | None, errors: list[FieldError]) -> list[str]:
    """Warnings about the vessel and its data; faults go to `errors`."""
    vessel = case.vessel
    if vessel is None:
        return []
    warnings: list[str] = []
    with _noted(errors):
        mass_matrix(vessel)
    hydro = None
    if vessel.hydrodynamics is not None:
        hydro = _opened(case, data, errors)
        if hydro is None:
            return warnings
        with _noted(errors):
            warnings += [*fit(case, hydro), *water_warnings(hydro, case.environment, lowest_wave(case))]
    with _noted(errors):
        hydrostatic_stiffness(vessel, hydro)
    with _noted(errors):
        if vessel.trim == "as_given":
            buoyancy_minus_weight(vessel, hydro, case.environment)
    warnings += balance_warnings(vessel, hydro, case.environment, constant_pull(case))
    warnings += current_warnings(case)
    return warnings


def _line_types(case: Case, _: DataSource | None, __: list[FieldError]) -> list[str]:
    """Warnings about line types that float, and about what the catalogue gave."""
    return [*floating_types(case), *floating_lines(case, known_lengths(case)), *catalogue_warnings(case)]


def _steepness(case: Case, _: DataSource | None, __: list[FieldError]) -> list[str]:
    """Warnings about waves steeper than they can be."""
    return list(steepness_warnings(case.environment))


@contextmanager
def _noted(errors: list[FieldError]) -> Iterator[None]:
    """As `noted`; what is wrong with the data stands at the field that names them."""
    with noted(errors):
        try:
            yield
        except DataError as error:
            raise CaseError([FieldError(DATA, str(error))]) from None


def _opened(case: Case, data: DataSource | None, errors: list[FieldError]) -> HydrodynamicData | None:
    """The vessel's data; None, with a fault, where they cannot be opened."""
    assert case.vessel is not None
    assert case.vessel.hydrodynamics is not None
    asked = case.vessel.hydrodynamics
    if data is None:
        errors.append(FieldError(DATA, "hydrodynamic data are referred to, but none can be opened here", asked.data))
        return None
    try:
        return open_for(data, asked, case.environment)
    except Unread:
        _opened_at_least(data, asked, errors)
    except DataError as error:
        errors.append(FieldError(DATA, str(error), asked.data))
    return None


def _opened_at_least(data: DataSource, asked: Hydrodynamics, errors: list[FieldError]) -> None:
    """Whether there are data to open, where the conventions or the water of WAMIT files could not be read."""
    for conventions in (None, WamitFiles(values="dimensional")):
        try:
            data.open(asked.data, conventions)
        except DataError as error:
            fault = FieldError(DATA, str(error), asked.data)
        else:
            return
    errors.append(fault)


def _bands(case: Case, _: DataSource | None, __: list[FieldError]) -> list[str]:
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
