"""`slowdrift run CASE`: solve a case here, without a server."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from solver.case import Case
    from solver.results.part import Result

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
    parser.add_argument(
        "--out", type=Path, metavar="FILE", help="write the channels here: .nc, .csv or .parquet (docs/export.md)"
    )
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
        kind = _format(args.out) if args.out else ""
        result = _solve(case, base, quiet=args.quiet)
        summary = result.summary
        if args.json:
            write_whole(args.json, json.dumps(summary, indent=1, allow_nan=False))
        if args.out and result.channels:
            _export(args.out, kind, case, result)
    except CaseError as error:
        for item in error.errors:
            print(f"{args.case}: {item}", file=sys.stderr)
        return WRONG
    except DataError as error:
        print(f"{args.case}: {error}", file=sys.stderr)
        return WRONG
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


def _solve(case: Case, base: Path, quiet: bool) -> Result:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from solver.check import check
    from store.reading import IsolatedFiles

    source = IsolatedFiles(base)
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
        return run(case, source, lambda at: bar.update(task, completed=at.fraction, description=at.message))


def _format(path: Path) -> str:
    """The format of `--out`, known before the run starts. Raises CaseError, also where its library is missing."""
    from importlib.util import find_spec

    from solver.io.export import format_of
    from solver.io.table import NO_PARQUET
    from solver.outcome import CaseError, FieldError

    kind = format_of(path.name)
    if not path.absolute().parent.is_dir():
        raise CaseError([FieldError(("out",), f"{path} cannot be written: there is no such folder")])
    if kind == "parquet" and find_spec("pyarrow") is None:
        raise CaseError([FieldError(("out",), NO_PARQUET, path.name)])
    return kind


def _export(path: Path, kind: str, case: Case, result: Result) -> None:
    from solver.case import to_yaml
    from solver.io.export import describe, write_results
    from solver.io.selection import select_channels

    channels = {channel.name: channel for channel in result.channels}
    selection = select_channels({name: channel.dims for name, channel in channels.items()}, channels.__getitem__)
    about = describe(result.summary, to_yaml(case), case.name)
    with _whole(path) as file:
        write_results(file, kind, selection, about)


def write_whole(path: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all. Raises CaseError when it cannot be written."""
    with _whole(path) as file:
        file.write(text.encode())


@contextmanager
def _whole(path: Path) -> Iterator[IO[bytes]]:
    from solver.outcome import CaseError, FieldError

    try:
        file = tempfile.NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False)  # noqa: SIM115 (kept)
    except OSError as error:
        raise CaseError([FieldError((), f"{path} cannot be written: {error.strerror}")]) from None
    try:
        with file:
            yield file  # type: ignore[misc]
        os.replace(file.name, path)
    except OSError as error:
        raise CaseError([FieldError((), f"{path} cannot be written: {error.strerror}")]) from None
    finally:
        Path(file.name).unlink(missing_ok=True)
