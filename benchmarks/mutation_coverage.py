"""Pytest plugin of benchmarks/mutation.py: notes which tests, and which fixtures, execute each line of an area.

A line that a fixture executes belongs to every test that uses the fixture, whatever its scope.
SLOWDRIFT_COVERAGE_OUT names the JSON file that is written at the end of the run.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import coverage
import pytest

ROOT = Path(__file__).parents[1]
FIXTURE = "fixture:"


class LineContexts:
    """Records the executed lines by context: a test's node id, or a fixture by name and place."""

    def __init__(self, folders: list[str]) -> None:
        self.users: dict[str, list[str]] = {}
        self.seconds: dict[str, float] = {}
        self.coverage = coverage.Coverage(
            data_file=None, source=[str(ROOT / one) for one in folders], config_file=False
        )
        self.coverage.start()
        self.stack = ["import"]

    def _switch(self, context: str) -> None:
        self.coverage.switch_context(context)

    @pytest.hookimpl(hookwrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.stack = [item.nodeid]
        self._switch(item.nodeid)
        for definitions in getattr(item, "_fixtureinfo").name2fixturedefs.values():  # noqa: B009
            self.users.setdefault(_name(definitions[-1]), []).append(item.nodeid)
        yield
        self._switch("between")

    @pytest.hookimpl(hookwrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Iterator[None]:
        self.stack.append(_name(fixturedef))
        self._switch(self.stack[-1])
        yield
        self.stack.pop()
        self._switch(self.stack[-1])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            self.seconds[report.nodeid] = float("inf")  # proves nothing about a mutant
        else:
            self.seconds[report.nodeid] = self.seconds.get(report.nodeid, 0.0) + report.duration

    def pytest_sessionfinish(self) -> None:
        self.coverage.stop()
        data = self.coverage.get_data()
        lines = {
            str(Path(file).relative_to(ROOT)): {str(n): sorted(who) for n, who in data.contexts_by_lineno(file).items()}
            for file in data.measured_files()
        }
        seconds = {name: min(value, 1e9) for name, value in self.seconds.items()}
        Path(os.environ["SLOWDRIFT_COVERAGE_OUT"]).write_text(
            json.dumps({"lines": lines, "users": self.users, "seconds": seconds})
        )


def _name(definition: Any) -> str:
    return f"{FIXTURE}{definition.baseid}::{definition.argname}"


def pytest_configure(config: pytest.Config) -> None:
    from benchmarks.mutants import AREAS

    config.pluginmanager.register(LineContexts([folder for folders in AREAS.values() for folder in folders]))
