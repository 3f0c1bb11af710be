"""Where hydrodynamic data come from: bytes of files, a folder, or whatever else opens a reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Protocol

from ...case.environment import Environment
from ...case.vessel import Hydrodynamics, WamitFiles
from ...outcome import DataError
from .bundle import MANIFEST, MAX_SET_BYTES, conventions, is_zip, plain, stems, unpack
from .capytaine import read_capytaine
from .hydrodynamics import HydrodynamicData
from .wamit import kind_of, read_wamit

MAX_BYTES = 64 * 1024 * 1024  # of a NetCDF file or an archive; text files of a set: MAX_SET_BYTES together
MAX_LISTED = 10_000


class DataSource(Protocol):
    """Opens the `data` of a case's vessel.hydrodynamics; raises DataError with a remedy."""

    def open(self, reference: str, wamit: WamitFiles | None = None) -> HydrodynamicData: ...


def open_for(source: DataSource, asked: Hydrodynamics, environment: Environment) -> HydrodynamicData:
    """The data a case refers to; water and depth of WAMIT files that it does not say are the case's own."""
    if asked.wamit is None:
        return source.open(asked.data)
    water, given = environment.water, asked.wamit
    own = {"density": water.density, "gravity": water.gravity, "depth": environment.depth}
    missing = {key: value for key, value in own.items() if getattr(given, key) is None}
    return source.open(asked.data, given.model_copy(update=missing))


def read_bytes(payload: bytes, filename: str, wamit: WamitFiles | None = None) -> HydrodynamicData:
    """Hydrodynamic data from the bytes of a file; the content says its kind, `filename` only names it in messages.

    NetCDF as Capytaine writes it, or a ZIP of it or of a WAMIT set. Raises DataError, one sentence naming the file,
    the variable or line at fault and the remedy.
    """
    return read_files({plain(filename): payload}, wamit)


def read_files(files: Mapping[str, bytes], wamit: WamitFiles | None = None) -> HydrodynamicData:
    """Hydrodynamic data from one file, or the files of a WAMIT set together, by name. Raises DataError."""
    files = unpacked(files)
    known = [name for name in files if kind_of(name)]
    packed = [name for name in files if _is_netcdf(files[name])]
    if packed:
        if len(packed) > 1 or known:
            raise DataError(f"{', '.join(sorted(packed + known)[:6])}: give one NetCDF file, or one WAMIT set")
        return read_capytaine(files[packed[0]], packed[0])
    if not known:
        name = min(files, key=lambda item: item == MANIFEST)
        if not files[name]:
            raise DataError(f"{name}: the file is empty; upload it again")
        raise DataError(
            f"{name}: the file is neither NetCDF, as capytaine.export_dataset('{Path(name).stem}.nc', dataset) writes "
            f"it, nor one of WAMIT's .1 .2 .3 .4 .8 .9 .12d .hst"
        )
    if len(stems(known)) > 1:
        raise DataError(f"{', '.join(sorted(known)[:8])}: the files are of {len(stems(known))} runs; give those of one")
    carried = conventions(files, "archive")
    if wamit is not None and carried is not None:
        _agree(wamit, carried)
    return read_wamit({name: files[name] for name in files if name != MANIFEST}, carried or wamit or WamitFiles())


def unpacked(files: Mapping[str, bytes]) -> dict[str, bytes]:
    """The files, archives opened. Raises DataError beyond the limits and for names that are there twice."""
    result: dict[str, bytes] = {}
    for name, payload in files.items():
        size = len(payload)
        limit = MAX_SET_BYTES if kind_of(name) else MAX_BYTES
        if size > limit:
            raise DataError(f"{name}: the file has {size / 2**20:.1f} MB; allowed: at most {limit // 2**20} MB")
        inner = unpack(payload, name) if is_zip(payload) else {name: payload}
        twice = sorted(set(inner) & set(result))
        if twice:
            raise DataError(f"{twice[0]}: the file is given twice; give each once")
        result.update(inner)
    total = sum(len(payload) for payload in result.values())
    if total > MAX_SET_BYTES:
        raise DataError(f"the files have {total / 2**20:.0f} MB together; allowed: at most {MAX_SET_BYTES // 2**20} MB")
    return result


def _is_netcdf(payload: bytes) -> bool:
    return payload[:8] == b"\x89HDF\r\n\x1a\n" or payload[:3] == b"CDF"


def _agree(asked: WamitFiles, carried: WamitFiles) -> None:
    """A case that states conventions other than those of the upload is refused."""
    for field in ("length", "values", "first_column", "pair_columns", "pair_order", "drift", "centre_of_mass"):
        want, have = getattr(asked, field), getattr(carried, field)
        if want not in (have, WamitFiles.model_fields[field].default):
            raise DataError(
                f"the case says {field} {want} (vessel.hydrodynamics.wamit), the data set was uploaded with {have}; "
                f"leave it out of the case, or upload the files again with {want}"
            )


@dataclass(frozen=True)
class FileSource:
    """Files in a folder. `confined`: only what lies inside it, no absolute paths, no '..', no links that lead out."""

    base: Path
    confined: bool = False

    def open(self, reference: str, wamit: WamitFiles | None = None) -> HydrodynamicData:
        """The data of `reference`, relative to the folder: a file, one file of a WAMIT set, its stem, or a folder
        that holds one set. Raises DataError.
        """
        try:
            paths = self._files(reference)
            total = sum(path.stat().st_size for path in paths)
            if total > MAX_SET_BYTES:
                raise DataError(
                    f"{reference}: the files have {total / 2**20:.0f} MB, too large; allowed: at most "
                    f"{MAX_SET_BYTES // 2**20} MB"
                )
            files = {plain(path.name): path.read_bytes() for path in paths}
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or "not a path"
            raise DataError(f"{reference!r}: the file cannot be read: {reason}") from None
        return read_files(files, wamit)

    def _files(self, reference: str) -> list[Path]:
        path = self._path(reference)
        if path.is_file() and not kind_of(path.name):
            return [path]
        folder = path if path.is_dir() else path.parent
        stem = path.name[: path.name.rfind(".")] if kind_of(path.name) else path.name
        found = [item for item in islice(folder.iterdir(), MAX_LISTED) if kind_of(item.name) and item.is_file()]
        if not path.is_dir():
            found = [item for item in found if item.name[: item.name.rfind(".")].lower() == stem.lower()]
        if not found or (kind_of(path.name) and not path.is_file()):
            raise DataError(f"{reference}: there is no such file beside the case; check vessel.hydrodynamics.data")
        for item in found:
            if self.confined and not item.resolve().is_relative_to(self.base.resolve()):
                raise DataError(f"{item.name}: the file lies outside the case's folder; put it inside")
        return sorted(found)

    def _path(self, reference: str) -> Path:
        if self.confined:
            parts = (*PurePosixPath(reference).parts, *PureWindowsPath(reference).parts)
            if ".." in parts or PurePosixPath(reference).is_absolute() or PureWindowsPath(reference).anchor:
                raise DataError(f"{reference}: give a path inside the case's folder, without '..'")
            try:
                inside = (self.base / reference).resolve().is_relative_to(self.base.resolve())
            except (OSError, ValueError):
                inside = False
            if not inside:
                raise DataError(f"{reference}: the file lies outside the case's folder; put it inside")
        return self.base / reference
