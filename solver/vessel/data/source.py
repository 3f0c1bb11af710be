"""Where hydrodynamic data come from: bytes of a file, a folder, or whatever else opens a reference."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Protocol

from ...outcome import DataError
from .capytaine import read_capytaine
from .hydrodynamics import HydrodynamicData

MAX_BYTES = 64 * 1024 * 1024


class DataSource(Protocol):
    """Opens the `data` of a case's vessel.hydrodynamics; raises DataError with a remedy."""

    def open(self, reference: str) -> HydrodynamicData: ...


def read_bytes(payload: bytes, filename: str) -> HydrodynamicData:
    """Hydrodynamic data from the bytes of a file; the content says its kind, `filename` only names it in messages.

    Raises DataError, one sentence naming the file, the variable at fault and the remedy.
    """
    name = PureWindowsPath(PurePosixPath(filename).name).name[:120] or "file"
    if len(payload) > MAX_BYTES:
        raise DataError(f"{name}: the file has {len(payload) / 2**20:.1f} MB; allowed: at most {MAX_BYTES // 2**20} MB")
    if not payload:
        raise DataError(f"{name}: the file is empty; upload it again")
    if payload[:8] == b"\x89HDF\r\n\x1a\n" or payload[:3] == b"CDF":
        return read_capytaine(payload, name)
    raise DataError(
        f"{name}: the file is not NetCDF; write it with capytaine.export_dataset('{Path(name).stem}.nc', dataset)"
    )


@dataclass(frozen=True)
class FileSource:
    """Files in a folder. `confined`: only what lies inside it, no absolute paths, no '..', no links that lead out."""

    base: Path
    confined: bool = False

    def open(self, reference: str) -> HydrodynamicData:
        """The data of the file `reference`, relative to the folder. Raises DataError."""
        path = self._path(reference)
        try:
            if not path.is_file():
                raise DataError(f"{reference}: there is no such file beside the case; check vessel.hydrodynamics.data")
            if path.stat().st_size > MAX_BYTES:
                raise DataError(f"{reference}: the file is too large; allowed: at most {MAX_BYTES // 2**20} MB")
            payload = path.read_bytes()
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or "not a path"
            raise DataError(f"{reference!r}: the file cannot be read: {reason}") from None
        return read_bytes(payload, path.name)

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
