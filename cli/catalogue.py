"""`slowdrift catalogue`: kinds of chain and rope, and what they weigh, stand and carry at a diameter."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from typing import Any

from cli.run import DONE, WRONG


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add the `catalogue` command."""
    parser = subparsers.add_parser(
        "catalogue",
        help="chain, wire and fibre ropes for line_types: list them, or print one with the source of every number",
        description="Without a name: the list. With a name and a diameter: its values. Exit status: 0 done, 2 a wrong name, "
        "diameter or stiffness.",
    )
    parser.add_argument("name", nargs="?", metavar="NAME", help="an entry, such as chain-R4-studless")
    parser.add_argument("--diameter", metavar="D", help='nominal diameter: a number in m, or with a unit: "120 mm"')
    parser.add_argument("--stiffness", metavar="BY", help="which EA of a chain: e301 (default) or orcaflex")
    parser.add_argument(
        "--density", default="1025", metavar="RHO", help="water density for the weight in water [kg/m3]"
    )
    parser.add_argument("--json", action="store_true", help="print it as JSON")
    parser.set_defaults(func=command)


def command(args: argparse.Namespace) -> int:
    """Run the command; prints errors as sentences and returns the exit status."""
    from solver.case.catalogue_entries import describe, list_entries
    from solver.outcome import CaseError

    try:
        if args.name is None:
            _show_list(list_entries(), args.json)
        else:
            _show_entry(describe(args.name, args.diameter, args.stiffness, args.density), args.json)
    except CaseError as error:
        for item in error.errors:
            print(f"slowdrift catalogue: {item}", file=sys.stderr)
        return WRONG
    return DONE


def _show_list(found: list[dict[str, Any]], as_json: bool) -> None:
    if as_json:
        print(json.dumps(found, indent=1, ensure_ascii=False))
        return
    width = max(len(item["name"]) for item in found)
    for item in found:
        low, high = (1e3 * value for value in item["diameter_range"])
        doubtful = f" (unverified: {', '.join(item['unverified'])})" if item["unverified"] else ""
        print(f"{item['name']:{width}}  {f'{low:g} to {high:g} mm':14}  {item['title']}{doubtful}")


def _show_entry(found: dict[str, Any], as_json: bool) -> None:
    if as_json:
        print(json.dumps(found, indent=1, ensure_ascii=False))
        return
    if "values" not in found:
        _show_list([found], False)
        print('give --diameter, such as --diameter "120 mm", for its values')
        return
    print(f"{found['name']}: {found['title']}, {1e3 * found['diameter']:g} mm")
    if found["stiffness"]:
        print(f"  EA by {found['stiffness']}")
    print(f"  weight in water {found['weight_in_water']:.6g} N/m at {found['water_density']:g} kg/m3")
    for line in value_lines(found["values"]):
        print(f"  {line}")


def value_lines(values: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Values of the catalogue as lines of text, their sources numbered below."""
    sources = list(dict.fromkeys(value["source"] for value in values.values()))
    lines = []
    for key, value in values.items():
        shown = f"{value['value']:.6g} {value['unit']}"
        mark = f"{value['status']} [{sources.index(value['source']) + 1}]"
        lines.append(f"{key:22}{shown:18}{mark:16}{value['formula']}".rstrip())
    return [*lines, *(f"[{number}] {source}" for number, source in enumerate(sources, 1))]
