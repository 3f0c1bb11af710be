"""How far a block marches between two looks at progress, cancel and checkpoint."""

from __future__ import annotations

BLOCK_SECONDS = 60.0  # of simulated time at most
STRIDE_SECONDS = 0.25  # of work at most, about
NODE_SECONDS = 0.2e-6  # of work for a node of a lane in one step, about
FEWEST_LANES = 8  # fewer take as long


def stride(h: float, nodes: int, lanes: int, refresh: int) -> int:
    """Steps of length h [s]: whole renewals of Newton's matrix, so that a resumed run begins with one.

    The result of a march does not depend on it.
    """
    by_work = STRIDE_SECONDS / (NODE_SECONDS * nodes * max(lanes, FEWEST_LANES))
    return max(int(min(BLOCK_SECONDS / h, by_work)) // refresh, 1) * refresh
