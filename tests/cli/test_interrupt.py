"""Ctrl-C during `slowdrift run`: one line, status 130, and the analyses that are done are kept."""

from __future__ import annotations

import json
import os
import pty
import re
import select
import signal
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import IO

import pytest

from cli.main import main
from cli.solve import Outcome, Solver
from solver.case import Case, parse_case
from solver.outcome import Interrupted
from solver.results.part import Part, Progress, Result
from solver.run import INTERRUPTED, LOADING, run
from tests.service.running import ROOT, command

PATIENCE = 400.0  # seconds for a state to come, on a machine that is busy with other things
RISER = (ROOT / "examples" / "hanging-riser-case1.yaml").read_text()
LONG = "time_domain: {step: 0.05 s, build_up: 0 s, duration: 200000 s, output_step: 10 s, seeds: 64}"


def _heed_interrupts() -> None:
    """In the child: SIGINT as a terminal's programs have it, also where the tests run in the background, without it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Terminal:
    """A command whose errors and progress go to a terminal, as a person sees them."""

    def __init__(self, folder: Path, *arguments: str, **variables: str) -> None:
        self._screen, other = pty.openpty()
        env = os.environ | {"PYTHONPATH": str(ROOT), "TERM": "xterm", "COLUMNS": "200"} | variables
        self.process = subprocess.Popen(
            command(*arguments), cwd=folder, env=env, stdin=other, stdout=subprocess.PIPE, stderr=other, text=True,
            start_new_session=True, preexec_fn=_heed_interrupts,
        )  # fmt: skip
        os.close(other)
        self.shown = ""

    def read(self) -> bool:
        """Read what there is to read now; False at the end."""
        if select.select([self._screen], [], [], 0.1)[0]:
            try:
                self.shown += os.read(self._screen, 65536).decode(errors="replace")
            except OSError:  # the other side is closed
                return False
        return True

    def wait_for(self, text: str, also: Callable[[], bool] = lambda: True) -> None:
        self._until(lambda: text in self.shown and also(), f"{text!r} was not shown")

    def _until(self, there: Callable[[], bool], otherwise: str) -> None:
        deadline = time.monotonic() + PATIENCE
        while not there():
            assert self.process.poll() is None, self.shown
            assert time.monotonic() < deadline, f"{otherwise}:\n{self.shown}"
            self.read()

    def interrupt(self) -> tuple[int, list[str]]:
        """Send SIGINT; the exit status, and the lines that stay on the terminal."""
        before = len(self.shown)
        self.process.send_signal(signal.SIGINT)
        deadline = time.monotonic() + PATIENCE
        while self.read():
            assert time.monotonic() < deadline, f"still running after SIGINT:\n{self.shown}"
        status = self.process.wait(PATIENCE)
        assert self.process.stdout is not None
        assert self.process.stdout.read() == ""
        self.process.stdout.close()
        os.close(self._screen)
        plain = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", self.shown[before:])
        lines = [line.split("\r")[-1].strip() for line in plain.replace("\r\n", "\n").split("\n")]
        return status, [line for line in lines if line]


def _case(folder: Path, analyses: str) -> Path:
    path = folder / "case.yaml"
    path.write_text(RISER[: RISER.index("analyses:")] + f"analyses:\n{analyses}")
    return path


def _only_line(lines: list[str]) -> str:
    said = [line for line in lines if "%" not in line]  # the bar is drawn again until it goes
    assert len(said) == 1, lines
    return said[0]


@pytest.mark.slow
def test_what_is_done_is_written_when_the_march_is_interrupted(tmp_path: Path) -> None:
    case = _case(tmp_path, f"  statics: {{}}\n  frequency_domain: {{}}\n  {LONG}\n")
    terminal = Terminal(tmp_path, "run", case.name, "--json", "s.json", "--out", "r.nc")
    terminal.wait_for("time domain, 64 seeds")
    status, lines = terminal.interrupt()
    assert status == 130
    assert _only_line(lines) == (
        "interrupted; done: statics, frequency_domain; not done: time_domain; written: s.json, r.nc"
    )
    summary = json.loads((tmp_path / "s.json").read_text())
    assert summary["failures"] == {"time_domain": INTERRUPTED}
    assert summary["statics"]["converged"]
    assert summary["frequency_domain"]["converged"]
    assert "time_domain" not in summary
    assert summary["provenance"]["seeds"] == list(range(1, 65))
    import h5py

    with h5py.File(tmp_path / "r.nc") as file:
        assert file["frequency/line/riser/tension_amplitude"].shape == (68,)
        assert "time" not in file
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.yaml", "r.nc", "s.json"]


@pytest.mark.slow
def test_kernels_that_are_being_compiled_are_not_waited_for(tmp_path: Path) -> None:
    case, cache, former = _case(tmp_path, "  statics: {}\n"), tmp_path / "cache", tmp_path / "s.json"
    former.write_text("{}")
    terminal = Terminal(tmp_path, "run", case.name, "--json", "s.json", NUMBA_CACHE_DIR=str(cache))
    terminal.wait_for("loading compiled kernels", lambda: any(cache.rglob("*.nbc")))
    status, lines = terminal.interrupt()
    assert status == 130
    assert _only_line(lines) == "interrupted; no analysis was done; nothing was written"
    assert former.read_text() == "{}"


@pytest.mark.slow
def test_the_start_can_be_interrupted(tmp_path: Path) -> None:
    case = _case(tmp_path, "  statics: {}\n")
    terminal = Terminal(tmp_path, "run", case.name, "--json", "s.json")
    terminal.wait_for("loading the solver")
    status, lines = terminal.interrupt()
    assert status == 130
    assert _only_line(lines) == "interrupted; no analysis was done; nothing was written"
    assert not (tmp_path / "s.json").exists()


def _parsed(analyses: str) -> Case:
    import yaml

    return parse_case(yaml.safe_load(RISER[: RISER.index("analyses:")]) | {"analyses": yaml.safe_load(analyses)})


@pytest.mark.slow
def test_the_threads_of_the_march_stop() -> None:
    solver = Solver(_parsed(f"{{statics: {{}}, {LONG}}}"), None, ["a doubt"])  # type: ignore[arg-type]
    solver.start()
    while solver.progress is None or not solver.progress.message.startswith("time domain"):
        assert not solver.wait(0.05)
    outcome = solver.stop()
    assert outcome.interrupted
    assert not outcome.hung
    assert outcome.result is not None
    assert outcome.result.failures == {"time_domain": INTERRUPTED}
    assert outcome.result.summary["statics"]["converged"]
    assert not [thread for thread in threading.enumerate() if "ThreadPoolExecutor" in thread.name]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("at", "left"),
    [("frequency domain, iteration", ["frequency_domain", "modes"]), ("modes", ["modes"]), ("collecting", [])],
)
def test_analyses_of_one_chunk_are_kept_one_by_one(at: str, left: list[str]) -> None:
    def tell(progress: Progress) -> None:
        if progress.message.startswith(at):
            raise Interrupted

    result = run(_parsed("{statics: {}, frequency_domain: {}, modes: {}}"), None, tell)
    assert result.failures == dict.fromkeys(left, INTERRUPTED)
    for name in {"statics", "frequency_domain", "modes"} - set(left):
        assert result.summary[name]


def test_a_part_that_is_done_is_not_lost_at_its_last_word(monkeypatch: pytest.MonkeyPatch) -> None:
    def chunk(case: Case, data: object, chunk: object, checkpoint: object, tell: Callable, threads: int) -> Part:
        tell(Progress(1.0, "done"))
        return Part({"statics": {"converged": True}})

    def tell(progress: Progress) -> None:
        raise Interrupted

    monkeypatch.setattr("solver.run.run_chunk", chunk)
    assert run(_parsed("{statics: {}}"), None, tell).failures == {}


def test_a_solver_that_does_not_look_is_left_behind_with_what_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    busy, end = threading.Event(), threading.Event()

    def never_looks(case: Case, source: object, tell: Callable, parts: list[Part]) -> None:
        parts.append(Part({"case": case.name, "statics": {"converged": True}}))
        tell(Progress(0.5, LOADING))
        busy.set()
        end.wait()

    monkeypatch.setattr("solver.run.run", never_looks)
    solver = Solver(_parsed(f"{{statics: {{}}, {LONG}}}"), None, ["a doubt"])  # type: ignore[arg-type]
    solver.start()
    assert busy.wait(PATIENCE)
    outcome: Outcome = solver.stop()
    end.set()
    assert outcome.hung
    assert outcome.result is not None
    assert outcome.result.summary["warnings"] == ["a doubt"]
    assert outcome.result.failures == {"time_domain": INTERRUPTED}


def test_a_file_that_is_being_written_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    result = Result({"case": "x", "statics": {}, "warnings": [], "failures": {}}, ())

    def interrupted(target: IO[bytes], *_: object) -> None:
        target.write(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr("cli.solve.solve", lambda *_: Outcome(result))
    monkeypatch.setattr("solver.io.workbook.write_workbook", interrupted)
    case, out, former = _case(tmp_path, "  statics: {}\n"), tmp_path / "r.xlsx", tmp_path / "s.json"
    out.write_text("before")
    assert main(["run", str(case), "--json", str(former), "--out", str(out)]) == 130
    assert capsys.readouterr().err == f"interrupted; written: {former}\n"
    assert out.read_text() == "before"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.yaml", "r.xlsx", "s.json"]


def test_any_other_command_ends_in_a_word(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    def interrupted(_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("cli.data._check", interrupted)
    assert main(["data", "check", "x"]) == 130
    assert capsys.readouterr().err == "interrupted\n"
