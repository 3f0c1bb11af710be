"""Several files as one: a ZIP that was uploaded, and the ZIP in which a set is kept with its conventions."""

from __future__ import annotations

import io
import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath, PureWindowsPath

from pydantic import ValidationError

from ...case.vessel import WamitFiles
from ...outcome import DataError

MAX_FILES = 64
MAX_SET_BYTES = 128 * 1024 * 1024  # of all files of a set, unpacked
MANIFEST = "slowdrift.json"
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)


def plain(filename: str) -> str:
    """The last part of a path, whatever system wrote it."""
    return PureWindowsPath(PurePosixPath(filename).name).name[:120] or "file"


def is_zip(payload: bytes) -> bool:
    return payload[:4] in (b"PK\x03\x04", b"PK\x05\x06")


def unpack(payload: bytes, name: str, limit: int = MAX_SET_BYTES) -> dict[str, bytes]:
    """The files of a ZIP by their plain names, never more than `limit` bytes of them in memory.

    Raises DataError for a damaged or encrypted archive, too many or too large files, and names that are there twice.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(payload)) as archive:
            members = [item for item in archive.infolist() if not item.is_dir()]
            if len(members) > MAX_FILES:
                raise DataError(f"{name}: the archive holds {len(members)} files; allowed: at most {MAX_FILES}")
            files: dict[str, bytes] = {}
            for item in members:
                inner = plain(item.filename)
                if item.flag_bits & 1 or item.compress_type not in _METHODS:
                    raise DataError(f"{name}: {inner} is encrypted or packed in an unusual way; use plain ZIP")
                if inner in files:
                    raise DataError(f"{name}: {inner} is in the archive twice; give the files of one run")
                left = limit - sum(len(part) for part in files.values())
                with archive.open(item) as stream:
                    files[inner] = stream.read(left + 1)
                if len(files[inner]) > left:
                    raise DataError(
                        f"{name}: the archive unpacks to more than {limit / 2**20:.0f} MB at {inner}; leave out "
                        f"headings or frequencies, or files that are not hydrodynamic data"
                    )
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError, ValueError) as error:
        raise DataError(f"{name}: the archive is damaged ({str(error)[:80]}); pack it again") from None
    return files


def pack(files: Mapping[str, bytes], options: WamitFiles) -> bytes:
    """A set and its conventions as one ZIP, the same bytes for the same set."""
    target = io.BytesIO()
    manifest = json.dumps({"wamit": options.model_dump(mode="json")}, sort_keys=True).encode()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, payload in sorted({**files, MANIFEST: manifest}.items()):
            item = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            item.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(item, payload)
    return target.getvalue()


def conventions(files: Mapping[str, bytes], name: str) -> WamitFiles | None:
    """Those that a packed set carries, None for another archive. Raises DataError for a damaged manifest."""
    text = files.get(MANIFEST)
    if text is None:
        return None
    try:
        found = json.loads(text.decode())["wamit"]
        return WamitFiles.model_validate(found)
    except (ValueError, KeyError, TypeError, RecursionError, ValidationError) as error:
        reason = (str(error).splitlines() or [""])[0][:80]
        raise DataError(f"{name}: {MANIFEST} in the archive cannot be read ({reason}); pack the set again") from None


def stems(names: Sequence[str]) -> list[str]:
    """The different names before the last dot, sorted, of files of a set."""
    return sorted({name[: name.rfind(".")].lower() for name in names})
