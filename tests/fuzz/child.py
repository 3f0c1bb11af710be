"""Reads mutants in a process of its own: `python -m tests.fuzz.child READER SEED FIRST END`.

Before each mutant its number is written, so that the parent knows which one a process hung or died in; then what came
of it.
"""

from __future__ import annotations

import json
import sys
import warnings

from .mutants import mutate, outcome
from .subjects import subject


def main() -> None:
    reader, seed, first, end = sys.argv[1], *map(int, sys.argv[2:5])
    warnings.simplefilter("ignore")
    made = subject(reader)
    whole = made.read(made.files)
    for number in range(first, end):
        files, count, _ = mutate(made, seed, number)
        _say(str(number))
        _say(json.dumps(outcome(made, whole, files, count)))


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
