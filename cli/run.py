"""`slowdrift run CASE`: solve a case here, without a server."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.files import write_whole

if TYPE_CHECKING:
    from solver.case import Case
    from solver.case.text import Reading
    from solver.outcome import FieldError
    from solver.results.part import Result
    from solver.vessel.data import DataSource

    from .results import Wanted

__all__ = ["DONE", "NOT_CONVERGED", "STOPPED", "WRONG", "write_whole"]

DONE, WRONG, NOT_CONVERGED, STOPPED = 0, 2, 3, 130
OVERRIDES = ("seeds", "duration")  # of analyses.time_domain
TIME_DOMAIN = ("analyses", "time_domain")
DESCRIPTION = """Solve a case (YAML or JSON). All faults of the case and its data are listed together, each with its line.
Ctrl-C stops the run; the analyses that are done are written. Exit status: 0 done, 2 the case is wrong, 3 an analysis did
not converge, 130 stopped by Ctrl-C."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `run` command."""
    parser = subparsers.add_parser(
        "run", help="solve a case on this machine, without a server", description=DESCRIPTION
    )
    parser.add_argument("case", type=Path, help="the case file; hydrodynamic data are found relative to it")
    parser.add_argument("--json", type=Path, metavar="OUT", help="write the summary here (docs/summary.md)")
    parser.add_argument(
        "--out", type=Path, metavar="FILE",
        help="write results here (docs/export.md). The ending tells the format: channels as .nc, .h5, .csv or .parquet, "
        "statistics tables as .xlsx",
    )  # fmt: skip
    parser.add_argument(
        "--channels", metavar="PATTERN[,PATTERN]",
        help="channels for --out: names, or patterns with *, e.g. 'time/vessel/*'; default: all (docs/summary.md lists them)",
    )  # fmt: skip
    parser.add_argument(
        "--layout", choices=("long", "wide"), default="long",
        help="of a CSV file: a row for each value (long, the default), or the axis and then a column for each channel and "
        "seed (wide; a file for each set of axes, e.g. results-time.csv)",
    )  # fmt: skip
    parser.add_argument("--only", metavar="NAMES", help="analyses to run, e.g. frequency_domain,modes")
    parser.add_argument("--seeds", type=int, metavar="N", help="number of time-domain realisations")
    parser.add_argument("--duration", type=float, metavar="S", help="kept duration of the time domain [s]")
    parser.add_argument("--quiet", action="store_true", help="no table, no progress and no list of files")
    parser.set_defaults(func=command)


def command(args: argparse.Namespace) -> int:
    """Run the command; prints errors as sentences and returns the exit status."""
    from solver.outcome import CaseError, DataError

    written: list[Path] = []
    try:
        return _command(args, written)
    except CaseError as error:
        for item in error.errors:
            print(f"{args.case}: {item}", file=sys.stderr)
        return WRONG
    except DataError as error:
        print(f"{args.case}: {error}", file=sys.stderr)
        return WRONG
    except KeyboardInterrupt:
        print(f"interrupted; {_listed(written)}", file=sys.stderr)
        return STOPPED


def _command(args: argparse.Namespace, written: list[Path]) -> int:
    from rich.console import Console

    from .results import write_results
    from .solve import solve

    case, wanted, source, doubts = _checked(args)
    outcome = solve(case, source, doubts, Console(stderr=True), args.quiet)
    notes: list[str] = []
    if outcome.result is not None:
        if args.json:
            write_whole(args.json, json.dumps(outcome.result.summary, indent=1, allow_nan=False))
            written.append(args.json)
        if wanted is not None:
            notes = write_results(wanted, case, outcome.result, written)
    if outcome.interrupted:
        print(_interrupted(case, outcome.result, written), file=sys.stderr)
        if outcome.hung:
            _leave(STOPPED)
        return STOPPED
    assert outcome.result is not None
    return _tell(args, outcome.result.summary, notes, written)


def _tell(args: argparse.Namespace, summary: dict[str, Any], notes: list[str], written: list[Path]) -> int:
    from .files import size_of
    from .table import show

    if not args.quiet:
        show(summary)
        for path in written:
            print(f"{path}: {size_of(path)}")
    for note in notes:
        print(note, file=sys.stderr)
    for analysis, reason in summary["failures"].items():
        print(f"{analysis}: {reason}", file=sys.stderr)
    return NOT_CONVERGED if summary["failures"] else DONE


def _interrupted(case: Case, result: Result | None, written: list[Path]) -> str:
    asked = case.analyses.requested()
    done = [name for name in asked if result is not None and name not in result.failures]
    left = [name for name in asked if name not in done]
    said = [f"done: {', '.join(done)}" if done else "no analysis was done"]
    if done and left:
        said.append(f"not done: {', '.join(left)}")
    return "; ".join(["interrupted", *said, _listed(written)])


def _listed(written: list[Path]) -> str:
    return f"written: {', '.join(map(str, written))}" if written else "nothing was written"


def _leave(status: int) -> None:
    """End at once: a thread that still computes would be waited for."""
    import os

    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


def _checked(args: argparse.Namespace) -> tuple[Case, Wanted | None, DataSource, list[str]]:
    """The case with the command line's changes, checked with its data, and the warnings. Raises CaseError with all faults."""
    from solver.check import examine
    from solver.outcome import CaseError
    from store.reading import IsolatedFiles

    from .results import wanted_of

    reading, errors = _read(args)
    source, wanted = IsolatedFiles(args.case.resolve().parent), None
    warnings: list[str] = []
    if reading.case is not None:
        reading.case, wrong = _only(reading.case, args.only)
        errors += wrong
        found, warnings = examine(reading.case, source)
        reading.add(found)
    if args.out is not None or args.channels is not None or args.layout != "long":
        wanted, wrong = wanted_of(args, reading.case)
        errors += wrong
    if errors:
        raise CaseError([*errors, *sorted(reading.errors, key=lambda error: error.place)])
    return reading.sound(), wanted, source, warnings


def _read(args: argparse.Namespace) -> tuple[Reading, list[FieldError]]:
    """The case file with --seeds and --duration, and the faults of these."""
    from solver.case.text import MAX_BYTES, Reading, read_document
    from solver.outcome import CaseError, FieldError

    try:
        with args.case.open("rb") as file:
            text = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise CaseError([FieldError((), f"the case file cannot be read: {error.strerror}")]) from None
    data, lines, repeated = read_document(text)
    errors: list[FieldError] = []
    analyses = data.get("analyses")
    asked = analyses.get("time_domain") if isinstance(analyses, dict) else None
    for key in OVERRIDES:
        value = getattr(args, key)
        if value is None:
            continue
        if not isinstance(asked, dict):
            errors.append(FieldError(TIME_DOMAIN, f"--{key} belongs to the time domain, not asked for"))
            continue
        asked[key] = value
        lines.pop((*TIME_DOMAIN, key), None)
    reading = Reading.of(data, lines, repeated)
    given = {(*TIME_DOMAIN, key): f"--{key}" for key in OVERRIDES if getattr(args, key) is not None}
    reading.errors = [
        FieldError((given[item.loc],), item.message, item.value) if item.loc in given else item
        for item in reading.errors
    ]
    return reading, errors


def _only(case: Case, names: str | None) -> tuple[Case, list[FieldError]]:
    """The case with the analyses that are named, and what is wrong with the names."""
    from solver.case.partial import noted

    errors: list[FieldError] = []
    if names is not None:
        from solver.run import select

        with noted(errors):
            case = select(case, tuple(name.strip() for name in names.split(",")))
    return case, errors
