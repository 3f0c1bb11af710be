"""Mutation score of the quick loop: how many small faults, planted one at a time, its tests notice.

    python -m benchmarks.mutation cover --out cover.json         # once: which test executes which line (a whole quick loop)
    python -m benchmarks.mutation run --cover cover.json --out run.csv [--area store] [--sample 160] [--seed 14]
    python -m benchmarks.mutation again --area store --out run.csv --tests tests/store/test_new.py  # what survived
    python -m benchmarks.mutation score --out run.csv

A warm process that has imported the third-party libraries and everything below the area forks for every mutant. The
child plants the mutant (benchmarks/mutants.py), imports the area with it and runs the tests that execute the line, the
fastest first, until one fails. A mutant on a line without a test counts as survived. Programs that a test starts import
the mutant too. Needs the package `coverage` beside the development requirements.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path

from benchmarks.mutants import AREAS, ROOT, SKIPPED, Mutant, mutants, plant, site_folder

FIXTURE = "fixture:"
MOST_SECONDS = 45.0  # of tests for one mutant, by the time they took in `cover`
MOST_TESTS = 150
LIMIT = 100  # s of processor time: a child that takes more runs on by its mutant
WAIT = 1800.0  # s: a child that waits longer than this is held up by its mutant
THIRD_PARTY = (
    "numpy", "scipy.optimize", "scipy.linalg", "scipy.interpolate", "scipy.sparse", "numba", "pydantic", "yaml", "h5py",
    "fastapi.testclient", "sqlalchemy.orm", "alembic.command", "httpx", "celery", "hypothesis", "pytest", "xarray",
    "pwdlib", "jsonschema_rs", "h5netcdf", "rainflow", "prometheus_client", "limits",
)  # fmt: skip
BELOW = {
    "solver/results": ("solver.frequency_domain.solve", "solver.modes.solve", "solver.time_domain.ensemble"),
    "solver/frequency_domain": (
        "solver.statics.solve", "solver.model.linear", "solver.kernels.march", "solver.kernels.step", "solver.kernels.record",
        "solver.time_domain.statistics", "solver.frequency_domain.coefficients", "solver.frequency_domain.transfer",
    ),
    "store": ("solver.run",), "api": ("solver.run", "store.database", "store.repositories.runs"),
}  # fmt: skip
#: where the tests of an area stand, for mutants at the level of a module
FOLDERS = {
    "solver/results": ("tests/results", "tests/frequency_domain", "tests/docs", "tests/cli"),
    "solver/frequency_domain": ("tests/frequency_domain",),
    "store": ("tests/store", "tests/studies", "tests/access"),
    "api": ("tests/api", "tests/access", "tests/studies"),
}
COLUMNS = ("area", "file", "number", "line", "scope", "what", "tests", "before", "status", "killer", "seconds")


@dataclass
class Row:
    """One mutant and what became of it. status: killed, survived, uncovered, timeout."""

    area: str
    file: str
    number: int
    line: int
    scope: str
    what: str
    tests: int = 0
    before: str = ""  # status before tests were added
    status: str = ""
    killer: str = ""
    seconds: float = 0.0


class Coverage:
    """Tests by line, from one or more files that `cover` wrote."""

    def __init__(self, places: list[str]) -> None:
        self.lines: dict[tuple[str, int], set[str]] = {}
        self.seconds: dict[str, float] = {}
        for place in places:
            found = json.loads(Path(place).read_text())
            self.seconds.update(found["seconds"])
            for file, lines in found["lines"].items():
                for number, contexts in lines.items():
                    self.lines.setdefault((file, int(number)), set()).update(_tests(contexts, found["users"]))

    def of(self, mutant: Mutant, area: str) -> list[str]:
        """The tests to run, fastest first: of the line, or of the module where the line runs at import."""
        names = self.lines.get((mutant.file, mutant.line), set()) if mutant.scope else set()
        names = {name for name in names if self.seconds.get(name, 1e9) < 1e9}
        if mutant.scope and not names:  # a default, or a line of a statement that has no line of its own
            lines = range(mutant.body[0], mutant.body[1] + 1)
            names = set().union(*(self.lines.get((mutant.file, line), set()) for line in lines))
        if not mutant.scope:
            inside = [tests for (file, _), tests in self.lines.items() if file == mutant.file]
            names = set().union(*inside) or {t for t in self.seconds if t.startswith(FOLDERS[area])}
        chosen, total = [], 0.0
        for name in sorted(names, key=lambda one: self.seconds.get(one, 1e9)):
            total += self.seconds.get(name, 1e9)
            if len(chosen) >= MOST_TESTS or (chosen and total > MOST_SECONDS):
                break
            chosen.append(name)
        return chosen


def _tests(contexts: list[str], users: dict[str, list[str]]) -> Iterator[str]:
    for context in contexts:
        if context.startswith(FIXTURE):
            yield from users.get(context, [])
        elif "::" in context:
            yield context


def run(
    rows: list[tuple[Mutant, Row]], cover: Coverage, note: Callable[[Row], None], jobs: int, extra: list[str]
) -> None:
    """Try every mutant, `jobs` children at a time. extra : tests that are run for each, in the place of those of its line."""
    _prepare(rows[0][1].area)
    with ThreadPoolExecutor(jobs) as pool:
        for row in pool.map(lambda pair: _try(*pair, cover, extra), rows):
            note(row)


def _prepare(area: str) -> None:
    """Import what children share, and load every compiled kernel; the area and what imports it are forgotten again."""
    for name in (*THIRD_PARTY, *BELOW[area]):
        import_module(name)
    kept = set(sys.modules)
    warm = import_module("solver.warm")
    print(f"kernels ready in {warm.warm_up() + warm.warm_up_time_domain():.0f} s", flush=True)
    for name in set(sys.modules) - kept:
        if name.split(".")[0] in ("solver", "store", "api", "worker"):
            del sys.modules[name]
    skipped = tuple(file.removesuffix(".py").replace("/", ".") for file in SKIPPED)
    inside = [name for name in sys.modules if (name + ".").startswith(tuple(_dotted(area)))]
    taken = [name for name in inside if sys.modules[name].__file__ and not name.startswith(skipped)
             and Path(str(sys.modules[name].__file__)).name != "__init__.py"]  # fmt: skip
    if taken:
        raise SystemExit(f"imported before the fork, so that no mutant would reach it: {taken}")


def _dotted(area: str) -> list[str]:
    return [folder.replace("/", ".") + "." for folder in AREAS[area]]


def _try(mutant: Mutant, row: Row, cover: Coverage, extra: list[str]) -> Row:
    tests = [*([] if extra else cover.of(mutant, row.area)), *extra]
    row.tests = len(tests)
    if not tests:
        row.status = "uncovered"
        return row
    with tempfile.TemporaryDirectory(prefix="mutant-") as folder:
        row.status, row.killer, row.seconds = _wait(_child(mutant, tests, Path(folder)), Path(folder))
    return row


def _child(mutant: Mutant, tests: list[str], folder: Path) -> int:
    """Fork: the child runs the tests with the mutant planted, and leaves with pytest's status."""
    pid = os.fork()
    if pid:
        return pid
    status = 99
    try:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT + 5))
        for signum in (signal.SIGINT, signal.SIGTERM):
            signal.signal(signum, signal.SIG_DFL)
        out = os.open(folder / "out", os.O_WRONLY | os.O_CREAT)
        for descriptor in (1, 2):
            os.dup2(out, descriptor)
        os.environ["PYTHONPATH"] = os.pathsep.join([str(site_folder(folder / "site")), str(ROOT)])
        os.environ["SLOWDRIFT_KERNELS_READY"] = "1"
        plant(mutant.file, mutant.number)
        import pytest

        status = int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-p", "no:randomly", "--tb=no", "-rfE",
                                  f"--basetemp={folder / 'tmp'}", *tests]))  # fmt: skip
    except BaseException as fault:
        print(f"FAILED import - {fault!r}", flush=True)
        status = 1
    finally:
        os._exit(status)


def _wait(pid: int, folder: Path) -> tuple[str, str, float]:
    """Status, the test that failed, and the processor time that the child took."""
    deadline = time.monotonic() + WAIT
    while True:
        done, raw, used = os.wait4(pid, os.WNOHANG)
        if done:
            break
        if time.monotonic() > deadline:
            os.killpg(pid, signal.SIGKILL)
            os.wait4(pid, 0)
            return "timeout", "", float(LIMIT)
        time.sleep(0.05)
    seconds = round(used.ru_utime + used.ru_stime, 1)
    if os.WIFSIGNALED(raw) and os.WTERMSIG(raw) in (signal.SIGXCPU, signal.SIGKILL):
        return "timeout", "", seconds
    if os.waitstatus_to_exitcode(raw) == 0:
        return "survived", "", seconds
    return "killed", _first_failure(folder / "out"), seconds


def _first_failure(out: Path) -> str:
    text = out.read_text(errors="replace") if out.exists() else ""
    failed = [line.split(" - ")[0] for line in text.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0].split(" ", 1)[1] if failed else "the import, or the start of the tests"


def sampled(area: str, sample: int, seed: int) -> list[Mutant]:
    """A sample without repetition, the same for a seed and a tree."""
    every = list(mutants(area))
    return random.Random(f"{seed} {area}").sample(every, min(sample, len(every)))


def cover(out: Path, tests: list[str]) -> None:
    """Run the tests (the quick loop without any) under coverage and write lines, fixtures and times."""
    environment = {**os.environ, "SLOWDRIFT_COVERAGE_OUT": str(out), "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-m", "pytest", "-p", "benchmarks.mutation_coverage", "-p", "no:cacheprovider"]
    subprocess.run([*command, "-m", "not slow", *tests], cwd=ROOT, env=environment, check=False)


def write(place: Path, rows: list[Row]) -> None:
    with place.open("w", newline="") as file:
        table = csv.DictWriter(file, COLUMNS)
        table.writeheader()
        table.writerows(asdict(row) for row in rows)


def read(place: Path) -> list[Row]:
    if not place.exists():
        return []
    with place.open(newline="") as file:
        return [
            Row(**{**row, "number": int(row["number"]), "line": int(row["line"]), "tests": int(row["tests"]),  # type: ignore[arg-type]
                   "seconds": float(row["seconds"])}) for row in csv.DictReader(file)
        ]  # fmt: skip


def score(rows: list[Row]) -> Iterator[str]:
    """Lines of the score by area. `equivalent` is set by hand, with its reason in `killer`."""
    for area in AREAS:
        own = [row.status for row in rows if row.area == area]
        if own:
            count = {
                status: own.count(status) for status in ("killed", "timeout", "survived", "uncovered", "equivalent")
            }
            killed, all_ = count["killed"] + count["timeout"], len(own) - count["equivalent"]
            yield f"{area}: {killed} of {all_} killed, {100 * killed / all_:.1f} %; {count}"


def main() -> None:
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])  # type: ignore[union-attr]
    words.add_argument("what", choices=("cover", "run", "again", "score"))
    words.add_argument("--out", type=Path, required=True)
    words.add_argument("--cover", nargs="*", default=[])
    words.add_argument("--area", choices=tuple(AREAS))
    words.add_argument("--sample", type=int, default=160)
    words.add_argument("--seed", type=int, default=14)
    words.add_argument("--jobs", type=int, default=2)
    words.add_argument("--tests", nargs="*", default=[])
    said = words.parse_args()
    if said.what == "cover":
        cover(said.out.resolve(), said.tests)
    elif said.what == "score":
        print(*score(read(said.out)), sep="\n")
    else:
        _campaign(said)


def _campaign(said: argparse.Namespace) -> None:
    os.chdir(ROOT)
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    old = read(said.out)
    if said.what == "again":
        open_rows = [row for row in old if row.status in ("survived", "uncovered") and row.area == said.area]
        every = {(one.file, one.number): one for one in mutants(said.area)}
        pairs = [(every[row.file, row.number], row) for row in open_rows]
    else:
        known = {(row.file, row.number) for row in old}
        fresh = [one for one in sampled(said.area, said.sample, said.seed) if (one.file, one.number) not in known]
        pairs = [(one, Row(said.area, one.file, one.number, one.line, one.scope, one.what)) for one in fresh]
    if not pairs:
        return
    done: list[Row] = []

    def note(row: Row) -> None:
        done.append(row)
        print(
            f"{len(done)}/{len(pairs)} {row.status} {row.file}:{row.line} {row.what} [{row.tests}, {row.seconds} s]",
            flush=True,
        )
        write(said.out, old if said.what == "again" else old + done)

    run(pairs, Coverage(said.cover), note, said.jobs, said.tests)


if __name__ == "__main__":
    main()
