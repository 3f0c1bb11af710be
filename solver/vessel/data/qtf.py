"""The full difference-frequency quadratic transfer function."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...outcome import DataError
from .interpolate import NEAR, PRINTED, check_range, heading_weights

Array = np.ndarray
HERMITIAN = 1e-3  # of the largest force, or moment
ROUND_OFF = 1e-9


@dataclass(frozen=True)
class QTF:
    """T2(omega_m, omega_n), Hermitian: F2 = Re ΣΣ A_m A_n* T2(m, n) e^{i (omega_m - omega_n) t}.

    omega : (N,) rising [rad/s]; headings : (H,) in [0, 2π) [rad]; values : complex (H, N, N, 6) [N/m2, N m/m2], NaN
    for pairs that were not computed. cross : for indices a < b of headings, T2 of the wave m from heading a and n from
    heading b, complex (N, N, 6); pairs of headings that are not there are unknown.
    """

    omega: Array
    headings: Array
    values: Array
    name: str = "QTF"
    cross: dict[tuple[int, int], Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n, h = self.omega.size, self.headings.size
        if self.values.shape != (h, n, n, 6) or n < 2:
            raise DataError(f"{self.name}: the QTF has shape {self.values.shape}; expected {(h, n, n, 6)}, N >= 2")
        for table in (*self.values, *self.cross.values()):
            if table.shape != (n, n, 6):
                raise DataError(f"{self.name}: a pair of headings has shape {table.shape}; expected {(n, n, 6)}")
            unknown = np.isnan(table)
            if np.isinf(table).any() or np.any(unknown.any(axis=2) != unknown.all(axis=2)):
                raise DataError(
                    f"{self.name}: the QTF holds values that are not finite; a pair that was not computed is NaN in all modes"
                )
        for table in self.values:
            if np.any(np.isnan(table[..., 0]) != np.isnan(table[..., 0].T)):
                raise DataError(f"{self.name}: some pairs (m, n) of the QTF are there and (n, m) are not; give both")
        size, gap = self.asymmetry()
        size = np.repeat(size.reshape(2, 3).max(axis=1), 3)  # what vanishes by symmetry is round-off of the others
        if np.any(gap > HERMITIAN * size):
            dof = int((gap / np.maximum(size, 1e-300)).argmax())
            raise DataError(
                f"{self.name}: the QTF is not Hermitian, T2(m, n) = T2(n, m)*: mode {dof + 1} differs by "
                f"{100 * gap[dof] / size[dof]:.2g} % of the largest (threshold {100 * HERMITIAN:g} %); give one "
                f"triangle of the difference-frequency QTF, or both in the time factor e^(+i omega t)"
            )

    def asymmetry(self) -> tuple[Array, Array]:
        """Largest |T2| and largest |T2(m, n) - T2(n, m)*| of each degree of freedom, (6,) both."""
        size, gap = np.zeros(6), np.zeros(6)
        for table in self.values:
            known = np.nan_to_num(np.abs(table))
            mirrored = np.nan_to_num(np.abs(table - np.conj(table.transpose(1, 0, 2))))
            size, gap = np.maximum(size, known.max(axis=(0, 1))), np.maximum(gap, mirrored.max(axis=(0, 1)))
        return size, gap

    @property
    def reach(self) -> float:
        """Largest difference of frequencies [rad/s] for which all pairs are known."""
        unknown = np.isnan(self.values[..., 0]).any(axis=0)
        gap = np.abs(self.omega[:, None] - self.omega[None, :])
        inside = gap < gap[unknown].min() * (1 - 1e-6) if unknown.any() else np.ones_like(unknown)
        return float(gap[inside].max())

    def covered(self, low: float, high: float) -> float:
        """Largest difference of two frequencies within low to high [rad/s] for which (V23) needs no unknown pair.

        It is below `reach` where pairs are missing: between the frequencies of the data T2 takes their four neighbours.
        """
        nodes = np.concatenate([[0.0], self.omega])
        known = ~np.any([np.isnan(self._to_zero(table)[1][..., 0]) for table in self._tables()], axis=0)
        used = np.flatnonzero((nodes[:-1] < high * (1 - ROUND_OFF)) & (nodes[1:] > low * (1 + ROUND_OFF)))
        cell = known[:-1, :-1] & known[1:, :-1] & known[:-1, 1:] & known[1:, 1:]
        first = np.maximum(nodes[:-1], low)[:, None] - np.minimum(nodes[1:], high)[None, :]
        unknown = ~cell[np.ix_(used, used)] & (used[:, None] >= used[None, :])
        nearest = first[np.ix_(used, used)][unknown].min(initial=high - low)
        return float(np.clip(nearest, 0.0, high - low))

    def check_difference(self, difference: float, low: float, high: float) -> None:
        """Raises DataError when pairs within low to high [rad/s] of a difference up to this one are unknown."""
        covered = self.covered(low, high)
        if difference > covered * (1 + PRINTED) + ROUND_OFF:
            raise DataError(
                f"{self.name}: the QTF is asked for differences up to {difference:.4g} rad/s, but its pairs give T2 up "
                f"to {covered:.4g} rad/s; compute more pairs or lower analyses.frequency_domain.low.to and difference.to"
            )

    def _tables(self) -> list[Array]:
        return [*self.values, *self.cross.values()]

    def diagonal(self) -> Array:
        """Mean drift per amplitude squared, real (N, H, 6)."""
        return np.asarray(np.diagonal(self.values, axis1=1, axis2=2).real.transpose(2, 0, 1))

    def knows(self, heading_m: float, heading_n: float) -> bool:
        """Whether waves of these two headings [rad] are both covered: one heading, or computed pairs all around."""
        try:
            return all(self._pair(a, b) is not None for a, b, _ in self._corners(heading_m, heading_n))
        except DataError:
            return False

    def at(
        self, omega_m: Array, omega_n: Array, heading: float, heading_n: float | None = None, far: bool = False
    ) -> Array:
        """T2 at pairs of frequencies, arrays of one shape (...) [rad/s] -> complex (..., 6); bilinear (V23).

        Below the lowest frequency it goes linearly to zero at omega = 0, as a long wave scatters nothing (V7).
        heading_n : that of the wave n when it is another. far : headings outside the data are the nearest of the data
        (interpolate.heading_weights); for one heading only. Raises DataError outside the frequencies or headings of the
        data, and where pairs were not computed.
        """
        shape = np.broadcast_shapes(np.shape(omega_m), np.shape(omega_n))
        m, n = (np.broadcast_to(np.asarray(part, float), shape).ravel() for part in (omega_m, omega_n))
        for part in (m, n):
            self._check(part)
        m, n = np.minimum(m, self.omega[-1]), np.minimum(n, self.omega[-1])
        return np.asarray(self._bilinear(self._table(heading, heading_n, far), m, n).reshape(*shape, 6))

    def nodal(self, heading: float, heading_n: float | None = None) -> Array:
        """T2 at the nodes of `hats`, complex (N+1, N+1, 6); zero for pairs that were not computed (V23)."""
        return np.nan_to_num(self._to_zero(self._table(heading, heading_n))[1])

    def hats(self, omega: Array) -> Array:
        """Weights (W, N+1) of omega = 0 and the frequencies of the data at omega (W,): T2(m, n) = h(m) T h(n)ᵀ (V23)."""
        self._check(omega)
        nodes = np.concatenate([[0.0], self.omega])
        lower, share = _bracket(nodes, np.minimum(omega, nodes[-1]))
        weights, rows = np.zeros((omega.size, nodes.size)), np.arange(omega.size)
        weights[rows, lower], weights[rows, lower + 1] = 1.0 - share, share
        return weights

    def _check(self, omega: Array) -> None:
        check_range(omega, 0.0, float(self.omega[-1]), self.name, "the QTF")

    def _table(self, heading: float, heading_n: float | None, far: bool = False) -> Array:
        """T2 over the frequencies of the data for the headings of the waves m and n, (N, N, 6)."""
        if heading_n is None or abs(heading_n - heading) < 1e-9:
            i, j, w = heading_weights(self.headings, heading, self.name, math.inf if far else NEAR)
            return np.asarray(self.values[i] if w == 0.0 else (1.0 - w) * self.values[i] + w * self.values[j])
        table = np.zeros_like(self.values[0])
        for a, b, weight in self._corners(heading, heading_n):
            found = self._pair(a, b)
            if found is None:
                raise DataError(f"{self.name}: the QTF holds no pairs of these two headings")
            table = table + weight * found
        return table

    def _corners(self, heading_m: float, heading_n: float) -> list[tuple[int, int, float]]:
        """The pairs of heading indices around two headings, and their weights."""
        i, j, w = heading_weights(self.headings, heading_m, self.name)
        k, l, v = heading_weights(self.headings, heading_n, self.name)
        corners = [(i, k, (1 - w) * (1 - v)), (i, l, (1 - w) * v), (j, k, w * (1 - v)), (j, l, w * v)]
        return [corner for corner in corners if corner[2] > 0.0]

    def _pair(self, a: int, b: int) -> Array | None:
        if a == b:
            return np.asarray(self.values[a])
        if a < b:
            return self.cross.get((a, b))
        found = self.cross.get((b, a))
        return None if found is None else np.conj(found.transpose(1, 0, 2))

    def _bilinear(self, table: Array, m: Array, n: Array) -> Array:
        nodes, table = self._to_zero(table)
        (a, s), (b, t) = _bracket(nodes, m), _bracket(nodes, n)
        unknown = np.isnan(table[..., 0])
        filled = np.where(unknown[..., None], 0.0, table) if unknown.any() else table
        result = np.zeros((m.size, 6), dtype=complex)
        for di, wi in ((0, 1 - s), (1, s)):
            for dj, wj in ((0, 1 - t), (1, t)):
                weight = wi * wj
                lacking = np.flatnonzero(unknown[a + di, b + dj] & (weight > 1e-9))
                if lacking.size:
                    raise DataError(
                        f"{self.name}: the QTF is asked for at {m[lacking[0]]:.4g} and {n[lacking[0]]:.4g} rad/s, but "
                        f"was computed for differences up to {self.reach:.4g} rad/s; compute more pairs or lower "
                        f"analyses.frequency_domain.low.to and difference.to"
                    )
                result += weight[:, None] * filled[a + di, b + dj]
        return result

    def _to_zero(self, table: Array) -> tuple[Array, Array]:
        """Frequencies and table with omega = 0 in front, where T2 vanishes (unknown for differences not computed)."""
        nodes, count = np.concatenate([[0.0], self.omega]), self.omega.size
        wide = np.zeros((count + 1, count + 1, 6), dtype=complex)
        wide[1:, 1:] = table
        if np.isnan(table).any():
            far = np.flatnonzero(nodes > self.reach)
            wide[0, far] = wide[far, 0] = np.nan
        return nodes, wide

    def describe(self) -> dict[str, Any]:
        """What it holds, as plain JSON values: rad/s, headings in degrees."""
        degrees = np.degrees(self.headings)
        return {
            "frequencies": {"count": int(self.omega.size), "from": float(self.omega[0]), "to": float(self.omega[-1])},
            "headings_deg": [round(float(value), 6) for value in degrees],
            "heading_pairs_deg": [[round(float(degrees[a]), 6), round(float(degrees[b]), 6)] for a, b in self.cross],
            "differences_to": self.reach,
        }

    def moved(self, t: Array) -> QTF:
        """About another point, forces F_new = Tᵀ F_old (V1); force in the plane alone gives no roll or pitch (V2)."""
        flat = not np.any(np.nan_to_num(self.values[..., 2:5]))
        return replace(
            self,
            values=_moved(self.values, t, flat),
            cross={pair: _moved(values, t, flat) for pair, values in self.cross.items()},
        )


def _moved(values: Array, t: Array, flat: bool) -> Array:
    result = values @ t
    if flat:
        result[..., 2:5] = np.where(np.isnan(values[..., 2:5]), np.nan, 0.0)
    return np.asarray(result)


def _bracket(nodes: Array, x: Array) -> tuple[Array, Array]:
    lower = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
    return lower, (x - nodes[lower]) / (nodes[lower + 1] - nodes[lower])
