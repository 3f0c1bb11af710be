"""`slowdrift bem SPEC`: hydrodynamic data of a hull by boundary elements, here, without a server."""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from solver.bem.job import Made

DONE, WRONG, STOPPED = 0, 2, 130


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = subparsers.add_parser(
        "bem",
        help="compute hydrodynamic data of a hull, without a server",
        description="Added mass, damping, wave excitation and mean drift of a hull (docs/hydrodynamics-bem.md), as a "
        "NetCDF file that cases refer to. Exit status: 0 done, 2 the job is wrong.",
    )
    parser.add_argument("job", type=Path, help="the job (YAML or JSON); a mesh is found relative to it")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the NetCDF file; left out: only check the mesh")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write quality, estimate and energy balance here")
    parser.add_argument("--memory", type=float, default=3000.0, metavar="MB", help="refuse more (default: %(default)g)")
    parser.add_argument("--quiet", action="store_true", help="no progress and no report")
    parser.set_defaults(func=command)


def command(args: argparse.Namespace) -> int:
    """Run the command; prints errors as sentences and returns the exit status."""
    from solver.outcome import CaseError, DataError

    try:
        made = _made(args)
        if made is not None:
            if args.json:
                _write(args.json, json.dumps(made.summary, indent=1, allow_nan=False).encode())
            _write(args.out, made.payload)
    except CaseError as error:
        for item in error.errors:
            print(f"{args.job}: {item}", file=sys.stderr)
        return WRONG
    except DataError as error:
        print(f"{args.job}: {error}", file=sys.stderr)
        return WRONG
    except KeyboardInterrupt:
        print("stopped; nothing was written", file=sys.stderr)
        return STOPPED
    return DONE


def _made(args: argparse.Namespace) -> Made | None:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from solver.bem import load_job
    from solver.bem.job import check, compute, estimate, wet
    from solver.bem.quality import doubts, measures
    from store.reading import read_hull

    job = load_job(_read(args.job))
    reference = job.geometry.mesh
    hull = read_hull(job, None if reference is None else (_read(args.job.parent / reference), Path(reference).name))
    shape = wet(job, hull)
    check(job, hull, shape, args.memory)
    said = [doubt.message for doubt in doubts(hull, job, measures(hull, job))]
    if not args.quiet:
        found, needed = measures(hull, job), estimate(job, shape)
        print(
            f"{found['panels']} panels, {found['volume']:.6g} m3 displaced, draught {found['draught']:g} m; about "
            f"{needed.memory_mb:.0f} MB and {needed.seconds / 60:.2g} min"
        )
        for message in said:
            print(f"warning: {message}")
    if args.out is None:
        return None
    console = Console(stderr=True)
    columns = (
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=console, disable=args.quiet or not console.is_terminal, transient=True) as bar:
        task = bar.add_task("starting", total=1.0)
        made = compute(job, hull, None, lambda at: bar.update(task, completed=at.fraction, description=at.message))
    if not args.quiet:
        for warning in made.warnings:
            if warning not in said:
                print(f"warning: {warning}")
    return made


def _read(path: Path) -> bytes:
    from solver.bem.read import MAX_BYTES
    from solver.outcome import DataError

    try:
        with path.open("rb") as file:
            return file.read(MAX_BYTES + 1)
    except OSError as error:
        raise DataError(f"{path} cannot be read: {error.strerror}") from None


def _write(path: Path, content: bytes) -> None:
    """A file that is there whole or not at all."""
    from solver.outcome import DataError

    try:
        with tempfile.NamedTemporaryFile("wb", dir=path.parent, prefix=f".{path.name}.", delete=False) as file:
            file.write(content)
        os.replace(file.name, path)
    except OSError as error:
        raise DataError(f"{path} cannot be written: {error.strerror}") from None
