"""Whether a time domain was long enough for its slow motions (docs/theory.md, R6, R9)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..case.quantities import DOF
from ..time_domain.statistics import band_variances, over_seeds, record_error

if TYPE_CHECKING:
    from .time import TimeResult

Array = np.ndarray
PERIODS = 10.0  # of the longest natural period that a record should hold
ERROR = 0.1  # of a slow σ: its standard error above which it is said
COUNTS = 0.1  # of the largest σ of any motion in any band: a slow σ below that is not judged
ARM = 100.0  # m: rotations are compared with translations at this distance


def slow_errors(result: TimeResult) -> dict[str, float]:
    """Standard error of the slow σ of each motion that counts, as a share of it: the larger of (R6) and (R9)."""
    history = np.moveaxis(result.arrays["vessel"].astype(float), 1, -1)  # (n, 6, seeds)
    if not result.random or not np.any(history):
        return {}
    stats = over_seeds(*band_variances(history, result.step, result.border, result.periodic))
    size = np.repeat([1.0, ARM], 3)
    counts = stats["lf"] * size > COUNTS * max((stats[band] * size).max() for band in ("wf", "lf"))
    scatter = np.divide(stats["lf_error"], stats["lf"], out=np.zeros(6), where=stats["lf"] > 0)
    errors = np.maximum(scatter, record_error(history, result.step, result.border, result.periodic))
    return {dof: float(error) for dof, error, judged in zip(DOF, errors, counts, strict=True) if judged}


def sampling_summary(result: TimeResult) -> dict[str, Any]:
    """The summary's `sampling`; nothing without a vessel in random waves."""
    out: dict[str, Any] = {}
    longest, errors = result.head.get("longest_period"), slow_errors(result)
    if longest is not None:
        out |= {"longest_natural_period": longest["period"], "longest_natural_motion": longest["motion"]}
    if errors:
        out["lf_std_error"] = errors
    return {"sampling": out} if out else {}


def sampling_warnings(result: TimeResult) -> list[str]:
    """What to say of a short record, with the values and the limits."""
    said, kept = [], result.head["kept"] * result.head["h"]
    longest = result.head.get("longest_period")
    if longest is not None and kept < PERIODS * longest["period"]:
        said.append(
            f"time domain: the duration of {kept:.4g} s is {kept / longest['period']:.3g} times the longest natural period, "
            f"{longest['period']:.4g} s ({longest['motion']}); slow motions and their extremes need at least {PERIODS:g} "
            f"times: use a duration of {PERIODS * longest['period']:.4g} s or more"
        )
    large = {dof: error for dof, error in slow_errors(result).items() if error > ERROR}
    if large:
        each = ", ".join(f"{dof} {100 * error:.3g} %" for dof, error in large.items())
        more = (max(large.values()) / ERROR) ** 2
        said.append(
            f"time domain: the standard error of the low-frequency σ is above {100 * ERROR:g} %: {each}; use more seeds or a "
            f"longer duration, about {more:.2g} times as much in all"
        )
    return said
