"""Checks a case against its data before anything is computed; loads no compiled kernels."""

from __future__ import annotations

import math

import numpy as np

from .case import Case, harmonic_frequencies
from .outcome import CaseError, DataError, FieldError
from .vessel.data import DataSource, HydrodynamicData, open_for
from .vessel.rigid import about_cg, buoyancy_minus_weight, hydrostatic_stiffness, mass_matrix, water_warnings
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
            _hydrodynamics(case, hydro)
            warnings += [*hydro.warnings, *water_warnings(hydro, case.environment)]
        else:
            hydro = None
        hydrostatic_stiffness(case.vessel, hydro)
        if case.vessel.trim == "as_given":
            buoyancy_minus_weight(case.vessel, hydro, case.environment)
    return warnings + _bands(case)


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


def _hydrodynamics(case: Case, hydro: HydrodynamicData) -> None:
    vessel, errors = case.vessel, []
    assert vessel is not None
    assert vessel.hydrodynamics is not None
    about, choice, top = about_cg(hydro, vessel), vessel.hydrodynamics, float(hydro.omega[-1])
    lowest = 0.0 if hydro.added_mass_zero is not None else float(hydro.omega[0])
    fd = case.analyses.frequency_domain
    if fd is not None and case.environment.random and fd.wave.to > top * (1 + 1e-9):
        errors.append(FieldError(
            ("analyses", "frequency_domain", "wave", "to"),
            f"{fd.wave.to:g} rad/s is above the hydrodynamic data; allowed: ≤ {top:g}", f"{fd.wave.to:g}",
        ))  # fmt: skip
    if choice.frequency is not None and not lowest <= choice.frequency <= top:
        errors.append(FieldError(
            ("vessel", "hydrodynamics", "frequency"),
            f"{choice.frequency:g} rad/s is outside the hydrodynamic data; allowed: {lowest:g} to {top:g}",
            f"{choice.frequency:g}",
        ))  # fmt: skip
    if choice.drift == "qtf" and hydro.qtf is None:
        errors.append(FieldError(("vessel", "hydrodynamics", "drift"), "the data hold no full QTF; use newman", "qtf"))
    if choice.drift.startswith("newman") and hydro.mean_drift is None:
        errors.append(FieldError(
            ("vessel", "hydrodynamics", "drift"),
            f"the data hold no mean drift force, which Newman's approximation needs; use drift: "
            f"{'qtf' if hydro.qtf is not None else 'none'}", choice.drift,
        ))  # fmt: skip
    for loc, omega in harmonic_frequencies(case):
        if not lowest <= omega <= top:
            longest = f"{2 * math.pi / lowest:.4g}" if lowest > 0 else "any"
            errors.append(FieldError(
                loc, f"{2 * math.pi / omega:g} s is outside the hydrodynamic data; "
                f"allowed: {2 * math.pi / top:.4g} to {longest} s", f"{2 * math.pi / omega:g}",
            ))  # fmt: skip
    middle = np.array([0.5 * (hydro.omega[0] + hydro.omega[-1])])
    for index, sea in enumerate(case.environment.seastates):
        try:
            about.excitation_at(middle, float(sea.direction) - float(vessel.heading))
        except DataError as error:
            errors.append(FieldError(("environment", "seastates", index, "direction"), str(error)))
    if errors:
        raise CaseError(errors)


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
