"""A study as a table: one row per run, its columns picked out of what the run changes and of its summary."""

from __future__ import annotations

import csv
import io
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import IO, Any

from fastapi.exceptions import RequestValidationError

from store.database import from_text as from_json
from store.errors import UnavailableError
from store.figures import is_kept, parsed, plain, taken, usual
from store.models import Study
from store.repositories import StudyRepository
from store.repositories.studies import Row
from store.scope import Scope

from ..context import Context
from ..study_schemas import StudyTable

OWN: dict[str, Callable[[Row], Any]] = {
    "index": lambda row: row.index,
    "run_id": lambda row: row.run_id,
    "state": lambda row: row.state,
    "reason": lambda row: row.reason,
    "seconds": lambda row: row.seconds,
}
FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""What a spreadsheet would take for a formula at the start of a text."""
TURN, MOST_TURNS = 0.001, 5
BATCH, FIRST = 100, 1000
"""Runs read at once; runs looked at for one with results, to name the columns."""


class Values:
    """What a row's cells are taken from: the values kept when its run ended, else the summary."""

    def __init__(self, row: Row):
        self.row = row
        self._figures = from_json(row.figures) if row.figures else None
        self._summary: Any = None

    def kept(self, name: str) -> Any:
        return self.of(name) if self._figures is None else self._figures.get(name)

    def of(self, name: str) -> Any:
        if self._summary is None:
            self._summary = from_json(self.row.summary) if self.row.summary else {}
        return plain(taken(self._summary, name))


@dataclass(frozen=True)
class Column:
    """Its name, and what it takes from a row; `whole`: whether it needs summaries."""

    name: str
    take: Callable[[Values], Any]
    whole: bool = False


def table(context: Context, scope: Scope, study_id: str, columns: str | None, limit: int, after: int) -> StudyTable:
    """One page. Raises RequestValidationError for a column that cannot be."""
    chosen = _chosen(context, scope, study_id, columns)
    rows = [row for batch in _batches(context, scope, study_id, chosen, after, limit) for row in batch]
    following = str(rows[-1].index) if len(rows) == limit else None
    return StudyTable(
        columns=[column.name for column in chosen], rows=[_cells(row, chosen) for row in rows], next_cursor=following
    )


def as_csv(context: Context, scope: Scope, study_id: str, columns: str | None) -> Iterator[bytes]:
    """The whole table, piece by piece. What is wrong with the request is raised before the first piece."""
    chosen = _chosen(context, scope, study_id, columns)

    def pieces() -> Iterator[bytes]:
        yield _lines([[column.name for column in chosen]])
        for batch in _batches(context, scope, study_id, chosen):
            yield _lines(_cells(row, chosen) for row in _in_turns(batch))

    return pieces()


def _in_turns(rows: Iterable[Row]) -> Iterator[Row]:
    """The rows; after each millisecond of work on them others have the interpreter for as long."""
    began = time.perf_counter()
    for row in rows:
        yield row
        worked = time.perf_counter() - began
        if worked > TURN:
            time.sleep(min(worked, MOST_TURNS * TURN))
            began = time.perf_counter()


def _lines(rows: Iterable[Sequence[Any]]) -> bytes:
    text = io.StringIO(newline="")
    csv.writer(text).writerows([_harmless(cell) for cell in cells] for cells in rows)
    return text.getvalue().encode()


def as_parquet(context: Context, scope: Scope, study_id: str, columns: str | None) -> IO[bytes]:
    """As `as_csv`; a column is of numbers where all its cells are, else of texts."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise UnavailableError("Parquet needs pyarrow on the server: pip install 'slowdrift[parquet]'.") from None
    chosen = _chosen(context, scope, study_id, columns)
    rows = [_cells(row, chosen) for batch in _batches(context, scope, study_id, chosen) for row in _in_turns(batch)]
    names = [column.name for column in chosen]
    arrays = [_array(pa, [row[index] for row in rows]) for index in range(len(names))]
    spool: IO[bytes] = tempfile.SpooledTemporaryFile(max_size=8_000_000)  # noqa: SIM115 (closed by whoever reads it)
    pq.write_table(pa.Table.from_arrays(arrays, names=names), spool, compression="zstd")
    spool.seek(0)
    return spool


def _array(pa: Any, cells: Sequence[Any]) -> Any:
    known = [cell for cell in cells if cell is not None]
    if all(isinstance(cell, bool) for cell in known):
        return pa.array(cells, pa.bool_() if known else pa.float64())
    if all(isinstance(cell, int) and not isinstance(cell, bool) for cell in known):
        return pa.array(cells, pa.int64())
    if all(isinstance(cell, int | float) and not isinstance(cell, bool) for cell in known):
        return pa.array([None if cell is None else float(cell) for cell in cells], pa.float64())
    return pa.array([None if cell is None else str(cell) for cell in cells], pa.string())


def _batches(
    context: Context, scope: Scope, study_id: str, columns: Sequence[Column], after: int = -1, limit: int | None = None
) -> Iterator[list[Row]]:
    """The rows in their order, a few at a time. Each batch is a unit of work of its own: a reader who is slow holds no
    connection to the database."""
    whole = any(column.whole for column in columns)
    left = sys.maxsize if limit is None else limit
    while left > 0:
        wanted = min(BATCH, left)
        with context.database.read() as session:
            batch = list(StudyRepository(session, scope).rows(study_id, after, wanted, whole))
        if batch:
            yield batch
        if len(batch) < wanted:
            return
        after, left = batch[-1].index, left - len(batch)


def _harmless(cell: Any) -> Any:
    return f"'{cell}" if isinstance(cell, str) and cell.startswith(FORMULA) else cell


def _cells(row: Row, columns: Sequence[Column]) -> list[Any]:
    values = Values(row)
    return [plain(column.take(values)) for column in columns]


def _chosen(context: Context, scope: Scope, study_id: str, asked: str | None) -> list[Column]:
    with context.database.read() as session:
        studies = StudyRepository(session, scope)
        study = studies.get(study_id)
        if asked is None:
            first = next((row for row in studies.rows(study.id, limit=FIRST) if row.figures or row.summary), None)
            names = ["index", "run_id", "state", *study.pointers, *(_usual(first) if first else ())]
        else:
            names = [name.strip() for name in asked.split(",") if name.strip()]
            if not 0 < len(names) <= 100:
                raise _fault(f"{len(names)} columns; allowed: 1 to 100", asked)
        return [_column(name, study) for name in names]


def _usual(row: Row) -> list[str]:
    """As far as the run has results."""
    if row.figures:
        return [name for name in from_json(row.figures) if not name.startswith("modes.")]
    return usual(from_json(row.summary or "{}"))


def _column(name: str, study: Study) -> Column:
    if name in OWN:
        return Column(name, lambda values: OWN[name](values.row))
    if name.startswith("/"):
        if name not in study.pointers:
            raise _fault(f"the study does not change this; it changes: {', '.join(study.pointers)}"[:500], name)
        return Column(name, lambda values: values.row.overrides.get(name))
    path, _ = parsed(name)
    if not all(path) or len(path) > 12 or len(name) > 300:
        raise _fault("neither one of index, run_id, state, reason, seconds, nor a pointer, nor a dotted path", name)
    if is_kept(name):
        return Column(name, lambda values: values.kept(name))
    return Column(name, lambda values: values.of(name), whole=True)


def _fault(message: str, value: str) -> RequestValidationError:
    return RequestValidationError([{"loc": ("columns",), "msg": message, "input": value}])
