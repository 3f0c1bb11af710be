"""The Python client against the API in this process, with the fake solver doing the work."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest

from api.main import create_app
from slowdrift_client import ApiError, Client, RunFailedError
from store.settings import Settings
from tests.api.conftest import TestClient
from tests.service.running import ROOT, a_case
from tests.studies.conftest import client as rest
from tests.studies.conftest import database, migrated, service_settings, work

__all__ = ["database", "migrated", "rest", "service_settings", "work"]
EA = "/line_types/t/EA"


@pytest.fixture
def slowdrift(service_settings: Settings) -> Iterator[Client]:
    app = create_app(service_settings, reconcile=False)
    with TestClient(app, base_url="http://localhost/api/v1/") as transport, Client(patience=2) as made:
        made._http = transport
        yield made


@pytest.fixture
def working(work: Callable[[], list[str]]) -> Iterator[None]:
    """A worker that goes on while the test waits."""
    stop = threading.Event()

    def go_on() -> None:
        while not stop.wait(0.02):
            work()

    thread = threading.Thread(target=go_on)
    thread.start()
    yield
    stop.set()
    thread.join()


def test_submit_wait_results(slowdrift: Client, working: None) -> None:
    pytest.importorskip("xarray")
    seen = []
    run = slowdrift.submit(a_case("a case", seconds=0.2), name="mine", tags=["basis"])
    done = slowdrift.wait(run, timeout=20, on_progress=seen.append)
    assert (done.state, done.name, done.tags) == ("succeeded", "mine", ["basis"])
    assert seen
    assert slowdrift.summary(done)["case"] == "a case"
    tree = slowdrift.results(done)
    surge = tree["frequency/vessel/surge"]
    assert (surge.dims, surge.attrs["units"]) == (("omega",), "m2 s/rad")
    assert surge.values.tolist() == list(range(50))
    assert slowdrift.channel(done, "frequency/vessel/surge", points=8).full_size == 50
    assert [run.id for run in slowdrift.runs(tag="basis")] == [done.id]
    assert slowdrift.case(done).name == "a case"
    again = slowdrift.wait(slowdrift.rerun(done), timeout=20)
    assert again.rerun_of == done.id


def test_a_study(slowdrift: Client, working: None) -> None:
    saved = slowdrift.save_case(a_case("saved"))
    study = slowdrift.wait_study(slowdrift.study(saved.id, grid={EA: [1e8, 2e8, 4e8]}), timeout=20)
    rows = slowdrift.table(study, [EA, "answer"])
    assert rows == [{EA: ea, "answer": ea / 3} for ea in (1e8, 2e8, 4e8)]


def test_faults_are_told(slowdrift: Client, working: None) -> None:
    with pytest.raises(ApiError, match="422") as caught:
        slowdrift.submit({"slowdrift": 1})
    assert caught.value.errors[0]["field"]
    with pytest.raises(RunFailedError, match="It went on and on"):
        slowdrift.wait(slowdrift.submit(a_case("bad", fault="diverge")), timeout=20)
    with pytest.raises(ApiError, match="404"):
        slowdrift.run("none")


def test_a_wait_can_end(slowdrift: Client) -> None:
    with pytest.raises(TimeoutError, match="queued"):
        slowdrift.wait(slowdrift.submit(a_case("nobody works")), timeout=0.2)


def test_a_lost_answer_starts_nothing_twice(slowdrift: Client, monkeypatch: pytest.MonkeyPatch) -> None:
    request, lost = slowdrift._http.request, []

    def lossy(*arguments: Any, **more: Any) -> httpx.Response:
        answer = request(*arguments, **more)
        if not lost:
            lost.append(answer)
            raise httpx.ReadError("the connection broke")
        return answer

    monkeypatch.setattr(slowdrift._http, "request", lossy)
    run = slowdrift.submit(a_case("once"))
    assert lost[0].json()["id"] == run.id
    assert len(list(slowdrift.runs())) == 1


def test_an_absent_service_is_waited_for_and_then_told() -> None:
    began = time.monotonic()
    with Client("http://127.0.0.1:1", patience=0.3) as nowhere, pytest.raises(httpx.ConnectError):
        nowhere.run("x")
    assert 0.3 <= time.monotonic() - began < 5


@pytest.mark.parametrize("form", ["path", "name", "text"])
def test_a_case_may_come_in_several_forms(slowdrift: Client, form: str) -> None:
    path = ROOT / "examples" / "hanging-riser-case1.yaml"
    case: Any = {"path": path, "name": str(path), "text": path.read_text()}[form]
    assert slowdrift.submit(case).case_name == slowdrift.save_case(case).name


@pytest.mark.slow
def test_the_models_are_those_of_the_service() -> None:
    pytest.importorskip("datamodel_code_generator")
    from docs import make_client

    assert make_client.generate() == Path(make_client.TARGET).read_text(), "run python docs/make_client.py"


def test_catalogue(slowdrift: Client) -> None:
    assert "chain-R4-studless" in {item["name"] for item in slowdrift.catalogue()}
    found = slowdrift.catalogue("chain-R4-studless", "120 mm", "orcaflex")
    assert found["values"]["EA"]["value"] == pytest.approx(1229.76e6)
    with pytest.raises(ApiError, match="outside the range"):
        slowdrift.catalogue("wire", 2.0)
