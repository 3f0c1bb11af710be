"""The full difference-frequency quadratic transfer function."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...outcome import DataError
from .interpolate import check_range, heading_weights

Array = np.ndarray


@dataclass(frozen=True)
class QTF:
    """T2(omega_m, omega_n), Hermitian, unidirectional: F2 = Re ΣΣ A_m A_n* T2(m, n) e^{i (omega_m - omega_n) t}.

    omega : (N,) rising [rad/s]; headings : (H,) in [0, 2π) [rad]; values : complex (H, N, N, 6) [N/m2, N m/m2].
    """

    omega: Array
    headings: Array
    values: Array
    name: str = "QTF"

    def __post_init__(self) -> None:
        n, h = self.omega.size, self.headings.size
        if self.values.shape != (h, n, n, 6):
            raise DataError(f"{self.name}: the QTF has shape {self.values.shape}; expected {(h, n, n, 6)}")
        mirrored = np.conj(self.values.transpose(0, 2, 1, 3))
        size = np.abs(self.values).max(axis=(0, 1, 2), initial=0.0)
        if np.any(np.abs(self.values - mirrored).max(axis=(0, 1, 2), initial=0.0) > 1e-3 * size):
            raise DataError(
                f"{self.name}: the QTF is not Hermitian, T2(m, n) = T2(n, m)*; "
                f"give both triangles of the difference-frequency QTF in the time factor e^(+i omega t)"
            )

    def at(self, omega_m: Array, omega_n: Array, heading: float) -> Array:
        """T2 at pairs of frequencies, arrays of one shape (...) [rad/s] -> complex (..., 6); bilinear.

        Raises DataError outside the frequencies or headings of the data.
        """
        shape = np.broadcast_shapes(np.shape(omega_m), np.shape(omega_n))
        m, n = (np.broadcast_to(np.asarray(part, float), shape).ravel() for part in (omega_m, omega_n))
        for part in (m, n):
            check_range(part, float(self.omega[0]), float(self.omega[-1]), self.name, "the QTF")
        i, j, w = heading_weights(self.headings, heading, self.name)
        table = self.values[i] if w == 0.0 else (1.0 - w) * self.values[i] + w * self.values[j]
        (a, s), (b, t) = _bracket(self.omega, m), _bracket(self.omega, n)
        s, t = s[:, None], t[:, None]
        result = (1 - s) * ((1 - t) * table[a, b] + t * table[a, b + 1])
        result += s * ((1 - t) * table[a + 1, b] + t * table[a + 1, b + 1])
        return np.asarray(result.reshape(*shape, 6))


def _bracket(nodes: Array, x: Array) -> tuple[Array, Array]:
    lower = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
    return lower, (x - nodes[lower]) / (nodes[lower + 1] - nodes[lower])
