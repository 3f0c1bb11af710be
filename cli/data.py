"""`slowdrift data check` and `slowdrift data convert`: hydrodynamic data outside of a case (docs/hydrodynamics.md)."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cli.run import DONE, WRONG

if TYPE_CHECKING:
    from solver.case.vessel import WamitFiles
    from solver.vessel.data import HydrodynamicData

DOUBTFUL = 1
QUANTITIES = ("length", "density", "gravity", "depth")
CHOICES = {
    "values": ("nondimensional", "dimensional"),
    "first-column": ("auto", "periods", "frequencies"),
    "pair-columns": ("auto", "periods", "frequencies"),
    "pair-order": ("first-minus-second", "second-minus-first"),
    "drift": ("auto", ".8", ".9"),
}


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `data` command."""
    parser = subparsers.add_parser(
        "data",
        help="check hydrodynamic data, or convert between WAMIT's files and NetCDF",
        description="Exit status: 0 done, 1 a quality check warns, 2 the data are wrong.",
    )
    ways = parser.add_subparsers(dest="way", metavar="check|convert", required=True)
    check = ways.add_parser("check", help="say what the data hold and whether they can be right")
    check.add_argument(
        "source", type=Path, metavar="DATA", help="NetCDF, ZIP, or a stem, file or folder of a WAMIT set"
    )
    check.add_argument("--json", action="store_true", help="print it as JSON")
    check.set_defaults(func=_check)
    convert = ways.add_parser("convert", help="write the data as NetCDF (.nc), or as WAMIT's files (OUT.1, OUT.3, …)")
    convert.add_argument("source", type=Path, metavar="DATA")
    convert.add_argument("target", type=Path, metavar="OUT", help="FILE.nc, FILE.zip (a WAMIT set), or a stem")
    convert.add_argument("--to-length", type=float, metavar="M", help="ULEN of the files to write [m]")
    convert.set_defaults(func=_convert)
    for way in (check, convert):
        of_files = way.add_argument_group("what WAMIT's files do not say of themselves")
        for name in QUANTITIES:
            of_files.add_argument(f"--{name}", metavar="X", help="a number in SI, or with a unit")
        of_files.add_argument("--centre-of-mass", metavar="X,Y,Z", help="that the .hst contains [m]")
        for name, allowed in CHOICES.items():
            of_files.add_argument(f"--{name}", choices=allowed)


def _opened(args: argparse.Namespace) -> HydrodynamicData:
    from store.reading import IsolatedFiles

    return IsolatedFiles(Path.cwd()).open(str(args.source), _conventions(args))


def _conventions(args: argparse.Namespace) -> WamitFiles | None:
    from pydantic import ValidationError

    from solver.case.vessel import WamitFiles
    from solver.outcome import DataError

    given: dict[str, Any] = {}
    for name in (*QUANTITIES, *CHOICES):
        value = getattr(args, name.replace("-", "_"))
        if value is not None:
            given[name.replace("-", "_")] = _number(value) if name in QUANTITIES else value
    if args.centre_of_mass is not None:
        given["centre_of_mass"] = [_number(part.strip()) for part in args.centre_of_mass.split(",")]
    try:
        return WamitFiles.model_validate(given) if given else None
    except ValidationError as error:
        fault = error.errors()[0]
        option = str(fault["loc"][0]).replace("_", "-")
        raise DataError(f"--{option}: {fault['msg'].removeprefix('Value error, ')}") from None


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _check(args: argparse.Namespace) -> int:
    from solver.outcome import DataError
    from solver.vessel.quality import quality

    try:
        data = _opened(args)
    except DataError as error:
        return _wrong(error)
    checks = quality(data)
    if args.json:
        told = data.describe() | {"checks": [check.as_dict() for check in checks]}
        print(json.dumps(told, indent=1, ensure_ascii=False, allow_nan=False))
    else:
        _show(data)
        for check in checks:
            print(f"{check.state:8} {check.name:20} {check.message}")
    return DOUBTFUL if any(check.state == "warning" for check in checks) else DONE


def _show(data: HydrodynamicData) -> None:
    told = data.describe()
    frequencies, headings = told["frequencies"], told["headings_deg"]
    limits = [name for name in ("zero", "infinite") if told[f"has_{name}_frequency"]]
    print(f"{told['name']}: {frequencies['count']} frequencies, {frequencies['from']:.4g} to {frequencies['to']:.4g} rad/s"
          f"{' and ' + ' and '.join(limits) if limits else ''}; {len(headings)} headings, {headings[0]:g} to "
          f"{headings[-1]:g} deg")  # fmt: skip
    depth = "infinite" if told["depth"] is None else f"{told['depth']:g} m"
    print(f"water {told['density']:g} kg/m3, g {told['gravity']:g} m/s2, depth {depth}")
    beside = [name.replace("_", " ") for name in ("mean_drift", "qtf", "hydrostatic_stiffness") if told[name]]
    print(f"with {', '.join(beside) or 'neither mean drift, QTF nor hydrostatics'}")
    for text in told["provenance"].get("assumed", []):
        print(f"assumed  {text}")
    for text in told["warnings"]:
        print(f"warning  {text}")


def _convert(args: argparse.Namespace) -> int:
    from solver.outcome import DataError
    from solver.vessel.data.bundle import pack
    from solver.vessel.data.layout import dump_netcdf
    from solver.vessel.data.wamit import conventions_of, write_wamit

    try:
        data = _opened(args)
        if args.target.suffix == ".nc":
            made = {args.target: dump_netcdf(data)}
        else:
            stem = args.target.stem if args.target.suffix == ".zip" else args.target.name
            files, options = write_wamit(data, stem, args.to_length), conventions_of(data, args.to_length)
            if args.target.suffix == ".zip":
                made = {args.target: pack(files, options)}
            else:
                made = {args.target.parent / name: payload for name, payload in files.items()}
        for path, payload in made.items():
            _write(path, payload)
    except DataError as error:
        return _wrong(error)
    print(f"written: {', '.join(str(path) for path in made)}")
    if args.target.suffix != ".nc":
        told = ", ".join(f"{key} {value}" for key, value in options.model_dump(exclude_defaults=True).items())
        point = "unknown" if not data.reference_known else ", ".join(f"{value:g}" for value in data.reference_point)
        print(f"conventions: {told}; reference point {point}")
    return DONE


def _write(path: Path, payload: bytes) -> None:
    """A file that is there whole or not at all. Raises DataError."""
    from solver.outcome import DataError

    part = path.with_name(f".{path.name}.part")
    try:
        part.write_bytes(payload)
        part.replace(path)
    except OSError as error:
        raise DataError(f"{path} cannot be written: {error.strerror}") from None


def _wrong(error: Exception) -> int:
    print(str(error), file=sys.stderr)
    return WRONG
