"""What `slowdrift run --out` writes: channels as NetCDF, CSV or Parquet, or statistics tables as a workbook."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING

from .files import whole

if TYPE_CHECKING:
    from solver.case import Case
    from solver.io.selection import Selection
    from solver.outcome import FieldError
    from solver.results.channel import Channel
    from solver.results.part import Result


@dataclass(frozen=True)
class Wanted:
    """patterns : of channels, none for all. wide : a CSV file per set of axes, a column per channel and seed."""

    path: Path
    kind: str
    patterns: tuple[str, ...] = ()
    wide: bool = False


def wanted_of(args: argparse.Namespace, case: Case | None) -> tuple[Wanted | None, list[FieldError]]:
    """What the options ask for, and everything that is wrong with them, known before the run starts."""
    from importlib.util import find_spec

    from solver.case.partial import noted
    from solver.io.export import format_of
    from solver.io.table import NO_PARQUET
    from solver.outcome import FieldError

    if args.out is None:
        options = [name for name, given in (("channels", args.channels), ("layout", args.layout != "long")) if given]
        return None, [FieldError((f"--{name}",), "this belongs to --out FILE, not given") for name in options]
    errors: list[FieldError] = []
    patterns = tuple(text.strip() for text in (args.channels or "").split(",") if text.strip())
    kind, wide = "", args.layout == "wide"
    with noted(errors):
        kind = format_of(args.out.name)
    if not args.out.absolute().parent.is_dir():
        errors.append(FieldError(("--out",), f"{args.out} cannot be written: there is no such folder"))
    if kind == "parquet" and find_spec("pyarrow") is None:
        errors.append(FieldError(("--out",), NO_PARQUET, args.out.name))
    if wide and kind not in ("csv", ""):
        errors.append(FieldError(("--layout",), f"wide is a layout of .csv files; {args.out.suffix} has its own"))
    if kind == "xlsx" and args.channels is not None:
        errors.append(FieldError(("--channels",), "statistics tables (.xlsx) hold no channels; leave it out"))
    elif args.channels is not None:
        errors += _unknown(args.channels, patterns, case)
    return Wanted(args.out, kind, patterns, wide), errors


def _unknown(given: str, patterns: tuple[str, ...], case: Case | None) -> list[FieldError]:
    """Patterns that match no channel a run of this case can have."""
    from solver.case.partial import noted
    from solver.io.possible import possible_channels
    from solver.io.selection import select_channels
    from solver.outcome import CaseError, FieldError, Unread

    if not patterns:
        return [
            FieldError(("--channels",), f"{given!r} names no channel; give names or patterns, e.g. 'time/vessel/*'")
        ]
    errors: list[FieldError] = []
    with noted(errors):
        if case is None:
            raise Unread
        names: dict[str, tuple[str, ...]] = dict.fromkeys(possible_channels(case), ())
        for pattern in patterns:
            try:
                select_channels(names, _nothing, [pattern])
            except CaseError as error:
                errors += [FieldError(("--channels",), item.message, item.value) for item in error.errors]
    return errors


def _nothing(name: str) -> Channel:
    raise KeyError(name)


def write_results(wanted: Wanted, case: Case, result: Result, written: list[Path]) -> list[str]:
    """Write the files, each added to `written`; sentences about what this run does not have."""
    from solver.io.workbook import write_workbook

    if wanted.kind == "xlsx":
        _write(wanted.path, lambda file: write_workbook(file, result.summary, case), written)
        return []
    selection, notes = _selected(wanted, result)
    if selection is not None:
        if wanted.wide:
            _wide(wanted.path, selection, written)
        else:
            _long(wanted, selection, case, result, written)
    return notes


def _selected(wanted: Wanted, result: Result) -> tuple[Selection | None, list[str]]:
    from fnmatch import fnmatchcase

    from solver.io.selection import select_channels

    channels = {channel.name: channel for channel in result.channels}
    found = tuple(pattern for pattern in wanted.patterns if any(fnmatchcase(name, pattern) for name in channels))
    notes = [f"--channels: this run has no channel {one!r}" for one in wanted.patterns if one not in found]
    if not channels or (wanted.patterns and not found):
        return None, [*notes, f"{wanted.path} is not written: there are no channels for it"]
    dims = {name: channel.dims for name, channel in channels.items()}
    return select_channels(dims, channels.__getitem__, found), notes


def _long(wanted: Wanted, selection: Selection, case: Case, result: Result, written: list[Path]) -> None:
    from solver.case import to_yaml
    from solver.io.export import describe, write_results

    about = describe(result.summary, to_yaml(case), case.name)
    _write(wanted.path, lambda file: write_results(file, wanted.kind, selection, about), written)


def _wide(path: Path, selection: Selection, written: list[Path]) -> None:
    from solver.io.wide import wide_tables, write_table

    for ending, table in wide_tables(selection).items():
        target = path.with_name(f"{path.stem}-{ending}{path.suffix}") if ending else path
        _write(target, lambda file, table=table: write_table(file, table), written)  # type: ignore[misc]


def _write(path: Path, fill: Callable[[IO[bytes]], None], written: list[Path]) -> None:
    with whole(path) as file:
        fill(file)
    written.append(path)
