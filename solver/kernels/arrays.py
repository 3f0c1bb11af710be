"""The arrays of a march: what is fixed, what moves, what is scratch, what is watched (docs/theory.md, T1-T16)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray
OK, FAILED, SHARP = 0, 1, 2
# what is recorded of the ends of a line: size and vertical part of the force on the supports at end b and end a, length on
# the bed, arc length from end a to the touchdown point
ENDS = TENSION_B, TENSION_A, VERTICAL_B, VERTICAL_A, GROUNDED, TOUCHDOWN = range(6)
MEAN, SERIES, EXACT = 0, 1, 2  # how the water's motion at the lines is found


class Lines(NamedTuple):
    """Constants of Q lanes; lane q belongs to seed q // lines. P nodes of which the first may be padding."""

    C: Array  # (N, ELEMENT_ROWS, Q) elements
    D: Array  # (P, NODE_ROWS, Q) nodes
    free: Array  # (P, Q) 1 where a node moves by itself, 0 where it is fixed, prescribed or on the vessel
    current: Array  # (P, 3, Q)
    friction: Array  # (2,) friction coefficient of the bed, speed at which friction has 0.7 of its size
    depth: float  # height of the seabed, negative
    kind: Array  # (Q,) end b: 0 fixed or prescribed, 1 on the vessel
    arm: Array  # (3, Q) fairlead from the CG at the static position
    number: Array  # (Q,) real lines the lane stands for
    phasor: Array  # (2, 6, Q) cosine and sine part of prescribed motion of end b and end a
    omega: Array  # (1,) its frequency
    bottom: Array  # (Q,) node of end a; nodes below it are padding
    lines: int
    first_wave: int


class Body(NamedTuple):
    """The vessel about its static position, frame axes."""

    M: Array  # (6, 6) mass with constant added mass
    B: Array  # (6, 6) linear damping
    quadratic: Array  # (6,)
    K: Array  # (6, 6) hydrostatic stiffness
    Kg: Array  # (6, 6) geometric stiffness, for Newton's matrix only
    steady: Array  # (6,) load that balances the lines at the static position
    point: Array  # (3, Q) fairleads at the static position
    finite: bool
    exists: bool


class Sea(NamedTuple):
    """Loads on even time grids that repeat after their last entry, and waves at the instantaneous position (T14, T15)."""

    force: Array  # (T, S, 6) on the vessel
    force_step: float
    water: Array  # (T', P - first_wave, rows, Q): 6 rows at the mean position, or the terms of the series
    water_first: int  # time of its first entry in steps of water_step; a table of less than the period is a window
    water_step: float
    kind: int  # MEAN, SERIES or EXACT
    parts: int  # of the series: 1 where what falls with height does not matter (deep water), else 2
    heading: Array  # (W, 2) direction of each wave system
    wave: Array  # (W, 4) wave number, 1/(1 - e^{-2kd}), real and imaginary part of ω × amplitude; EXACT only
    depth: float
    omega: float  # of the regular waves
    origin: Array  # (P - first_wave, 3, Q) static positions, at most at z = 0


class Memory(NamedTuple):
    """Retardation functions on the coarse grid of the memory (docs/theory.md, T6); no columns without memory."""

    rows: Array  # (12, 6J) weights of the samples, newest first: force at the newest, then one interval later
    newest: Array  # (6, 6) mean of K over one interval between samples, for the part of it that has gone by
    every: int  # steps between samples


class Setup(NamedTuple):
    """All that is fixed during a march."""

    lines: Lines
    body: Body
    sea: Sea
    memory: Memory
    base: Array  # (2, 3, Q) end b and end a at rest
    table: Array  # (7,) coefficients of the scheme
    limits: Array  # (5,) tolerance [m] and [N], most iterations, steps between renewals, first step watched
    build_up: float


class State(NamedTuple):
    """Everything that moves, at one time; a copy of it is a checkpoint."""

    x: Array  # (P, 3, Q)
    v: Array
    a: Array
    da: Array  # change of a over the last step, for the predictor
    s: Array  # (S, 6) vessel from its static position
    sv: Array
    sa: Array
    sda: Array
    past: Array  # (S, 6J) velocities at the samples of the memory, newest first
    lag: Array  # (2, S, 6) memory force at the last sample, and its slope


class Watch(NamedTuple):
    """What is seen at every watched step, besides the outputs (T16, T17); that of kept steps is part of a checkpoint."""

    range: Array  # (2, N, Q) least and largest tension
    slack: Array  # (N, Q) kept steps in which an element is slack: axial force at most 0
    last: Array  # (2, N, Q) tension one and two steps ago
    kink: Array  # (N, Q) largest second difference of tension from step to step
    bed: Array  # (4, P, Q) least, largest and last force of the bed on a node, and its largest change in a step
    ends: Array  # (2, 4, Q) least and largest of the first four rows of ENDS
    reach: Array  # (Q,) farthest that a node in waves was from its static position


class Work(NamedTuple):
    """Scratch of one block."""

    A: Array  # (3P, 9, Q)
    b: Array  # (3P, Q)
    res: Array  # (P, 3, Q)
    dx: Array  # (P, 3, Q)
    xt: Array
    vt: Array
    at: Array
    t: Array  # (N, 3, Q)
    length: Array  # (N, Q)
    wet: Array  # (P, 2, Q)
    terms: Array  # (P - first_wave, rows, Q) the sea's water at one time
    water: Array  # (P - first_wave, 6, Q)
    V: Array  # (S, 6, 6)
    ds: Array  # (S, 6)
    rs: Array  # (S, 6)
    st: Array  # (S, 6)
    svt: Array
    sat: Array
