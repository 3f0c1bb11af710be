"""`slowdrift moordyn read DECK` and `slowdrift moordyn write CASE`: mooring decks to cases and back (docs/moordyn.md)."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from cli.run import DONE, NOT_CONVERGED, WRONG, write_whole

if TYPE_CHECKING:
    from solver.case import Case
    from solver.io.moordyn import Placed, Report


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `moordyn` command."""
    parser = subparsers.add_parser(
        "moordyn",
        help="read a MoorDyn deck into a case, or write one from a case",
        description="Exit status: 0 done, 2 the deck or the case is wrong, 3 statics found no place for an anchor.",
    )
    ways = parser.add_subparsers(dest="way", metavar="read|write", required=True)
    read = ways.add_parser("read", help="a deck (v1 or v2) to a case in YAML")
    read.add_argument("source", type=Path, metavar="DECK")
    held = read.add_mutually_exclusive_group()
    held.add_argument("--vessel", type=Path, metavar="CASE", help="a case whose vessel, sea and analyses are kept")
    held.add_argument(
        "--pinned", action="store_true", help="hold vessel points where they are: a case without a vessel, which runs"
    )
    read.set_defaults(func=_read)
    write = ways.add_parser("write", help="a case to a deck (v2)")
    write.add_argument("source", type=Path, metavar="CASE")
    write.set_defaults(func=_write)
    for way in (read, write):
        way.add_argument(
            "-o", "--output", type=Path, metavar="FILE", help="where to write it; without it, standard output"
        )


def _read(args: argparse.Namespace) -> int:
    from solver.io.moordyn.deck import MAX_BYTES
    from solver.outcome import CaseError
    from store.reading import read_deck

    try:
        base = _content(args.vessel, MAX_BYTES) if args.vessel else None
        found = read_deck(_content(args.source, MAX_BYTES), base, pinned=args.pinned)
        _put(args.output, found["yaml"])
    except CaseError as error:
        return _wrong(args.source, error)
    print(found["comment"], end="", file=sys.stderr)
    for fault in found["errors"]:
        print(f"to be filled in: {fault}", file=sys.stderr)
    return DONE


def _write(args: argparse.Namespace) -> int:
    from solver.case import load_case
    from solver.case.text import MAX_BYTES
    from solver.io.moordyn import write_deck
    from solver.outcome import CaseError, DataError, NotConverged

    try:
        case = load_case(_content(args.source, MAX_BYTES))
        written = write_deck(case, _placed(case, args.source.resolve().parent))
        _put(args.output, written.text)
    except CaseError as error:
        return _wrong(args.source, error)
    except DataError as error:
        print(f"{args.source}: {error}", file=sys.stderr)
        return WRONG
    except NotConverged as error:
        print(f"statics: {error}", file=sys.stderr)
        return NOT_CONVERGED
    _tell(written.report)
    return DONE


def _placed(case: Case, base: Path) -> Mapping[str, Placed] | None:
    """Statics, where an anchor or a length follows from a pretension."""
    anchors = [end.anchor for line in case.lines.values() for end in (line.end_a, line.end_b) if end.anchor is not None]
    if all(anchor.pretension is None for anchor in anchors):
        return None
    from solver.io.moordyn import Placed
    from solver.outcome import NotConverged
    from solver.run import run, select
    from store.reading import IsolatedFiles

    summary = run(select(case, ("statics",)), IsolatedFiles(base)).summary
    if "statics" not in summary:
        raise NotConverged("statics", summary["failures"]["statics"], "")
    return Placed.of(summary)


def _content(path: Path, most: int) -> bytes:
    from solver.outcome import CaseError, FieldError

    try:
        with path.open("rb") as file:
            return file.read(most + 1)
    except OSError as error:
        raise CaseError([FieldError((), f"{path} cannot be read: {error.strerror}")]) from None


def _put(path: Path | None, text: str) -> None:
    if path is None:
        sys.stdout.write(text)
    else:
        write_whole(path, text)


def _tell(report: Report) -> None:
    print(report.comment(""), end="", file=sys.stderr)


def _wrong(path: Path, error: Exception) -> int:
    for item in getattr(error, "errors", [error]):
        print(f"{path}: {item}", file=sys.stderr)
    return WRONG
