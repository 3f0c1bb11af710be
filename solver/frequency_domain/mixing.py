"""Anderson mixing for the drag linearisation: plain substitution oscillates, because more motion means more damping."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


class Mixing:
    """Next guess of a fixed point z = g(z) from the last few guesses and images (Anderson, depth `depth`) (F15)."""

    def __init__(self, relax: float = 0.65, depth: int = 3):
        self.relax, self.depth = relax, depth
        self._guesses: list[Array] = []
        self._errors: list[Array] = []

    def next(self, guess: Array, image: Array, weight: Array) -> Array:
        """The next guess, from a guess and its image under g; `weight` makes entries of unlike size comparable."""
        error = image - guess
        self._guesses = [*self._guesses, guess][-self.depth - 1 :]
        self._errors = [*self._errors, error][-self.depth - 1 :]
        if len(self._errors) < 2:
            return guess + self.relax * error
        dE = np.stack([error - old for old in self._errors[:-1]], axis=1)
        dG = np.stack([guess - old for old in self._guesses[:-1]], axis=1)
        share, *_ = np.linalg.lstsq(dE * weight[:, None], error * weight, rcond=1e-6)
        return np.asarray(guess + self.relax * error - (dG + self.relax * dE) @ share)
