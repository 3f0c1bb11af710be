"""Whether hydrodynamic data hold what a case asks of them: its waves, headings, drift and pairs of frequencies."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..case import Case, harmonic_frequencies
from ..case.analysis import FrequencyDomain
from ..case.environment import RegularWave
from ..case.partial import known
from ..case.vessel import Hydrodynamics
from ..outcome import CaseError, DataError, FieldError
from ..waves.spectra import hs_in_band, significant_height
from .data import HydrodynamicData
from .data.interpolate import PRINTED
from .drift import Drift
from .headings import off_the_headings
from .quality import quality_warnings
from .rigid import about_cg

UNSEEN = 0.01  # of the energy of a sea, below the lowest frequency of the data


def fit(case: Case, data: HydrodynamicData) -> tuple[str, ...]:
    """Warnings of the data for this case, quality checks over its wave band among them.

    Raises CaseError naming each field that asks for what the data do not hold.
    """
    assert case.vessel is not None
    choice = case.vessel.hydrodynamics
    assert choice is not None
    errors = [
        *known(_frequencies, case, choice, data),
        *known(_drift, choice, data),
        *known(lambda: _pairs(case, choice, data, _band(case)[1])),
        *known(lambda: _directions(case, choice, data, _band(case)[0])),
    ]
    if errors:
        raise CaseError(errors)
    low, high = _band(case)
    headings = [float(sea.direction) - float(case.vessel.heading) for sea in case.environment.seastates]
    doubts = (
        *_below_the_data(case, data, low), *_below_the_pairs(case, choice, data, low),
        *Drift(data, choice.drift).warnings(headings), *off_the_headings(data, choice.drift, headings),
        *_differences(case, choice),
    )  # fmt: skip
    return (*data.warnings, *quality_warnings(data, low, high), *doubts)


def lowest_wave(case: Case) -> float:
    """The lowest frequency of the case's waves [rad/s]: the band's, where there are random ones, and of regular waves."""
    regular = [2 * math.pi / sea.period for sea in case.environment.seastates if isinstance(sea, RegularWave)]
    return min([*regular, *([_band(case)[0]] if case.environment.random or not regular else [])])


def difference_to(case: Case, data: HydrodynamicData | None) -> float:
    """Highest difference frequency of the slow drift [rad/s]: `low.to`, or with a full QTF `difference.to`, which is by
    default the largest difference that the waves and the pairs of the QTF have."""
    fd = case.analyses.frequency_domain or FrequencyDomain()
    drift = case.vessel.hydrodynamics.drift if case.vessel is not None and case.vessel.hydrodynamics else "none"
    if drift != "qtf" or data is None or data.qtf is None:
        return float(fd.low.to)
    if fd.difference.to is not None:
        return float(fd.difference.to)
    return max(float(fd.low.to), data.qtf.covered(*_waves(case)))


def _waves(case: Case) -> tuple[float, float]:
    """Lowest and highest frequency of all waves of a case, regular ones too [rad/s]."""
    regular = [2 * math.pi / sea.period for sea in case.environment.seastates if isinstance(sea, RegularWave)]
    return lowest_wave(case), max([_band(case)[1], *regular])


def _band(case: Case) -> tuple[float, float]:
    wave = (case.analyses.frequency_domain or FrequencyDomain()).wave
    return float(wave.from_), float(wave.to)


def _frequencies(case: Case, choice: Hydrodynamics, data: HydrodynamicData) -> Iterator[FieldError]:
    top, fd = float(data.omega[-1]), case.analyses.frequency_domain
    lowest = 0.0 if data.added_mass_zero is not None else float(data.omega[0])
    if fd is not None and case.environment.random and fd.wave.to > top * (1 + PRINTED):
        yield FieldError(
            ("analyses", "frequency_domain", "wave", "to"),
            f"{fd.wave.to:g} rad/s is above the hydrodynamic data; allowed: ≤ {top:g}", f"{fd.wave.to:g}",
        )  # fmt: skip
    if choice.frequency is not None and not lowest * (1 - PRINTED) <= choice.frequency <= top * (1 + PRINTED):
        yield FieldError(
            ("vessel", "hydrodynamics", "frequency"),
            f"{choice.frequency:g} rad/s is outside the hydrodynamic data; allowed: {lowest:g} to {top:g}",
            f"{choice.frequency:g}",
        )  # fmt: skip
    for loc, omega in harmonic_frequencies(case):
        if not lowest * (1 - PRINTED) <= omega <= top * (1 + PRINTED):
            longest = f"{2 * math.pi / lowest:.4g}" if lowest > 0 else "any"
            yield FieldError(
                loc, f"{2 * math.pi / omega:g} s is outside the hydrodynamic data; "
                f"allowed: {2 * math.pi / top:.4g} to {longest} s", f"{2 * math.pi / omega:g}",
            )  # fmt: skip


def _drift(choice: Hydrodynamics, data: HydrodynamicData) -> Iterator[FieldError]:
    loc = ("vessel", "hydrodynamics", "drift")
    if choice.drift == "qtf" and data.qtf is None:
        other = "newman" if data.mean_drift is not None else "none"
        yield FieldError(loc, f"the data hold no full QTF; use {other}", "qtf")
    if choice.drift.startswith("newman") and data.mean_drift is None:
        other = "qtf" if data.qtf is not None else "none"
        yield FieldError(
            loc,
            f"the data hold no mean drift force, which Newman's approximation needs; use drift: {other}",
            choice.drift,
        )


def _pairs(case: Case, choice: Hydrodynamics, data: HydrodynamicData, high: float) -> Iterator[FieldError]:
    """The band of waves and of their differences against the pairs of a QTF."""
    qtf = data.qtf
    if choice.drift != "qtf" or qtf is None or not case.environment.random:
        return
    fd = case.analyses.frequency_domain or FrequencyDomain()
    if high > qtf.omega[-1] * (1 + PRINTED):
        yield FieldError(
            ("analyses", "frequency_domain", "wave", "to"),
            f"{high:g} rad/s is above the QTF; allowed: ≤ {qtf.omega[-1]:.5g}, or another drift", f"{high:g}",
        )  # fmt: skip
    low, top = _waves(case)
    covered = qtf.covered(low, top)
    for name, to in (("low", fd.low.to), ("difference", fd.difference.to)):
        if to is not None and to > covered * (1 + PRINTED) and covered < (top - low) * (1 - PRINTED):
            yield FieldError(
                ("analyses", "frequency_domain", name, "to"),
                f"{to:g} rad/s is above the differences for which the QTF was computed; allowed: ≤ {covered:.5g}",
                f"{to:g}",
            )


def _directions(case: Case, choice: Hydrodynamics, data: HydrodynamicData, low: float) -> Iterator[FieldError]:
    """Each wave system against the headings, at the lowest wave and in the middle of the data."""
    assert case.vessel is not None
    if case.analyses.frequency_domain is None and case.analyses.time_domain is None:
        return  # statics takes the mean drift of the nearest heading (V29)
    about = about_cg(data, case.vessel)
    middle = 0.5 * float(data.omega[0] + data.omega[-1])
    for index, sea in enumerate(case.environment.seastates):
        heading = float(sea.direction) - float(case.vessel.heading)
        first = 2 * math.pi / float(sea.period) if isinstance(sea, RegularWave) else low
        try:
            about.excitation_at(np.array([min(first, middle), middle]), heading)
            if choice.drift == "qtf" and about.qtf is not None:
                at = np.array([about.qtf.omega.mean()])
                about.qtf.at(at, at, heading)
            elif choice.drift.startswith("newman") and about.mean_drift is not None:
                about.mean_drift_at(about.drift_omega[:1], heading)
        except DataError as error:
            yield FieldError(("environment", "seastates", index, "direction"), str(error))


def _below_the_data(case: Case, data: HydrodynamicData, low: float) -> Iterator[str]:
    """Waves below the lowest frequency of the data, where forces go to their long-wave limit (V5)."""
    first = float(data.omega[0])
    for index, sea in enumerate(case.environment.seastates):
        if isinstance(sea, RegularWave) or low >= first * (1 - PRINTED):
            continue
        share = (hs_in_band(sea, low, first) / significant_height(sea)) ** 2
        if share > UNSEEN:
            yield (
                f"{data.name}: {100 * share:.2g} % of the energy of sea {index + 1} lies below the lowest frequency of the "
                f"data, {first:.4g} rad/s (threshold {100 * UNSEEN:g} %); forces there go to their long-wave limit; "
                f"compute lower frequencies"
            )


def _below_the_pairs(case: Case, choice: Hydrodynamics, data: HydrodynamicData, low: float) -> Iterator[str]:
    qtf = data.qtf
    if choice.drift == "qtf" and qtf is not None and case.environment.random and low < qtf.omega[0] * (1 - PRINTED):
        yield (
            f"{qtf.name}: the QTF begins at {qtf.omega[0]:.4g} rad/s, the waves at {low:.4g} rad/s; in between it goes "
            f"linearly to zero at omega = 0; compute lower frequencies or raise analyses.frequency_domain.wave.from"
        )


def _differences(case: Case, choice: Hydrodynamics) -> Iterator[str]:
    fd = case.analyses.frequency_domain
    if fd is not None and fd.difference.to is not None and choice.drift != "qtf":
        yield (
            f"analyses.frequency_domain.difference has no effect with drift: {choice.drift}, whose slow drift ends at "
            f"low.to, {fd.low.to:g} rad/s; use drift: qtf or leave difference out"
        )
