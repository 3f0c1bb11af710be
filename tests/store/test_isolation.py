"""Functions called in a child process: values go there and back whole, limits hold, whatever happens to the child."""

from __future__ import annotations

import io
import json
import os
import re
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from solver.outcome import CaseError, DataError, FieldError
from solver.vessel.data import HydrodynamicData
from solver.vessel.data import read_bytes as read_here
from store import reading
from store.errors import UnavailableError
from store.isolation import Limits, Stopped, call, calls, plain, stream, warm_up
from tests.vessel import wamit_sets

ROOT = Path(__file__).resolve().parents[2]
BARGE = ROOT / "examples" / "barge-240x46x10.nc"
SHORT = Limits(cpu_seconds=1, wall_seconds=30, memory_bytes=200 * 2**20, answer_bytes=10 * 2**20)
HERE = "tests.store.test_isolation"


@pytest.fixture(params=["forked here", "through a template"])
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Both ways a call can go: from a process of one thread, and from one of several."""
    here = request.param == "forked here"
    monkeypatch.setattr(calls, "_single_threaded", lambda: here)
    return str(request.param)


# functions that are called in the child


def loops_in_c() -> bool | None:
    return re.match(r"(a+)+$", "a" * 60 + "b") is None


def sleeps() -> None:
    time.sleep(120)


def eats_memory() -> int:
    return len([bytearray(10 * 2**20) for _ in range(1000)])


def writes_much() -> Iterator[bytes]:
    for _ in range(20):
        yield bytes(2**20)


def dies(number: int) -> None:
    os.kill(os.getpid(), number)


def has_a_fault() -> None:
    raise CaseError([FieldError(("lines", 0), "is wrong", "7", 3)])


def open_files() -> list[str]:
    names = [f"/proc/self/fd/{number}" for number in range(200)]
    return [os.readlink(name) for name in names if os.path.lexists(name)]


def later_fault() -> Iterator[int]:
    yield 1
    raise DataError("the second value is wrong")


def attached_content(file: Any, more: str) -> str:
    return file.read().decode() + more


def echo(value: Any) -> Any:
    return value


def same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if type(one).__name__ in plain.TYPES:
        return all(same(getattr(one, field.name), getattr(other, field.name)) for field in fields(one))
    return type(one) is type(other) and one == other


def test_values_arrive_whole(way: str) -> None:
    value = {
        "a": [1, 2.5, None, True, "ü\ud800", float("inf")],
        "b": (b"\0\1", bytes(0)),
        ("x", 1): np.arange(6, dtype="<f4").reshape(2, 3),
        "$": np.array([1 + 2j]),
        "0-d": np.array(3.0),
    }
    assert same(call(f"{HERE}:echo", value), value)


def test_hydrodynamic_data_arrive_whole(way: str) -> None:
    payload = BARGE.read_bytes()
    assert same(reading.read_bytes(payload, BARGE.name), read_here(payload, BARGE.name))


def test_a_qtf_of_pairs_of_headings_arrives_whole() -> None:
    data = wamit_sets.whole()
    assert data.qtf is not None
    assert same(call(f"{HERE}:echo", data), data)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("function", "arguments", "limits", "cause", "said"),
    [
        ("loops_in_c", (), SHORT, "time", "did not end within 1 s"),
        ("sleeps", (), Limits(cpu_seconds=60, wall_seconds=0.5), "time", "did not end"),
        ("eats_memory", (), SHORT, "memory", "more than 200 MB"),
        ("writes_much", (), SHORT, "memory", "more than 10 MB"),
        ("dies", (signal.SIGKILL,), SHORT, "died", "SIGKILL"),
        ("dies", (signal.SIGSEGV,), SHORT, "died", "SIGSEGV"),
    ],
)
def test_limits_hold(
    way: str, function: str, arguments: tuple[Any, ...], limits: Limits, cause: str, said: str
) -> None:
    with pytest.raises(Stopped, match=said) as caught:
        call(f"{HERE}:{function}", *arguments, limits=limits)
    assert caught.value.cause == cause
    assert call(f"{HERE}:echo", 5) == 5  # and the next call is answered


def test_faults_are_the_callers_own(way: str) -> None:
    with pytest.raises(CaseError) as caught:
        call(f"{HERE}:has_a_fault")
    assert caught.value.errors == [FieldError(("lines", 0), "is wrong", "7", 3)]
    with pytest.raises(DataError, match="second value"):  # told before the first value is taken
        next(stream(f"{HERE}:later_fault"))
    with pytest.raises(RuntimeError, match="ZeroDivisionError"):
        call("builtins:divmod", 1, 0)


def test_an_attached_file(way: str, tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("a text")
    with (tmp_path / "a.txt").open("rb") as file:
        assert call(f"{HERE}:attached_content", "!", attached=file) == "a text!"


def test_nothing_of_the_service_is_open_in_the_child(way: str, tmp_path: Path) -> None:
    with (tmp_path / "secret").open("w") as secret:
        os.set_inheritable(secret.fileno(), True)
        found = call(f"{HERE}:open_files")
    assert not [name for name in found if "secret" in name or "socket" in name or "pipe" in name]


@pytest.mark.slow
def test_a_template_that_was_killed_is_started_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calls, "_single_threaded", lambda: False)
    assert call(f"{HERE}:echo", 1) == 1
    process = calls._template._process
    assert process is not None
    process.kill()
    process.wait()
    assert call(f"{HERE}:echo", 2) == 2
    again = calls._template._process
    assert again is not None
    os.kill(again.pid, signal.SIGSTOP)  # and one that dies with a call under way
    threading.Timer(0.5, again.kill).start()
    assert call(f"{HERE}:echo", 3) == 3


def test_few_may_wait(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calls, "_queue", threading.BoundedSemaphore(1))
    with calls._place(), pytest.raises(UnavailableError, match="again in a few seconds"):
        call(f"{HERE}:echo", 1)
    assert call(f"{HERE}:echo", 1) == 1


@pytest.mark.slow
def test_the_template_ends_with_its_owner() -> None:
    code = (
        "from store.isolation import call, calls, warm_up; warm_up(); call('builtins:abs', -1);"
        "print(calls._template._process.pid, flush=True); import os; os.kill(os.getpid(), 9)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=120)
    pid = int(done.stdout)
    deadline = time.monotonic() + 10
    while Path(f"/proc/{pid}").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not Path(f"/proc/{pid}").exists()


def header(value: Any, *blobs: bytes) -> bytes:
    text = json.dumps(value).encode()
    return struct.pack("<QQ", len(text), len(blobs)) + text + b"".join(struct.pack("<Q", len(b)) + b for b in blobs)


@pytest.mark.parametrize(
    "content",
    [
        b"\x80\x04cos\nsystem\n(S'true'\ntR.",  # a pickle
        struct.pack("<QQ", 2**62, 0),
        struct.pack("<QQ", 2, 2**40) + b"{}",
        header({"$": "array", "at": 0, "dtype": "|O", "shape": [1]}, bytes(8)),
        header({"$": "array", "at": 0, "dtype": "<f8", "shape": [2]}, bytes(8)),
        header({"$": "array", "at": 0, "dtype": "<f8", "shape": [-1]}, bytes(8)),
        header({"$": "array", "at": 3, "dtype": "<f8", "shape": [1]}, bytes(8)),
        header({"$": "Popen", "fields": {"args": "true"}}),
        header({"$": "HydrodynamicData", "fields": {}}),
        header({"$": "bytes", "at": 0}, bytes(8))[:-1],
        b"{}",
    ],
)
def test_bytes_that_are_no_answer(content: bytes) -> None:
    with pytest.raises(plain.PlainError):
        plain.read(io.BytesIO(content), 1000)


def test_only_known_classes_travel() -> None:
    for value in (object(), {1, 2}, np.array([object()]), Path("/")):
        with pytest.raises(TypeError):
            plain.write(io.BytesIO(), value)


# --- files


def damaged(position: int, value: int) -> bytes:
    """The bundled barge with one byte changed. HDF5 2.0 never ends reading these."""
    payload = bytearray(BARGE.read_bytes())
    assert payload[position] != value
    payload[position] = value
    return bytes(payload)


DAMAGED = [(2720, 127), (2720, 126), (2721, 2)]


@pytest.mark.slow
@pytest.mark.parametrize(("position", "value"), DAMAGED)
def test_a_damaged_file_is_refused(position: int, value: int) -> None:
    with pytest.raises(DataError, match=r"^one-byte.nc: .*damaged"):
        reading.read_bytes(damaged(position, value), "one-byte.nc")


def test_a_file_is_read_once_and_by_the_rules_of_the_folder(tmp_path: Path) -> None:
    (tmp_path / "barge.nc").write_bytes(BARGE.read_bytes())
    source = reading.IsolatedFiles(tmp_path, confined=True)
    first = source.open("barge.nc")
    assert isinstance(first, HydrodynamicData)
    assert source.open("barge.nc") is first
    with pytest.raises(DataError, match=r"without '\.\.'"):
        source.open("../barge.nc")


@pytest.mark.slow
def test_bytes_changed_at_random() -> None:
    """Whatever is changed: data, or one sentence; SLOWDRIFT_FUZZ sets how many files are tried."""
    warm_up()
    random = np.random.default_rng(int(os.environ.get("SLOWDRIFT_FUZZ_SEED", "13")))
    whole = BARGE.read_bytes()
    for _ in range(int(os.environ.get("SLOWDRIFT_FUZZ", "40"))):
        spoilt = bytearray(whole)
        for position in random.integers(0, min(len(whole), 20_000), random.integers(1, 5)):
            spoilt[position] = random.integers(256)
        try:
            found = reading.read_bytes(bytes(spoilt), "fuzz.nc")
        except DataError as error:
            said = str(error)
        else:
            said = "fuzz.nc" if np.all(np.isfinite(found.added_mass)) else "not finite"
        assert said.startswith("fuzz.nc")
        assert len(said) < 1000
