"""Statistics of recorded histories: bands by FFT, standard deviations and their errors, first harmonics, spectra (R5-R9)."""

from __future__ import annotations

import numpy as np

Array = np.ndarray
TAPER = 0.1  # share of a record that is no whole period, faded in and out before its FFT
RESOLUTION = 0.005  # rad/s: width over which a periodogram is smoothed


def band_variances(history: Array, step: float, border: float, periodic: bool) -> tuple[Array, Array, Array]:
    """Variance about its own mean below and above a frequency, and the mean, along the first axis (R5).

    history : (n, …); step [s]; border [rad/s]. A record that is no whole period of its waves is tapered first.
    """
    power, omega, mean = _periodogram(history, step, periodic)
    low = (omega > 0) & (omega < border * (1 - 1e-9))
    return power[low].sum(axis=0), power[omega >= border * (1 - 1e-9)].sum(axis=0), mean


def _periodogram(history: Array, step: float, periodic: bool) -> tuple[Array, Array, Array]:
    """Power (F, …) about the mean, its frequencies (F,) [rad/s] and the mean (…)."""
    n = history.shape[0]
    mean = history.mean(axis=0, dtype=float)
    window, gain = _window(n, periodic)
    shape = (n,) + (1,) * (history.ndim - 1)
    power = np.abs(np.fft.rfft((history - mean) * window.reshape(shape), axis=0)) ** 2 * (2.0 / (n * n * gain))
    if n % 2 == 0:
        power[-1] *= 0.5
    return power, 2 * np.pi * np.fft.rfftfreq(n, step), mean


def record_error(history: Array, step: float, border: float, periodic: bool) -> Array:
    """Standard error of σ below the border as a share of it, from the records' own power alone (R9).

    history : (n, …, seeds). Unlike the scatter of the seeds it is known for a single one. Zero where nothing moves.
    """
    power, omega, _ = _periodogram(history, step, periodic)
    low = power[(omega > 0) & (omega < border * (1 - 1e-9))]
    total, squares = low.sum(axis=(0, -1)), (low**2).sum(axis=(0, -1))
    crowd = np.divide(squares, total**2, out=np.zeros_like(total), where=total > 0)  # about 2 / (lines that count + 1)
    window, gain = _window(history.shape[0], periodic)
    shorter = float(np.mean(window**4)) / gain**2
    return 0.5 * np.sqrt(shorter * crowd / (2.0 - crowd))


def _window(n: int, periodic: bool) -> tuple[Array, float]:
    """Window and its mean square."""
    if periodic:
        return np.ones(n), 1.0
    fade = np.clip(np.minimum(np.arange(n) + 0.5, n - np.arange(n) - 0.5) / (TAPER * n), 0.0, 1.0)
    window = 0.5 * (1 - np.cos(np.pi * fade))
    return window, float(np.mean(window**2))


def over_seeds(low: Array, high: Array, mean: Array) -> dict[str, Array]:
    """σ of both bands over the seeds (last axis), and their standard errors (R6).

    The variance is about the ensemble's mean, so that what a seed's mean differs from it counts as low frequency.
    Keys lf, wf, lf_error, wf_error; the errors are zero for a single seed.
    """
    low = low + (mean - mean.mean(axis=-1, keepdims=True)) ** 2
    out = {}
    for band, variance in (("lf", low), ("wf", high)):
        sigma = np.sqrt(variance.mean(axis=-1))
        count = variance.shape[-1]
        spread = variance.std(axis=-1, ddof=1) / np.sqrt(count) if count > 1 else np.zeros_like(sigma)
        out[band] = sigma
        out[f"{band}_error"] = np.divide(spread, 2.0 * sigma, out=np.zeros_like(sigma), where=sigma > 0)
    return out


def first_harmonic(history: Array, step: float, omega: float) -> Array:
    """Amplitude at ω by least squares with a mean, along the first axis (R7). history : (n, …)."""
    t = step * np.arange(1, history.shape[0] + 1)
    basis = np.stack([np.ones_like(t), np.cos(omega * t), np.sin(omega * t)], axis=1)
    found, *_ = np.linalg.lstsq(basis, history.reshape(t.size, -1).astype(float), rcond=None)
    return np.hypot(found[1], found[2]).reshape(history.shape[1:])


def spectrum(history: Array, step: float, periodic: bool, highest: float) -> tuple[Array, Array, float]:
    """Mean of the seeds' periodograms, smoothed over RESOLUTION (R8).

    history : (n, seeds). Returns frequencies (F,) up to `highest` [rad/s], density (F,) and the resolution [rad/s].
    """
    n = history.shape[0]
    window, gain = _window(n, periodic)
    centred = history - history.mean(axis=0)
    power = (np.abs(np.fft.rfft(centred * window[:, None], axis=0)) ** 2).mean(axis=1) * (2.0 / (n * n * gain))
    width = 2 * np.pi / (n * step)
    bins = max(round(RESOLUTION / width), 1)
    count = max(min(int(highest / width), power.size - 1) // bins, 1)
    kept = power[1 : 1 + count * bins].reshape(count, -1) if power.size > count * bins else power[1:2].reshape(1, -1)
    omega = width * (1.0 + bins * np.arange(kept.shape[0]) + 0.5 * (bins - 1))
    return omega, kept.sum(axis=1) / (bins * width), bins * width
