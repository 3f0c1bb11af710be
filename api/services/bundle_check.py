"""A bundle (bundle.py) from somewhere else, taken for hostile: nothing is unpacked to disk, everything is checked
against the manifest. Called in a child process (store/isolation).
"""

from __future__ import annotations

import hashlib
import json
import math
import zipfile
from collections.abc import Iterator
from typing import IO, Any

import numpy as np
from pydantic import ValidationError

from solver.case import Case, load_case, parse_case
from solver.case.text import MAX_BYTES, read_text
from solver.outcome import CaseError, DataError, FieldError
from solver.vessel import data as hydrodynamics
from store.arrays import Encoded, decode

from .bundle_format import CASE, CASE_TEXT, MANIFEST, SUMMARY, Listed, Manifest

MANIFEST_BYTES, SUMMARY_BYTES = 20_000_000, 50_000_000
MAX_VALUES = 50_000_000
"""In one channel."""


class Archive:
    """The files that the manifest names: each read up to its stated size, and held against its hash."""

    def __init__(self, file: IO[bytes], limit: int):
        try:
            self._zip = zipfile.ZipFile(file)
        except (zipfile.BadZipFile, ValueError, OSError) as error:
            raise _fault("file", f"is no ZIP archive: {error}") from None
        self._infos = self._listed(limit)
        self.manifest = self._manifest()
        missing = sorted(set(self.manifest.files) - set(self._infos))[:3]
        names = [listed.name for listed in self.manifest.channels]
        if len(set(names)) < len(names):
            raise _fault(MANIFEST, "names a channel twice")
        extra = sorted(set(self._infos) - set(self.manifest.files) - {MANIFEST})[:3]
        if missing or extra:
            raise _fault(MANIFEST, f"does not fit the archive: missing {missing}, not named {extra}")

    def _listed(self, limit: int) -> dict[str, zipfile.ZipInfo]:
        found: dict[str, zipfile.ZipInfo] = {}
        for item in self._zip.infolist():
            if item.filename in found:
                raise _fault("file", "holds a name twice", repr(item.filename)[:80])
            if item.flag_bits & 1 or item.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise _fault("file", "holds an entry that is encrypted or of another compression", item.filename[:80])
            found[item.filename] = item
        total = sum(item.file_size for item in found.values())
        if total > limit:
            raise _fault("file", f"unpacks to {total} bytes; allowed: at most {limit}")
        return found

    def _manifest(self) -> Manifest:
        content = self._read(MANIFEST, MANIFEST_BYTES)
        try:
            return Manifest.model_validate_json(content)
        except ValidationError as error:
            faults = [FieldError((MANIFEST, *item["loc"]), item["msg"]) for item in error.errors()[:20]]
            raise CaseError(faults) from None

    def read(self, name: str, limit: int | None = None) -> bytes:
        stated = self.manifest.files.get(name)
        if stated is None:
            raise _fault(MANIFEST, f"names no file {name}")
        content = self._read(name, min(stated.size, limit) if limit else stated.size)
        if len(content) != stated.size or hashlib.sha256(content).hexdigest() != stated.sha256:
            raise _fault(name, "is not what the manifest says: its size or its SHA-256 differs")
        return content

    def _read(self, name: str, limit: int) -> bytes:
        item = self._infos.get(name)
        if item is None:
            raise _fault("file", f"holds no {name}")
        try:
            with self._zip.open(item) as file:
                content = file.read(limit + 1)
        except (zipfile.BadZipFile, OSError, EOFError, ValueError, NotImplementedError) as error:
            raise _fault(name, f"cannot be unpacked: {error}") from None
        except Exception as error:  # zlib.error and whatever a broken stream brings
            raise _fault(name, f"cannot be unpacked ({type(error).__name__})") from None
        if len(content) > limit:
            raise _fault(name, f"has more than {limit} bytes")
        return content


def checked(file: IO[bytes], limit: int) -> Iterator[dict[str, Any]]:
    """First what there is beside the channels, then the fields of each channel's row. Raises CaseError.

    manifest : its JSON. case : name, content hash, canonical text and YAML. summary : JSON. data : what
    DataSetRepository.save takes, or None.
    """
    archive = Archive(file, limit)
    case = _case(archive)
    yield {
        "manifest": archive.manifest.model_dump_json(),
        "case": (case.name, case.content_hash(), case.canonical(), archive.read(CASE_TEXT, MAX_BYTES).decode()),
        "summary": _summary(archive),
        "data": _data(archive),
    }
    for number, listed in enumerate(archive.manifest.channels):
        yield _channel(archive, listed) | {"number": number}


def _case(archive: Archive) -> Case:
    """The case by its canonical text, and the YAML beside it must mean the same."""
    part = archive.manifest.run
    canonical, yaml = _json(archive.read(CASE, 4 * MAX_BYTES), CASE), archive.read(CASE_TEXT, MAX_BYTES)
    try:
        case, text = parse_case(canonical), load_case(yaml)
        if text.content_hash() != case.content_hash():
            text = parse_case(_with_catalogue_values(read_text(yaml)[0], canonical))
    except CaseError as error:
        raise CaseError([FieldError(("case", *each.loc), each.message, each.value) for each in error.errors]) from None
    if not case.content_hash() == text.content_hash() == part.content_hash:
        raise _fault(CASE, "its content hash, that of the YAML and the manifest's are not the same")
    unknown = set(part.analyses) - set(case.analyses.requested())
    if unknown or case.name != part.case_name or not case.name.isprintable() or not part.name.isprintable():
        raise _fault(MANIFEST, "its names or analyses are not those of the case, or cannot be shown")
    return case


def _with_catalogue_values(data: Any, canonical: Any) -> Any:
    """The text's case with the values that the catalogue gave its line types when it was saved."""
    for name, kind in (canonical.get("line_types") or {}).items():
        if kind.get("catalogue_values") is not None and isinstance((data.get("line_types") or {}).get(name), dict):
            data["line_types"][name].setdefault("catalogue_values", kind["catalogue_values"])
    return data


def _summary(archive: Archive) -> str:
    found = _json(archive.read(SUMMARY, SUMMARY_BYTES), SUMMARY)
    if not isinstance(found, dict):
        raise _fault(SUMMARY, "is not an object")
    return json.dumps(found, allow_nan=False)


def _data(archive: Archive) -> tuple[str, str, str, bytes, dict[str, Any]] | None:
    """What DataSetRepository.save takes: name, file name, hash, bytes, summary."""
    part = archive.manifest.run
    if part.data_file is None:
        return None
    payload, filename = archive.read(part.data_file), part.data_file.removeprefix("data/")
    try:
        data = hydrodynamics.read_bytes(payload, filename)
        if data.content_hash != part.data_hash:
            raise _fault(part.data_file, "its content hash is not the manifest's")
        return part.data_name or filename, filename, data.content_hash, payload, data.describe()
    except DataError as error:
        raise _fault(part.data_file, str(error)) from None


def _channel(archive: Archive, listed: Listed) -> dict[str, Any]:
    """Fields of the row, once its bytes have turned out to be the array that is described."""
    payload, axes_payload = archive.read(listed.values), archive.read(listed.coordinates)
    if any(size < 0 for size in listed.shape) or math.prod(listed.shape) > MAX_VALUES:
        raise _fault(listed.values, f"has the shape {listed.shape}; allowed: at most {MAX_VALUES} values")
    try:
        sizes = [int(axis["size"]) for axis in listed.axes]
        if sizes != listed.shape or any(axis.keys() - AXIS for axis in listed.axes):
            raise ValueError("its axes are not those of its shape")
        numbers = [axis.get(key, 0.0) for axis in listed.axes for key in ("first", "last", "step")]
        channel = decode(
            Encoded(listed.codec, tuple(listed.shape), listed.axes, payload, axes_payload),
            listed.name, listed.unit, listed.description, listed.band,
        )  # fmt: skip
        if not all(np.isfinite(each).all() for each in [np.asarray(numbers), *(axis.values for axis in channel.axes)]):
            raise ValueError("not every number of its axes is finite")
    except Exception as error:  # whatever bytes that are no array bring, from zstandard, NumPy or a dictionary
        raise _fault(listed.values, f"is no channel {listed.name!r}: {error}"[:300]) from None
    shown = listed.model_dump(include={"name", "unit", "description", "band", "axes", "shape", "codec"})
    return {**shown, "payload": payload, "axes_payload": axes_payload}


AXIS = {"name", "unit", "size", "first", "last", "step"}


def _json(content: bytes, name: str) -> Any:
    try:
        return json.loads(content, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise _fault(name, f"is no JSON: {error}"[:200]) from None


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number that JSON knows")


def _fault(field: str, message: str, value: str = "") -> CaseError:
    return CaseError([FieldError((field,), message, value)])
