"""`python -m tests.service.faults [--kind KIND …] [--fault WORDS …] [--runs 200] [--markdown FILE]`"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from ..conftest import KINDS
from .campaign import HEADER, campaign
from .faults import FAULTS
from .rig import MissingError


def main() -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tests.service.faults", description="Break the service in every way."
    )
    parser.add_argument("--kind", nargs="*", choices=KINDS, default=list(KINDS))
    parser.add_argument("--fault", nargs="*", help="parts of the names of faults; all when left out")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--markdown", type=Path, help="also write the table into this file")
    options = parser.parse_args()
    chosen = [name for name in FAULTS if not options.fault or any(word in name for word in options.fault)]
    lines, bad = [HEADER], 0
    print(HEADER, flush=True)
    for kind in options.kind:
        for name in chosen:
            with tempfile.TemporaryDirectory(prefix="sd-fault-", ignore_cleanup_errors=True) as root:
                try:
                    tally = campaign(kind, name, FAULTS[name], options.runs, Path(root))
                    line, bad = str(tally), bad + bool(tally.wrong)
                except MissingError as error:
                    line = f"| {kind} | {name} | - | - | - | - | - | - | not tried: {error} |"
                except Exception as error:
                    line, bad = f"| {kind} | {name} | - | - | - | - | - | - | broke down: {error!r:.300} |", bad + 1
                    keep = Path(root) / "data"
                    print(f"(logs were in {keep})", file=sys.stderr)
            lines.append(line)
            print(line, flush=True)
    if options.markdown:
        options.markdown.write_text("\n".join(lines) + f"\n\n{time.strftime('%Y-%m-%d')}, {options.runs} runs each.\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
