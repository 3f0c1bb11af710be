"""`slowdrift COMMAND`: each command's module is imported only when it is called, so that `run` needs no web server."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence

COMMANDS = {
    "run": ("cli.run", "run a case here, without a server"),
    "catalogue": ("cli.catalogue", "chain, wire and fibre ropes for line types, with the source of every number"),
    "moordyn": ("cli.moordyn", "read a MoorDyn deck into a case, or write one from a case"),
    "data": ("cli.data", "check hydrodynamic data, or convert between WAMIT's files and NetCDF"),
    "bem": ("cli.bem", "compute hydrodynamic data of a hull, without a server"),
    "serve": ("cli.serve", "start the service: REST, pages and workers together"),
    "worker": ("cli.worker", "start one worker, for a service on several processes or machines"),
    "demo": ("cli.demo", "start the service, run the FPSO example and show its results"),
    "user": ("cli.user", "accounts: add, list, disable, reset-password"),
    "key": ("cli.key", "API keys: add, list, revoke"),
    "queue": ("cli.queue", "what waits, what is at work, what failed and why"),
    "retention": ("cli.retention", "delete ended runs older than so many days; pinned ones stay"),
    "backup": ("cli.backup", "save the database into one file, while the service runs"),
    "restore": ("cli.restore", "put a saved database back"),
    "migrate": ("cli.migrate", "bring the database to this version's schema"),
}
HIDDEN = {"api": "cli.api"}


STOPPED = 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; its exit status, 130 where Ctrl-C ends it."""
    try:
        return _run(argv)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return STOPPED


def _run(argv: Sequence[str] | None) -> int:
    arguments = list(sys.argv[1:] if argv is None else argv)
    asked = arguments[0] if arguments else ""
    parser = argparse.ArgumentParser(
        prog="slowdrift", description="Frequency- and time-domain analysis of moored floating vessels."
    )
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (module, text) in COMMANDS.items():
        if name == asked:
            importlib.import_module(module).add_parser(commands)
        else:
            commands.add_parser(name, help=text)
    if asked in HIDDEN:
        importlib.import_module(HIDDEN[asked]).add_parser(commands)
    chosen = parser.parse_args(arguments)
    return int(chosen.func(chosen) or 0)


if __name__ == "__main__":
    sys.exit(main())
