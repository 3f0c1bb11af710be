"""Water at the lines: tables over time at the static positions, or what finds it wherever a node is (T13-T15)."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..kernels.arrays import EXACT, MEAN, SERIES
from ..model.build import Model
from ..waves.dispersion import wave_number
from ..waves.kinematics import direction_vector, velocity
from .sea import Components

Array = np.ndarray
POINTS = 12  # of a table per shortest wave
REGULAR_POINTS = 24  # per regular wave in a random sea
ALONE_POINTS = 48  # per regular wave alone
FAINT = 1e-4  # of the largest water velocity: nodes below that feel no waves
FAINTER = 1e-5  # the same where nodes take their waves along
WIDE = 15.0  # m: a series is made for motions of this and the height of the sea
EXACT_ENOUGH = 1e-5  # of σ of the water's velocity
MOST_ORDERS = 20


class Water:
    """The water's motion at the upper nodes of the lines, for the march.

    first : first node that feels waves; count, step : of the table over one period; rows : of the table, 6 at the static
    positions, none in regular waves at the instantaneous position.
    """

    def __init__(self, model: Model, waves: Components, shapes: list[Array], kinematics: str):
        self.waves = waves
        environment = model.case.environment
        self.depth, self.gravity = environment.depth, environment.water.gravity
        self.kind = MEAN if kinematics == "mean" else (EXACT if waves.regular else SERIES)
        self.count = max(self._points(), 8)
        self.step = waves.period / self.count
        self.transfer = [
            [velocity(waves.omega, heading, x, self.depth, self.gravity) for heading in waves.directions]
            for x in shapes
        ]
        size = np.stack([self._size(parts) for parts in self.transfer]).max(axis=0)
        felt = np.flatnonzero(size > (FAINT if self.kind == MEAN else FAINTER) * size.max(initial=0.0))
        self.first = int(felt[0]) if felt.size else shapes[0].shape[0]
        origin = np.stack([x[self.first :] for x in shapes], axis=-1)
        origin[:, 2] = np.minimum(origin[:, 2], 0.0)
        self.origin = np.ascontiguousarray(origin)
        self.k = wave_number(waves.omega, self.depth, self.gravity)
        self.full = 1.0 / -np.expm1(-2.0 * self.k * self.depth)
        self.parts, self.orders = (self._parts(), self._orders()) if self.kind == SERIES else (1, 0)

    @property
    def rows(self) -> int:
        """Rows of the table: 6, or 4 per order, part and wave system."""
        return 6 if self.kind != SERIES else 4 * self.orders * self.parts * len(self.waves.directions)

    def _points(self) -> int:
        """Of the table over one period."""
        waves = self.waves
        most = POINTS * (waves.band.stop - 1 + waves.first)
        for fixed in waves.fixed:
            if fixed is not None:
                own = waves.first + int(np.argmax(np.abs(fixed)))
                most = max(most, (ALONE_POINTS if waves.regular else REGULAR_POINTS) * own)
        return most

    def _size(self, parts: list[Array]) -> Array:
        """Largest standard deviation of water velocity per node."""
        pairs = zip(parts, self.waves.variances, strict=True)
        total = sum(np.einsum("w,wpk->p", weight, np.abs(transfer) ** 2) for transfer, weight in pairs)
        return np.sqrt(np.asarray(total))

    def _parts(self) -> int:
        """1 where the part that falls with height is less than 1e-5 of the other at every node in waves, else 2."""
        low = float(self.origin[:, 2].min(initial=0.0))
        weight = np.sum(self.waves.variances, axis=0) * self.waves.omega**2 * np.exp(2.0 * self.k * low)
        falling = np.exp(-4.0 * self.k * (low + self.depth))
        return 1 if np.sqrt((weight * falling).sum()) < 1e-5 * np.sqrt(weight.sum()) else 2

    def _orders(self) -> int:
        """Terms that make the series exact within EXACT_ENOUGH in motions of WIDE and the height of the sea."""
        high = 4.0 * math.sqrt(float(np.sum(self.waves.variances)))
        return next((n for n in range(3, MOST_ORDERS) if self._missed(WIDE + high, n) < EXACT_ENOUGH), MOST_ORDERS)

    def _missed(self, reach: float, orders: int) -> float:
        """What the terms left out are at a distance from the static position, at most, as a share of σ at the surface (T15)."""
        kr = self.k * reach
        tail = np.exp(orders * np.log(kr) - math.lgamma(orders + 1))
        weight = np.sum(self.waves.variances, axis=0) * self.waves.omega**2
        return float(np.sqrt((weight * tail**2).sum() / weight.sum()))

    def missed(self, reach: float) -> float:
        """Largest error at a distance from the static position [m], as a share of σ of velocity at the surface."""
        return self._missed(reach, self.orders) if self.kind == SERIES and reach > 0.0 else 0.0

    def table(self, line: int, amplitudes: Array, index: Array) -> Array:
        """Rows of the table at some of its times, (index.size, P - first, rows)."""
        place = self.waves.first + np.arange(self.waves.omega.size)
        nodes = self.transfer[line][0].shape[1] - self.first
        out = np.empty((index.size, nodes, self.rows))
        terms = self._velocities if self.kind == MEAN else self._terms
        for row, coefficients in enumerate(terms(line, amplitudes)):
            half = np.zeros((self.count // 2 + 1, nodes), dtype=complex)
            half[place] = coefficients
            out[:, :, row] = np.fft.irfft(half * (0.5 * self.count), self.count, axis=0)[index]
        return out

    def _velocities(self, line: int, amplitudes: Array) -> Iterator[Array]:
        """Velocity, then acceleration at the static positions: six times (W, nodes) (T13)."""
        pairs = zip(self.transfer[line], amplitudes, strict=True)
        u = np.sum([part[:, self.first :] * amplitude[:, None, None] for part, amplitude in pairs], axis=0)
        for factor in (np.ones(self.waves.omega.size), 1j * self.waves.omega):
            for p in range(3):
                yield factor[:, None] * u[:, :, p]

    def _terms(self, line: int, amplitudes: Array) -> Iterator[Array]:
        """Coefficients of the series, in the order of the rows (T15)."""
        x, y, z = self.origin[:, :, line].T
        rising = np.exp(self.k[:, None] * z)
        falling = np.exp(-self.k[:, None] * (z + 2.0 * self.depth))
        for heading, amplitude in zip(self.waves.directions, amplitudes, strict=True):
            c, s = direction_vector(heading)
            wave = (amplitude * self.waves.omega * self.full)[:, None] * np.exp(-1j * self.k[:, None] * (c * x + s * y))
            for part in (rising, falling)[: self.parts]:
                term = wave * part
                for order in range(self.orders):
                    for moved in (term, 1j * self.waves.omega[:, None] * term):
                        yield moved
                        yield -1j * moved
                    term = term * (self.k[:, None] / (order + 1))

    def regular(self) -> Array:
        """Wave number, 1/(1 - e^{-2kd}) and ω × amplitude of each regular wave, (systems, 4) (T14)."""
        if self.kind != EXACT:
            return np.zeros((0, 4))
        k, full, omega = float(self.k[0]), float(self.full[0]), float(self.waves.omega[0])
        amplitudes = [complex(fixed[0]) for fixed in self.waves.fixed if fixed is not None]
        return np.array([[k, full, omega * a.real, omega * a.imag] for a in amplitudes])

    def headings(self) -> Array:
        """Unit vectors of the wave systems, (systems, 2)."""
        return np.array([direction_vector(heading) for heading in self.waves.directions])
