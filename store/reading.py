"""Hydrodynamic data, decks and meshes that may be damaged or hostile: read in a child process (store/isolation)."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from solver.case.text import Loc, Reading, read_document
from solver.case.text import read_case as read_here
from solver.case.vessel import WamitFiles
from solver.outcome import CaseError, DataError, FieldError
from solver.vessel.data import FileSource, HydrodynamicData
from solver.vessel.data.bundle import MAX_SET_BYTES, plain
from solver.vessel.data.source import MAX_LISTED
from solver.vessel.data.wamit import kind_of

from .isolation import Limits, Stopped, call

if TYPE_CHECKING:
    from solver.bem import Hull, HydrodynamicJob

SECONDS, BYTES_PER_SECOND = 3.0, 2_000_000
"""Computing time for a small file, and how much longer a large one may take: a WAMIT text of 50 MB takes 13 s."""


def limits_for(size: int, seconds: float = SECONDS) -> Limits:
    """For a file of `size` bytes."""
    seconds += size / BYTES_PER_SECOND
    return Limits(cpu_seconds=seconds, wall_seconds=4 * seconds + 10)


HULL_SECONDS = 30.0
"""The same for the geometry of a hydrodynamic job, whose panels are compared with one another."""


def damaged(name: str, stopped: Stopped) -> str:
    """The sentence about a file that the child did not get through."""
    if stopped.cause == "memory":
        return f"{name}: the file is damaged or too large ({stopped}); write it again, with fewer values"
    return f"{name}: the file is damaged ({stopped}); write it again"


SMALL_TEXT, SMALL_DATA = 50_000, 5000
"""Characters of a case's text, values of a case's data: what is read without a child, in a few milliseconds."""
CASE_SECONDS = 20.0


def read_case(text: str | bytes) -> Reading:
    """As solver.case.text.read_case, a large text in a child. Raises CaseError."""
    return read_here(text) if len(text) <= SMALL_TEXT else _reading("store.reading:case_of_text", text, len(text))


def read_case_data(data: Any) -> Reading:
    """As Reading.of, for plain data from anybody. Raises CaseError."""
    size = sum(1 for _ in islice(_values(data), SMALL_DATA + 1))
    return Reading.of(data) if size <= SMALL_DATA else _reading("store.reading:case_of_data", data, size)


def _values(data: Any) -> Iterator[Any]:
    waiting = [data]
    while waiting:
        value = waiting.pop()
        yield value
        if isinstance(value, dict | list):
            waiting += value.values() if isinstance(value, dict) else value


def _reading(function: str, given: Any, size: int) -> Reading:
    """A case with many faults is answered by the child; what it lets pass has few, and is looked at here again."""
    try:
        data, lines, repeated = call(function, given, limits=limits_for(size, CASE_SECONDS))
    except Stopped as stopped:
        raise CaseError([FieldError((), f"the case takes too much to be read ({stopped}); make it smaller")]) from None
    return Reading.of(data, lines, repeated)


def case_of_text(text: str | bytes) -> tuple[Any, dict[Loc, int], list[FieldError]]:
    """In the child: the document, unless its fields have faults."""
    document = read_document(text)
    _refuse(Reading.of(*document))
    return document


def case_of_data(data: Any) -> tuple[Any, dict[Loc, int], list[FieldError]]:
    """In the child: the same data, unless its fields have faults."""
    _refuse(Reading.of(data))
    return data, {}, []


def _refuse(reading: Reading) -> None:
    if len(reading.errors) > FEW:
        reading.sound()


FEW = 100
"""Faults: with fewer, the case is also looked at together with its hydrodynamic data, which the child has not."""


def read_files(files: Mapping[str, bytes], wamit: WamitFiles | None = None) -> HydrodynamicData:
    """As solver.vessel.data.read_files. Raises DataError, and UnavailableError where too many files wait."""
    size = sum(len(payload) for payload in files.values())
    name = ", ".join(sorted(files)[:3])
    return _data("solver.vessel.data:read_files", (dict(files), wamit), limits_for(size), name)


def read_bytes(payload: bytes, filename: str, wamit: WamitFiles | None = None) -> HydrodynamicData:
    """As solver.vessel.data.read_bytes."""
    return read_files({plain(filename): payload}, wamit)


@dataclass(frozen=True)
class IsolatedFiles:
    """As FileSource, with the files read in a child; each reference once."""

    base: Path
    confined: bool = False
    _found: dict[tuple[str, str], HydrodynamicData] = field(default_factory=dict)

    def open(self, reference: str, wamit: WamitFiles | None = None) -> HydrodynamicData:
        key = (reference, "" if wamit is None else wamit.model_dump_json())
        if key not in self._found:
            arguments = (str(self.base), self.confined, reference, wamit)
            limits = limits_for(_size(self.base / reference))
            self._found[key] = _data("store.reading:open_file", arguments, limits, reference)
        return self._found[key]


def open_file(base: str, confined: bool, reference: str, wamit: WamitFiles | None) -> HydrodynamicData:
    """In the child."""
    return FileSource(Path(base), confined).open(reference, wamit)


def _size(path: Path) -> int:
    """Bytes of a file, or of the set that a stem or folder means; it only decides how long reading may take."""
    try:
        if path.is_file() and not kind_of(path.name):
            return path.stat().st_size
        folder = path if path.is_dir() else path.parent
        found = [item for item in islice(folder.iterdir(), MAX_LISTED) if kind_of(item.name) and item.is_file()]
        return min(sum(item.stat().st_size for item in found), MAX_SET_BYTES)
    except (OSError, ValueError):
        return 0


def _data(function: str, arguments: tuple[Any, ...], limits: Limits, name: str) -> HydrodynamicData:
    try:
        found = call(function, *arguments, limits=limits)
    except Stopped as stopped:
        raise DataError(damaged(name, stopped)) from None
    if not isinstance(found, HydrodynamicData):
        raise DataError(f"{name}: the file is damaged; write it again")
    return found


def quality_of(payload: bytes, filename: str) -> list[dict[str, Any]]:
    """The quality checks of stored hydrodynamic data, in plain values. Raises DataError."""
    try:
        found: list[dict[str, Any]] = call("store.reading:checks", payload, filename, limits=limits_for(len(payload)))
    except Stopped as stopped:
        raise DataError(damaged(filename, stopped)) from None
    return found


def checks(payload: bytes, filename: str) -> list[dict[str, Any]]:
    """In the child."""
    from solver.vessel.data import read_bytes as read
    from solver.vessel.quality import quality

    return [check.as_dict() for check in quality(read(payload, filename))]


def read_deck(
    deck: str | bytes, base: str | bytes | None = None, name: str | None = None, pinned: bool = False
) -> dict[str, Any]:
    """A MoorDyn deck as solver.io.moordyn.read_deck reads it, in plain values: complete, name, yaml, case, report,
    errors (FieldError), and `comment`, the report as text. Raises CaseError."""
    try:
        limits = limits_for(len(deck) + len(base or ""))
        found: dict[str, Any] = call("store.reading:deck_fields", deck, base, name, pinned, limits=limits)
    except Stopped as stopped:
        raise CaseError([FieldError((), damaged("deck", stopped))]) from None
    return found


def deck_fields(deck: str | bytes, base: str | bytes | None, name: str | None, pinned: bool) -> dict[str, Any]:
    """In the child."""
    from solver.io.moordyn import read_deck

    found = read_deck(deck, base, name, pinned)
    return {
        "complete": found.case is not None,
        "name": found.data["name"],
        "yaml": found.yaml,
        "case": None if found.case is None else json.loads(found.case.canonical()),
        "report": found.report.as_dict(),
        "comment": found.report.comment(""),
        "errors": list(found.errors),
    }


def read_hull(job: HydrodynamicJob, mesh: tuple[bytes, str] | None) -> Hull:
    """The wetted hull of a job; mesh: content and name, where it has one. Raises CaseError or DataError."""
    name = job.name if mesh is None else mesh[1]
    limits = limits_for(0 if mesh is None else len(mesh[0]), HULL_SECONDS)
    try:
        found = call("store.reading:hull", job, mesh, limits=limits)
    except Stopped as stopped:
        raise DataError(damaged(name, stopped)) from None
    if type(found).__name__ != "Hull":
        raise DataError(f"{name}: the file is damaged; write it again")
    made: Hull = found
    return made


def hull(job: HydrodynamicJob, mesh: tuple[bytes, str] | None) -> Hull:
    """In the child."""
    from solver.bem import prepare

    def fetch(_: str) -> tuple[bytes, str]:
        assert mesh is not None  # the caller has fetched it
        return mesh

    return prepare(job, fetch)
