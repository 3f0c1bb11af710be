"""Reads every deck, data set and mesh in a folder and prints a table: `python benchmarks/public_files.py FOLDER`.

docs/public-files.md has the table of a run over public repositories. Nothing of what is read is kept.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from solver.bem.read import read_mesh
from solver.case.vessel import WamitFiles
from solver.io.moordyn import read_deck
from solver.outcome import CaseError, DataError
from solver.vessel.data import read_bytes
from solver.vessel.data.wamit import kind_of, read_wamit
from solver.vessel.quality import quality

LARGEST = 60_000_000  # bytes
MESHES = (".gdf", ".pnl", ".stl", ".msh", ".obj", ".dat", ".nem")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--density", type=float, default=1025.0, help="of WAMIT sets, which do not say it [kg/m3]")
    parser.add_argument("--length", type=float, default=1.0, help="ULEN of WAMIT sets [m]")
    options = parser.parse_args()
    wamit = WamitFiles(length=options.length, density=options.density, gravity=9.80665, centre_of_mass=(0.0, 0.0, 0.0))
    sys.stdout.write("| file | kind | read | said |\n|---|---|---|---|\n")
    for name, kind, read, said in rows(options.folder, wamit):
        sys.stdout.write(f"| {name} | {kind} | {read} | {' '.join(said.split()).replace('|', '/')} |\n")
        sys.stdout.flush()


def rows(folder: Path, wamit: WamitFiles) -> Iterator[tuple[str, str, str, str]]:
    """File, kind, what was read or `refused`, and what is said of it."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.stat().st_size <= LARGEST)
    sets: dict[tuple[Path, str], list[Path]] = {}
    for path in files:
        if kind_of(path.name):
            sets.setdefault((path.parent, path.stem.lower()), []).append(path)
    for (parent, _), members in sets.items():
        kinds = {str(kind_of(path.name)) for path in members}
        if ".1" in kinds and kinds & {".2", ".3"}:
            label = f"{(parent / members[0].stem).relative_to(folder)} ({' '.join(sorted(kinds))})"
            yield (label, "WAMIT", *_wamit(members, wamit))
    for path in files:
        if kind_of(path.name):
            continue
        payload, name = path.read_bytes(), str(path.relative_to(folder))
        if path.suffix.lower() == ".nc":
            yield (name, "NetCDF", *_netcdf(payload, path.name))
        elif b"LINE TYPES" in payload.upper() or b"LINE DICTIONARY" in payload.upper():
            yield (name, "deck", *_deck(payload))
        elif path.suffix.lower() in MESHES:
            yield (name, "mesh", *_mesh(payload, path.name))


def _wamit(members: list[Path], options: WamitFiles) -> tuple[str, str]:
    try:
        data = read_wamit({path.name: path.read_bytes() for path in members}, options)
    except DataError as error:
        return "refused", str(error)
    return _told(data)


def _netcdf(payload: bytes, name: str) -> tuple[str, str]:
    try:
        data = read_bytes(payload, name)
    except DataError as error:
        return "refused", str(error)
    return _told(data)


def _told(data) -> tuple[str, str]:  # type: ignore[no-untyped-def]
    doubts = [check.name for check in quality(data) if check.state == "warning"]
    omega = data.omega
    read = f"{omega.size} frequencies of {omega[0]:.3g} to {omega[-1]:.3g} rad/s, {data.headings.size} headings"
    return read, "; ".join([*data.warnings, *(["checks: " + ", ".join(doubts)] if doubts else [])])


def _deck(payload: bytes) -> tuple[str, str]:
    try:
        found = read_deck(payload, pinned=True)
    except CaseError as error:
        return "refused", str(error.errors[0])
    assert found.case is not None
    lines = found.case.lines.values()
    length = sum(
        float(piece.length) * line.multiplicity for line in lines for piece in line.segments if piece.length != "find"
    )
    told = [text for text in found.report.assumed if "fixed point" in text or "no anchor" in text or "by place" in text]
    return (
        f"{sum(line.multiplicity for line in lines)} lines, {length:.5g} m, depth {found.case.environment.depth:g} m",
        "; ".join(told),
    )


def _mesh(payload: bytes, name: str) -> tuple[str, str]:
    try:
        mesh, kind = read_mesh(payload, name)
    except DataError as error:
        return "refused", str(error)
    along = ", ".join(f"{value:.6g}" for value in mesh.volumes)
    return f"{kind}, {mesh.count} panels", f"volume along x, y, z: {along} m3"


if __name__ == "__main__":
    main()
