"""Second order: a Hermitian QTF whose diagonal is the mean drift (Q11), (Q12)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..data import HydrodynamicData
from ..data.interpolate import linear
from ..scale import arm, floors
from .judgement import Check, judge, pair, percent, skipped

HERMITIAN = 1e-4
DIAGONAL = 0.10  # of the peak of the mean drift


def drift_checks(data: HydrodynamicData) -> Iterator[Check]:
    qtf = data.qtf
    if qtf is None:
        yield skipped("qtf-hermitian", f"{data.name}: there is no full QTF")
        yield skipped("qtf-diagonal", f"{data.name}: there is no full QTF")
        return
    size, gap = qtf.asymmetry()
    scale = np.maximum(np.repeat(size.reshape(2, 3).max(axis=1), 3), floors(size, arm(data)))
    share = gap / np.maximum(scale, 1e-300)
    dof = int(share.argmax())
    text = (
        f"T2(m, n) of {pair(dof, dof)} differs from T2(n, m)* by {percent(share[dof])} of the largest "
        f"(threshold {percent(HERMITIAN)})"
    )
    yield judge(
        "qtf-hermitian", float(share[dof]), HERMITIAN, f"{qtf.name}: {text}",
        f"{qtf.name}: {text}; give more digits, or one triangle",
    )  # fmt: skip
    yield _diagonal(data)


def _diagonal(data: HydrodynamicData) -> Check:
    qtf = data.qtf
    assert qtf is not None
    if data.mean_drift is None:
        return skipped(
            "qtf-diagonal", f"{data.name}: there is no mean drift beside the QTF to compare its diagonal with"
        )
    inside = (data.drift_omega >= qtf.omega[0]) & (data.drift_omega <= qtf.omega[-1])
    shared = [
        (h, int(np.flatnonzero(near)[0]))
        for h, angle in enumerate(qtf.headings)
        if (near := np.abs((data.drift_headings - angle + np.pi) % (2 * np.pi) - np.pi) < 1e-6).any()
    ]
    if not shared or not inside.any():
        return skipped("qtf-diagonal", f"{data.name}: mean drift and QTF share no heading or no frequency")
    omega, diagonal, worst = data.drift_omega[inside], qtf.diagonal(), (0.0, 0, 0.0)
    for h, own in shared:
        ours = linear(omega, qtf.omega, diagonal[:, h])
        theirs = data.mean_drift[inside][:, own]
        peak = np.abs(theirs).max(axis=0)
        least = floors(peak, arm(data))
        scale = np.maximum(np.maximum(peak, 0.01 * np.repeat(peak.reshape(2, 3).max(axis=1), 3)), least)
        for dof in np.flatnonzero(peak > least):
            gap = np.abs(ours[:, dof] - theirs[:, dof]) / scale[dof]
            if gap.max() > worst[0]:
                worst = (float(gap.max()), int(dof), float(omega[gap.argmax()]))
    value, mode, at = worst
    text = (
        f"its diagonal and the mean drift of {pair(mode, mode)} differ by {percent(value)} of the peak at {at:.4g} rad/s "
        f"(threshold {percent(DIAGONAL)})"
    )
    return judge(
        "qtf-diagonal", value, DIAGONAL, f"{qtf.name}: {text}",
        f"{qtf.name}: {text}; momentum and pressure integration disagree: refine the mesh, or the files are of two runs",
    )  # fmt: skip
