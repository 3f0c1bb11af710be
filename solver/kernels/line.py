"""The arrays of one discretised line, as every kernel takes them.

Nodes 0 … N from end a to end b, elements 0 … N-1; element j joins nodes j and j + 1. Half an element belongs to each of
its nodes. A banded matrix over the 3 (N + 1) node coordinates is stored by rows: entry (i, j) at [i, HALF + j - i].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

#: half-bandwidth: bending couples three nodes, so two nodes apart and three coordinates each
HALF = 8
WIDTH = 2 * HALF + 1

Array = np.ndarray


class LineArrays(NamedTuple):
    """Constants of one line, SI. Names as in docs/theory.md."""

    L: Array  # (N,) unstretched element length
    EA: Array  # (N,)
    limit: Array  # (N,) shortening at which the Euler load is reached, P_E/EA; infinite where compression is allowed
    knee: Array  # (N,) width ρ of the regularisation beyond it, as a strain
    kb: Array  # (N+1,) rotational stiffness at a node, zero at the ends
    EI: Array  # (N,)
    D: Array  # (N,) of the solid cylinder of the displaced volume: the height over which a lying piece goes under
    w_dry: Array  # (N,) dry weight of an element
    b_wet: Array  # (N,) buoyancy of an element, fully wet
    cdn: Array  # (N,) normal drag of half an element, ¼ρLDCn with the drag diameter
    cdt: Array  # (N,) tangential drag of half an element, ¼ρLDCt
    mw: Array  # (N,) displaced mass of half an element, ½ρvL with the displaced volume v per length
    can: Array  # (N,) normal added mass coefficient
    cat: Array  # (N,) tangential added mass coefficient
    node_mass: Array  # (N+1,) dry mass of a node: half elements and attachment
    point_weight: Array  # (N+1,) dry weight of an attachment
    point_lift: Array  # (N+1,) its buoyancy, fully wet
    point_radius: Array  # (N+1,) of the sphere of its volume: it rises out of the water over twice that
    point_drag: Array  # (N+1,) ½ρ CdA of an attachment
    point_mw: Array  # (N+1,) displaced mass of an attachment
    point_ca: Array  # (N+1,) its added mass coefficient
    a1: Array  # (N+1,) seabed stiffness of a node, zero at the ends
    a2: Array  # (N+1,) one over the transition height of a node
    bed: Array  # (N+1,) height from which a node's depth in the bed is measured
    depth: float  # height of the seabed, negative
    contact: (
        Array  # (3,) damping of a node in full contact, friction coefficient, speed at which it has 0.7 of its size
    )
    current_z: Array  # (C,) heights, rising
    current_v: Array  # (C, 3) current velocity at those heights
