"""A set of WAMIT's numeric files as one HydrodynamicData (docs/hydrodynamics.md)."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ....case.vessel import WamitFiles
from ....outcome import DataError
from ..hydrodynamics import HydrodynamicData
from ..qtf import QTF
from .axis import CLEAR, span, tell, wave_number_slope
from .first import FORCE, RADIATION, STIFFNESS, Radiation, Scale, read_force, read_radiation, read_stiffness
from .second import DRIFT, PAIRS, pairs_are_periods, read_mean_drift, read_qtf
from .text import Array, Table, read_table

QTF_KINDS = (".12d", ".11d", ".10d")
KINDS = (".1", ".2", ".3", ".4", ".8", ".9", *QTF_KINDS, ".hst")
WAVE_NUMBERS = "(IPEROUT 3 and 4) are not read: write the files with IPEROUT 1 or 2"
POWER = 0.35  # nearer to 1 than this, and farther from that of frequencies: wave numbers
DIFFERENT = 0.02  # of the peak: above it .2 and .3 are said to differ


@dataclass(frozen=True)
class _Set:
    """Files by kind (name and bytes), what they cannot say, and the scale that follows."""

    files: Mapping[str, tuple[str, bytes]]
    options: WamitFiles
    scale: Scale
    warnings: list[str]
    assumed: list[str]

    def table(self, kind: str, columns: tuple[str, ...], optional: int = 0) -> Table | None:
        found = self.files.get(kind)
        return None if found is None else read_table(found[1], found[0], columns, optional)

    def first(self, *kinds: str) -> str | None:
        return next((kind for kind in kinds if kind in self.files), None)


def kind_of(filename: str) -> str | None:
    """The kind of a file of a set, such as ".3"; None for what is not one."""
    dot = filename.rfind(".")
    extension = filename[dot:].lower() if dot >= 0 else ""
    return extension if extension in KINDS else None


def read_wamit(files: Mapping[str, bytes], options: WamitFiles) -> HydrodynamicData:
    """Hydrodynamic data from files by name, all of one set: .1, .3 or .2 at least.

    options : what files cannot say; density and gravity must be given. Raises DataError, naming file and line.
    """
    kinds, empty = _by_kind(files, options)
    missing = lacking(kinds, options)
    if missing:
        raise DataError(
            f"{_names(files)}: {missing[0][1]} (vessel.hydrodynamics.wamit.{missing[0][0]}, or with the upload)"
        )
    said = [f"{name}: the file is empty and is left out" for name in empty]
    found = _Set(kinds, options, _scale(options), said, [])
    radiation_table, force_kind = found.table(".1", RADIATION, 1), found.first(".3", ".2")
    if radiation_table is None or force_kind is None:
        raise DataError(
            f"{_names(files)}: a set needs added mass and damping (.1) and wave forces (.3 or .2); "
            f"give the files of one run together"
        )
    force_table = found.table(force_kind, FORCE)
    assert force_table is not None
    periods = _periods(found, force_table)
    radiation = read_radiation(radiation_table, periods, found.scale)
    headings, excitation = read_force(force_table, periods, found.scale.force(), radiation.omega)
    _compare_haskind(found, force_kind, periods, radiation, headings, excitation)
    drift_kind, drift = _drift(found, periods, radiation.omega)
    qtf = _qtf(found, radiation.omega)
    return HydrodynamicData(
        name=_stem(found),
        content_hash=manifest_hash(files, options),
        omega=radiation.omega,
        headings=headings,
        added_mass=radiation.added_mass,
        damping=radiation.damping,
        excitation=excitation,
        added_mass_zero=radiation.zero,
        added_mass_infinite=radiation.infinite,
        excitation_zero=None,
        mean_drift=None if drift is None else drift[1],
        mean_drift_headings=None if drift is None or np.array_equal(drift[0], headings) else drift[0],
        hydrostatic_stiffness=_stiffness(found),
        displaced_volume=None,
        centre_of_buoyancy=None,
        centre_of_mass=_centre(found),
        reference_point=np.zeros(3),
        reference_known=False,
        density=found.scale.density,
        gravity=found.scale.gravity,
        depth=math.inf if options.depth is None else float(options.depth),
        qtf=qtf,
        motions=_motions(found, periods, radiation, headings),
        warnings=tuple(found.warnings),
        provenance=_provenance(files, found, periods, drift_kind),
    )


def _by_kind(files: Mapping[str, bytes], options: WamitFiles) -> tuple[dict[str, tuple[str, bytes]], list[str]]:
    """Files by kind, and the names of empty ones that the set can do without. Raises DataError for others."""
    result: dict[str, tuple[str, bytes]] = {}
    empty = []
    for name, payload in files.items():
        kind = kind_of(name)
        if kind is None:
            continue
        if kind in result:
            raise DataError(f"{name}: there is another {kind} file, {result[kind][0]}; give the files of one run")
        if payload.strip():
            result[kind] = (name, payload)
        elif kind in (".1", options.drift):
            raise DataError(f"{name}: the file is empty")
        else:
            empty.append(name)
    forces = [name for name in empty if kind_of(name) in (".2", ".3")]
    if forces and not {".2", ".3"} & set(result):
        raise DataError(f"{forces[0]}: the file is empty")
    return result, empty


def lacking(kinds: Collection[str], options: WamitFiles) -> list[tuple[str, str]]:
    """What must still be said of files of these kinds: names of fields of WamitFiles, each with a sentence."""
    missing = []
    if options.length is None and options.values != "dimensional":
        missing.append((
            "length", "WAMIT's values are made dimensionless by a length ULEN that the files do not say; give length, or "
            "values: dimensional",
        ))  # fmt: skip
    for field, value in (("density", options.density), ("gravity", options.gravity)):
        if value is None:
            missing.append((field, f"the files do not say the {field} of the computation; give {field}"))
    if ".hst" in kinds and options.centre_of_mass is None:
        missing.append((
            "centre_of_mass", "the stiffness (.hst) contains the weight at the centre of gravity of the computation, which "
            "the file does not say; give centre_of_mass (the reference point when gravity was left out)",
        ))  # fmt: skip
    return missing


def _scale(options: WamitFiles) -> Scale:
    assert options.density is not None
    assert options.gravity is not None
    return Scale(
        float(options.length or 1.0), float(options.density), float(options.gravity), options.values == "dimensional"
    )


def _periods(found: _Set, force: Table) -> bool:
    """Whether first columns hold periods: as given, else told by the heave force. Raises DataError when unclear."""
    told, ratio = tell(force, 3, 2)
    asked = found.options.first_column
    if asked == "auto":
        if told is None:
            raise DataError(
                f"{force.name}: the first column may hold periods or frequencies; the heave force at its greatest "
                f"value is {ratio:.3g} of that at its least (above {CLEAR:g}: periods, below 1/{CLEAR:g}: "
                f"frequencies); give first_column: periods or frequencies; wave numbers {WAVE_NUMBERS}"
            )
        doubt = None if told else _wave_numbers(found, force)
        if doubt is not None:
            raise DataError(f"{doubt}; or give first_column: frequencies if they are")
        found.assumed.append(
            f"first column: {'periods' if told else 'frequencies'}, as the heave force at its greatest value is "
            f"{ratio:.3g} times that at its least"
        )
        return told
    if told is not None and told != (asked == "periods"):
        found.warnings.append(
            f"{force.name}: read with first_column: {asked}, but the heave force at the greatest value of the column is "
            f"{ratio:.3g} times that at the least, and long waves have the larger; check first_column"
        )
    elif asked == "frequencies" and (doubt := _wave_numbers(found, force)) is not None:
        found.warnings.append(doubt)
    return asked == "periods"


def _wave_numbers(found: _Set, force: Table) -> str | None:
    """A sentence where the horizontal force of long waves grows with the first column, not with its square (Q13)."""
    depth = math.inf if found.options.depth is None else float(found.options.depth)
    powers = wave_number_slope(force, (2, 3), depth, found.scale.gravity)
    if powers is None or abs(powers[0] - 1.0) > POWER or powers[0] > powers[1] - POWER:
        return None
    return (
        f"{force.name}: the first column looks like wave numbers: the horizontal force of long waves grows with its "
        f"power {powers[0]:.2f}, where frequencies would give {powers[1]:.2f}; wave numbers {WAVE_NUMBERS}"
    )


def _compare_haskind(
    found: _Set, used: str, periods: bool, radiation: Radiation, headings: Array, excitation: Array
) -> None:
    """The forces by Haskind's relation (.2) against those by diffraction (.3), when both are there."""
    if used != ".3" or ".2" not in found.files:
        return
    table = found.table(".2", FORCE)
    assert table is not None
    angles, other = read_force(table, periods, found.scale.force(), radiation.omega)
    if angles.shape != headings.shape or not np.allclose(angles, headings):
        found.warnings.append(f"{table.name}: its headings are not those of the .3 file; it is not compared")
        return
    peak = np.abs(excitation).max(axis=(0, 1))
    scale = np.maximum(peak, 0.01 * np.repeat(peak.reshape(2, 3).max(axis=1), 3))
    share = np.abs(other - excitation).max(axis=(0, 1)) / np.maximum(scale, 1e-6 * peak.max())
    if share.max() > DIFFERENT:
        found.warnings.append(
            f"{table.name}: forces by Haskind's relation differ from those by diffraction by up to "
            f"{100 * share.max():.2g} % of the peak, mode {int(share.argmax()) + 1} (threshold {100 * DIFFERENT:g} %); "
            f"refine the panels; the .3 file is used"
        )


def _drift(found: _Set, periods: bool, omega: Array) -> tuple[str | None, tuple[Array, Array] | None]:
    kind = found.first(".8", ".9") if found.options.drift == "auto" else found.first(found.options.drift)
    if kind is None:
        if found.options.drift != "auto":
            raise DataError(f"drift is {found.options.drift}, but there is no such file; add it, or give drift: auto")
        return None, None
    table = found.table(kind, DRIFT)
    assert table is not None
    headings, values, warnings = read_mean_drift(table, periods, found.scale.drift(), omega)
    found.warnings.extend(warnings)
    return kind, (headings, values)


def _qtf(found: _Set, omega: Array) -> QTF | None:
    kind = found.first(*QTF_KINDS)
    table = None if kind is None else found.table(kind, PAIRS)
    if table is None:
        return None
    asked = found.options.pair_columns
    periods = pairs_are_periods(table, omega) if asked == "auto" else asked == "periods"
    qtf = read_qtf(table, periods, found.options.pair_order == "second-minus-first", found.scale.drift())
    if asked == "auto":
        found.assumed.append(f"pairs of the QTF: {'periods' if periods else 'frequencies'}, {span(qtf.omega)}")
    return qtf


def _stiffness(found: _Set) -> Array | None:
    table = found.table(".hst", STIFFNESS)
    if table is None:
        return None
    stiffness, warnings = read_stiffness(table, found.scale)
    found.warnings.extend(warnings)
    return stiffness


def _centre(found: _Set) -> Array | None:
    if ".hst" not in found.files:
        return None
    centre = found.options.centre_of_mass
    return None if centre is None else np.array(centre, dtype=float)


def _motions(found: _Set, periods: bool, radiation: Radiation, headings: Array) -> Array | None:
    table = found.table(".4", FORCE)
    if table is None:
        return None
    angles, motions = read_force(table, periods, found.scale.motion(), radiation.omega)
    if angles.shape != headings.shape or not np.allclose(angles, headings):
        found.warnings.append(f"{table.name}: its headings are not those of the forces; the motions are not kept")
        return None
    return motions


def _stem(found: _Set) -> str:
    name = found.files[".1"][0]
    return name[: name.rfind(".")]


def _names(files: Mapping[str, bytes]) -> str:
    names = sorted(files)
    return ", ".join(names[:6]) + (", …" if len(names) > 6 else "")


def manifest(files: Mapping[str, bytes], options: WamitFiles) -> dict[str, Any]:
    """What identifies a set: its files by name with their SHA-256, and the conventions."""
    return {
        "files": {name: hashlib.sha256(files[name]).hexdigest() for name in sorted(files) if kind_of(name)},
        "wamit": options.model_dump(mode="json"),
    }


def manifest_hash(files: Mapping[str, bytes], options: WamitFiles) -> str:
    text = json.dumps(manifest(files, options), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def _provenance(files: Mapping[str, bytes], found: _Set, periods: bool, drift: str | None) -> dict[str, Any]:
    told = manifest(files, found.options)
    used = {".1", found.first(".3", ".2"), ".4", drift, found.first(*QTF_KINDS), ".hst"} & set(found.files)
    return {
        "format": "WAMIT",
        "files": [
            {"name": name, "bytes": len(files[name]), "sha256": digest, "used": kind_of(name) in used}
            for name, digest in told["files"].items()
        ],
        "not_read": sorted(name for name in files if kind_of(name) is None),
        "conventions": told["wamit"] | {"first_column": "periods" if periods else "frequencies"},
        "assumed": found.assumed,
    }
