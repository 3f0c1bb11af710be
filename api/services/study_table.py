"""A study as a table: one row per run, its columns picked out of what the run changes and of its summary."""

from __future__ import annotations

import csv
import io
import json
import re
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import IO, Any

from fastapi.exceptions import RequestValidationError

from store.errors import UnavailableError
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
BATCH = 1000
_EXTREME = re.compile(r"^(max|min)\((.+)\)$")


@dataclass(frozen=True)
class Column:
    """Its name, and what it takes from a row and the row's summary."""

    name: str
    take: Callable[[Row, Any], Any]


def table(context: Context, scope: Scope, study_id: str, columns: str | None, limit: int, after: int) -> StudyTable:
    """One page. Raises RequestValidationError for a column that cannot be."""
    with context.database.snapshot() as session:
        studies = StudyRepository(session, scope)
        chosen = _columns(studies, studies.get(study_id), columns)
        rows = list(studies.rows(study_id, after, limit))
    following = str(rows[-1].index) if len(rows) == limit else None
    return StudyTable(
        columns=[column.name for column in chosen], rows=[_cells(row, chosen) for row in rows], next_cursor=following
    )


def as_csv(context: Context, scope: Scope, study_id: str, columns: str | None) -> IO[bytes]:
    """The whole table, in an open file that is gone once closed."""
    spool = _spool()
    text = io.TextIOWrapper(spool, "utf-8", newline="", write_through=True)
    writer = csv.writer(text)
    for cells in _whole(context, scope, study_id, columns):
        writer.writerow(_harmless(cell) for cell in cells)
    text.detach()
    spool.seek(0)
    return spool


def as_parquet(context: Context, scope: Scope, study_id: str, columns: str | None) -> IO[bytes]:
    """As `as_csv`; a column is of numbers where all its cells are, else of texts."""
    try:
        import pyarrow as pa
        import pyarrow.parquet as pq
    except ImportError:
        raise UnavailableError("Parquet needs pyarrow on the server: pip install 'slowdrift[parquet]'.") from None
    names, *rows = _whole(context, scope, study_id, columns)
    arrays = [_array(pa, [row[index] for row in rows]) for index in range(len(names))]
    spool = _spool()
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


def _whole(context: Context, scope: Scope, study_id: str, columns: str | None) -> Iterator[list[Any]]:
    """The names, then the rows. One row's summary in memory at a time."""
    with context.database.snapshot() as session:
        studies = StudyRepository(session, scope)
        chosen = _columns(studies, studies.get(study_id), columns)
        yield [column.name for column in chosen]
        for row in studies.rows(study_id):
            yield _cells(row, chosen)


def _spool() -> IO[bytes]:
    return tempfile.SpooledTemporaryFile(max_size=8_000_000)


def _harmless(cell: Any) -> Any:
    return f"'{cell}" if isinstance(cell, str) and cell.startswith(FORMULA) else cell


def _cells(row: Row, columns: Sequence[Column]) -> list[Any]:
    summary = json.loads(row.summary) if row.summary else {}
    return [_plain(column.take(row, summary)) for column in columns]


def _plain(value: Any) -> Any:
    """A single value; what is not one is text."""
    return value if value is None or isinstance(value, bool | int | float | str) else json.dumps(value)


def _columns(studies: StudyRepository, study: Study, asked: str | None) -> list[Column]:
    if asked is None:
        return [
            _column(name, study) for name in (*("index", "run_id", "state"), *study.pointers, *_usual(studies, study))
        ]
    names = [name.strip() for name in asked.split(",") if name.strip()]
    if not 0 < len(names) <= 100:
        raise _fault(f"{len(names)} columns; allowed: 1 to 100", asked)
    return [_column(name, study) for name in names]


def _usual(studies: StudyRepository, study: Study) -> list[str]:
    """Standard deviations of the vessel and largest tensions, as far as the first result has them."""
    first = next((row.summary for row in studies.rows(study.id, limit=BATCH) if row.summary), None)
    summary = json.loads(first) if first else {}
    names = []
    for domain in ("frequency_domain", "time_domain"):
        found = summary.get(domain, {})
        for band, values in (found.get("vessel_std") or {}).items():
            names += [f"{domain}.vessel_std.{band}.{dof}" for dof in values]
        for line, values in (found.get("lines") or {}).items():
            names += [f"max({domain}.lines.{line}.tension_std.{band})" for band in values.get("tension_std") or {}]
            if "tension_max" in values:
                names.append(f"max({domain}.lines.{line}.tension_max)")
    return names


def _column(name: str, study: Study) -> Column:
    if name in OWN:
        return Column(name, lambda row, _: OWN[name](row))
    if name.startswith("/"):
        if name not in study.pointers:
            raise _fault(f"the study does not change this; it changes: {', '.join(study.pointers)}"[:500], name)
        return Column(name, lambda row, _: row.overrides.get(name))
    extreme = _EXTREME.match(name)
    path = (extreme.group(2) if extreme else name).split(".")
    if not all(path) or len(path) > 12 or len(name) > 300:
        raise _fault("neither one of index, run_id, state, reason, seconds, nor a pointer, nor a dotted path", name)
    pick = {"max": max, "min": min}[extreme.group(1)] if extreme else None
    return Column(name, lambda _, summary: _at(summary, path, pick))


def _at(value: Any, path: Sequence[str], pick: Callable[[list[Any]], Any] | None) -> Any:
    """What is there, or the extreme of the numbers there; None where there is nothing."""
    for part in path:
        if isinstance(value, dict):
            value = value.get(part)
        elif isinstance(value, list) and part.isascii() and part.isdigit() and int(part) < len(value):
            value = value[int(part)]
        else:
            return None
    if pick is None:
        return value
    numbers = list(_numbers(value))
    return pick(numbers) if numbers else None


def _numbers(value: Any) -> Iterator[float]:
    if isinstance(value, list):
        for each in value:
            yield from _numbers(each)
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield value


def _fault(message: str, value: str) -> RequestValidationError:
    return RequestValidationError([{"loc": ("columns",), "msg": message, "input": value}])
