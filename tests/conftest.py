"""What holds for all tests: kernels are compiled before the first; Hypothesis sets no time limit on an example, and
tries the same examples each time, so that a change is judged by itself. With SLOWDRIFT_FUZZ=N in the environment it
draws new ones, and in tests/vessel/test_wamit_fuzz.py N times as many. With SLOWDRIFT_SHUFFLE=SEED the tests run in an
order that the seed fixes. Each test begins with the log's level at WARNING, whatever libraries have set before.
"""

import logging
import os
import subprocess
import sys

import pytest
from hypothesis import settings

from tests.shuffle import VARIABLE, shuffled

settings.register_profile("untimed", deadline=None, derandomize="SLOWDRIFT_FUZZ" not in os.environ)
settings.load_profile("untimed")

KERNELS_READY = "SLOWDRIFT_KERNELS_READY"  # set by a program that has filled the cache itself
WARM = "from solver.run import warm_up, warm_up_time_domain; print(f'{warm_up() + warm_up_time_domain():.0f}')"


def pytest_sessionstart(session: pytest.Session) -> None:
    """Fill the cache of compiled kernels once, so that no test or service under test waits for a compiler."""
    if hasattr(session.config, "workerinput") or session.config.option.collectonly or KERNELS_READY in os.environ:
        return
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(session.config.rootpath), os.environ.get("PYTHONPATH", "")]),
    }
    done = subprocess.run([sys.executable, "-c", WARM], capture_output=True, text=True, env=environment, check=True)
    print(f"kernels ready in {done.stdout.strip()} s (a first run compiles them)")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Shuffle modules, and the tests of each, when a seed is given."""
    if VARIABLE in os.environ:
        items[:] = shuffled(items, lambda item: item.nodeid.split("::")[0], int(os.environ[VARIABLE]))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say the seed of the order where failures are said."""
    if VARIABLE in os.environ:
        terminalreporter.write_line(f"order of the tests: {VARIABLE}={os.environ[VARIABLE]}")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup() -> None:
    """Put the level of the whole process's log back: Capytaine, and our own programs, set it."""
    logging.getLogger().setLevel(logging.WARNING)
    logging.disable(logging.NOTSET)
