"""How a case is cut into pieces that workers can do; loads no compiled kernels."""

from __future__ import annotations

from .case import Case
from .results.part import Chunk

LANES = 8  # line × seed lanes that one chunk marches together
MOST = 200  # chunks of one run


def plan(case: Case) -> list[Chunk]:
    """The chunks of a case: everything but the time domain together, and the seeds of the time domain in groups.

    A chunk's weight is its rough share of the work; one frequency-domain run counts 1.
    """
    chunks = [Chunk("frequency")] if set(case.analyses.requested()) - {"time_domain"} else []
    spec = case.analyses.time_domain
    if spec is None:
        return chunks
    lines = max(len(case.lines), 1)
    size = max(round(LANES / lines), 1, -(-spec.seeds // MOST))
    steps = (spec.build_up + spec.duration) / spec.step
    for start in range(0, spec.seeds, size):
        count = min(size, spec.seeds - start)
        first = spec.first_seed + start
        chunks.append(Chunk("time", (first, first + count), steps * lines * count * 1e-5))
    return chunks
