"""`slowdrift run CASE`: solve a case here, without a server."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from solver.case import Case

DONE, WRONG, NOT_CONVERGED = 0, 2, 3


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `run` command."""
    parser = subparsers.add_parser(
        "run",
        help="solve a case on this machine, without a server",
        description="Solve a case (YAML or JSON). Exit status: 0 done, 2 the case is wrong, 3 an analysis did not converge.",
    )
    parser.add_argument("case", type=Path, help="the case file; hydrodynamic data are found relative to it")
    parser.add_argument("--json", type=Path, metavar="OUT", help="write the summary here (docs/summary.md)")
    parser.add_argument("--only", metavar="NAMES", help="analyses to run, e.g. frequency_domain,modes")
    parser.add_argument("--seeds", type=int, metavar="N", help="number of time-domain realisations")
    parser.add_argument("--duration", type=float, metavar="S", help="kept duration of the time domain [s]")
    parser.add_argument("--quiet", action="store_true", help="no table and no progress")
    parser.set_defaults(func=command)


def command(args: argparse.Namespace) -> int:
    """Run the command; prints errors as sentences and returns the exit status."""
    from solver.outcome import CaseError, DataError

    try:
        case, base = load(args)
        summary = _solve(case, base, quiet=args.quiet)
    except CaseError as error:
        for item in error.errors:
            print(f"{args.case}: {item}", file=sys.stderr)
        return WRONG
    except DataError as error:
        print(f"{args.case}: {error}", file=sys.stderr)
        return WRONG
    if args.json:
        write_whole(args.json, json.dumps(summary, indent=1, allow_nan=False))
    if not args.quiet:
        from cli.table import show

        show(summary)
    for analysis, reason in summary["failures"].items():
        print(f"{analysis}: {reason}", file=sys.stderr)
    return NOT_CONVERGED if summary["failures"] else DONE


def load(args: argparse.Namespace) -> tuple[Case, Path]:
    """The case with the command line's overrides, and the folder its data are relative to."""
    from solver.case import load_case, parse_case
    from solver.case.text import MAX_BYTES
    from solver.outcome import CaseError, FieldError

    try:
        with args.case.open("rb") as file:
            text = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise CaseError([FieldError((), f"the case file cannot be read: {error.strerror}")]) from None
    case = load_case(text)
    overrides: dict[str, Any] = {}
    for key in ("seeds", "duration"):
        value = getattr(args, key)
        if value is not None:
            if case.analyses.time_domain is None:
                raise CaseError(
                    [FieldError(("analyses", "time_domain"), f"--{key} belongs to the time domain, not asked for")]
                )
            overrides[key] = value
    if overrides:
        data = json.loads(case.canonical())
        data["analyses"]["time_domain"].update(overrides)
        case = parse_case(data)
    if args.only is not None:
        from solver.run import select

        case = select(case, tuple(name.strip() for name in args.only.split(",")))
    return case, args.case.resolve().parent


def _solve(case: Case, base: Path, quiet: bool) -> dict[str, Any]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from solver.check import check
    from solver.vessel.data import FileSource

    source = FileSource(base)
    check(case, source)
    console = Console(stderr=True)
    if not quiet and console.is_terminal:
        console.print("[dim]starting the solver (the first start compiles it, about a minute) …[/dim]")
    from solver.run import run

    columns = (
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=console, disable=quiet or not console.is_terminal, transient=True) as bar:
        task = bar.add_task("starting", total=1.0)
        result = run(case, source, lambda at: bar.update(task, completed=at.fraction, description=at.message))
    return result.summary


def write_whole(path: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all. Raises CaseError when it cannot be written."""
    from solver.outcome import CaseError, FieldError

    try:
        with tempfile.NamedTemporaryFile("w", dir=path.parent, prefix=f".{path.name}.", delete=False) as file:
            file.write(text)
        os.replace(file.name, path)
    except OSError as error:
        raise CaseError([FieldError((), f"{path} cannot be written: {error.strerror}")]) from None
