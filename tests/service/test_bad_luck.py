"""A process that hangs or a file that cannot be read stops nobody else: with the service as people start it."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import pytest

from cli.supervisor import Child, Supervisor
from store.settings import Settings
from tests.store.test_isolation import DAMAGED, damaged

from .conftest import Place
from .running import command_line, processes_of, service, wait_until

pytestmark = pytest.mark.slow


@pytest.fixture
def place(make_place: Callable[..., Place]) -> Place:
    return make_place("embedded")


@pytest.fixture
def client(place: Place) -> Iterator[httpx.Client]:
    with service(place.settings, False) as client:
        yield client


def api_process(settings: Settings) -> int:
    return next((pid for pid in processes_of(settings) if " api --fd " in command_line(pid)), 0)


def test_a_damaged_file_stops_nobody(client: httpx.Client) -> None:
    """Sent twice at a time beside requests that must be answered; nothing is stored."""
    url = f"{client.base_url}/api/v1/data-sets"
    before = client.get("/api/v1/data-sets").json()

    def upload(change: tuple[int, int]) -> httpx.Response:
        return httpx.post(url, files={"file": ("one-byte.nc", damaged(*change))}, timeout=120)

    with ThreadPoolExecutor(3) as pool:
        uploads = [pool.submit(upload, change) for change in DAMAGED]
        answered = 0
        while not all(one.done() for one in uploads):
            assert client.get("/healthz").status_code == 200
            assert client.get("/api/v1/runs").status_code == 200
            answered += 1
            time.sleep(0.02)
    assert answered > 5
    for one in uploads:
        assert one.result().status_code == 422, one.result().text
        assert "damaged" in one.result().json()["errors"][0]["message"]
    assert client.get("/api/v1/data-sets").json() == before


def test_a_service_whose_reader_was_killed_reads_on(place: Place, client: httpx.Client) -> None:
    readers = [pid for pid in processes_of(place.settings) if "store.isolation.template" in command_line(pid)]
    assert readers
    for pid in readers:
        os.kill(pid, signal.SIGKILL)
    answer = client.post("/api/v1/data-sets", files={"file": ("a.nc", damaged(*DAMAGED[0])[:5000])}, timeout=120)
    assert answer.status_code == 422


def test_an_api_process_that_hangs_is_replaced(place: Place, client: httpx.Client) -> None:
    pid = api_process(place.settings)
    os.kill(pid, signal.SIGSTOP)  # as one that holds the interpreter's lock for ever: alive, and answers nothing
    wait_until(lambda: api_process(place.settings) not in (0, pid), 60)
    assert client.get("/healthz").status_code == 200


def test_a_child_without_a_sign_of_life_is_replaced_and_one_with_is_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two children: one beats its pulse, one stops after the first beat."""
    (tmp_path / "cli").mkdir()
    (tmp_path / "cli" / "__init__.py").touch()
    (tmp_path / "cli" / "main.py").write_text(
        "import os, sys, time\n"
        "while True:\n"
        "    os.write(int(os.environ['SLOWDRIFT_PULSE']), b'.')\n"
        "    time.sleep(1000 if sys.argv[1] == 'hangs' else 0.1)\n"
    )
    supervisor = Supervisor([Child("beats", ["beats"], silence=6.0), Child("hangs", ["hangs"], silence=6.0)], {}, None)
    supervisor._environment["PYTHONPATH"] = str(tmp_path)
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    supervisor.start()
    try:
        deadline = time.monotonic() + 60
        said = ""
        while "hangs gave no sign of life" not in said and time.monotonic() < deadline:
            supervisor.tick()
            time.sleep(0.05)
            said += capsys.readouterr().out
    finally:
        supervisor.stop()
        for number, handler in handlers.items():
            signal.signal(number, handler)
    assert said.count("hangs gave no sign of life") == 1
    assert "beats" not in said
