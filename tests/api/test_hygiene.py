"""ETags, compression, request rates, metrics, logs, what happens when the database is away."""

from __future__ import annotations

import asyncio
import gzip
import json
import logging
import uuid
from typing import Any

import httpx
import pytest
import zstandard
from sqlalchemy.exc import OperationalError

from api import rates as rates_module
from api.main import create_app
from api.rates import Rates
from store import logs
from store.settings import Settings
from tests.api.conftest import TestClient
from tests.awaiting import awaited
from tests.service.conftest import REDIS, need
from tests.service.running import a_case


def submit(client: TestClient, name: str = "a case") -> str:
    return str(client.post("/api/v1/runs", json={"case": a_case(name)}).json()["id"])


def test_an_answer_known_already_costs_no_bytes(client: TestClient) -> None:
    address = f"/api/v1/runs/{submit(client)}"
    first = client.get(address)
    again = client.get(address, headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", first.headers["etag"])
    assert "no-cache" in again.headers["cache-control"]
    client.post(f"{address}/cancel")
    changed = client.get(address, headers={"If-None-Match": first.headers["etag"]})
    assert (changed.status_code, changed.json()["state"]) == (200, "cancelled")
    assert "etag" not in client.get("/api/v1/runs/none").headers


@pytest.mark.parametrize(("coding", "unpack"), [("zstd", None), ("gzip", gzip.decompress)])
def test_large_answers_are_compressed(client: TestClient, coding: str, unpack: Any) -> None:
    plain = client.get("/api/v1/schema", headers={"Accept-Encoding": "identity"})
    with client.stream("GET", "/api/v1/schema", headers={"Accept-Encoding": coding}) as answer:
        assert answer.headers["content-encoding"] == coding
        raw = b"".join(answer.iter_raw())
    unpacked = zstandard.ZstdDecompressor().decompressobj().decompress(raw) if unpack is None else unpack(raw)
    assert unpacked == plain.content
    assert len(raw) < len(plain.content) / 3


async def nothing(scope: Any, receive: Any, send: Any) -> None:
    """An application that has nothing to say."""
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b""})


def test_one_caller_cannot_take_all() -> None:
    inner = TestClient(Rates(nothing, per_minute=5))
    answers = [inner.get("/") for _ in range(6)]
    assert [answer.status_code for answer in answers] == [200] * 5 + [429]
    assert 1 <= int(answers[-1].headers["retry-after"]) <= 61
    assert answers[-1].headers["content-type"] == "application/problem+json"
    assert TestClient(Rates(nothing, per_minute=0)).get("/").status_code == 200


async def asked(times: int, *rates: Rates) -> list[int]:
    """So many requests of one caller at once, to processes that answer on one port by turns; the answers' statuses."""

    async def ask(number: int) -> int:
        transport = httpx.ASGITransport(rates[number % len(rates)])
        async with httpx.AsyncClient(transport=transport, base_url="http://localhost") as one:
            answer = await one.get("/")
        assert answer.status_code == 200 or 1 <= int(answer.headers["retry-after"]) <= 61
        return answer.status_code

    return list(await asyncio.gather(*(ask(number) for number in range(times))))


@pytest.mark.services
@pytest.mark.parametrize("url", [REDIS, "redis://localhost"])
def test_processes_count_a_caller_together_in_redis(
    url: str, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    need("Redis", 6379)
    monkeypatch.setattr(rates_module, "REDIS_SECONDS", 30.0)  # 300 at once on a machine that may be busy
    prefix = f"sd_{uuid.uuid4().hex[:12]}"

    async def many() -> list[int]:
        return await asked(300, *(Rates(nothing, 60, url, prefix) for _ in range(2)))

    assert sorted(awaited(many())) == [200] * 60 + [429] * 240
    assert awaited(asked(1, Rates(nothing, 60, url, prefix + "x"))) == [200]  # another service's
    assert not caplog.text


def test_without_its_redis_each_process_counts(caplog: pytest.LogCaptureFixture) -> None:
    assert sorted(awaited(asked(6, Rates(nothing, 5, "redis://127.0.0.1:1/0")))) == [200] * 5 + [429]
    assert caplog.text.count("counted in this process only") == 1


def test_a_redis_that_does_not_answer_is_not_asked_by_everybody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rates_module, "REDIS_SECONDS", 0.05)
    asks: list[str] = []
    really = Rates._wait_shared

    async def noted(rates: Rates, limiter: Any, item: Any, caller: str) -> int:
        asks.append(caller)
        return await really(rates, limiter, item, caller)

    monkeypatch.setattr(Rates, "_wait_shared", noted)

    async def silent(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.read()
        writer.close()

    async def go() -> list[int]:
        async with await asyncio.start_server(silent, "127.0.0.1", 0) as server:
            rates = Rates(nothing, 5, f"redis://127.0.0.1:{server.sockets[0].getsockname()[1]}/0")
            assert sorted(await asked(4, rates)) == [200] * 4
            counts = [len(asks)]
            assert sorted(await asked(20, rates)) == [200] + [429] * 19
            counts.append(len(asks))
            rates._ask_again_at = 0.0  # as after REDIS_AWAY
            await asked(20, rates)
            return [*counts, len(asks)]

    first, meanwhile, later = awaited(go())
    assert first >= 1
    assert (meanwhile, later) == (first, first + 1)


def test_metrics_tell_queues_runs_and_requests(client: TestClient) -> None:
    submit(client)
    client.get("/api/v1/runs/none")
    text = client.get("/metrics").text
    assert 'slowdrift_tasks_queued{priority="interactive",queue="runs"} 1.0' in text
    assert 'slowdrift_runs{state="queued"} 1.0' in text
    assert "slowdrift_database_up 1.0" in text
    asked = 'slowdrift_request_seconds_count{method="GET",route="/api/v1/runs/{run_id}",status="404"}'
    assert f"{asked} 1.0" in text


def test_metrics_may_want_a_token(service_settings: Settings) -> None:
    guarded = service_settings.model_copy(update={"metrics_token": "open sesame"})
    with TestClient(create_app(guarded, reconcile=False), base_url="http://localhost") as client:
        assert client.get("/metrics").status_code == 404
        assert client.get("/metrics", headers={"Authorization": "Bearer wrong"}).status_code == 404
        assert client.get("/metrics", headers={"Authorization": "Bearer open sesame"}).status_code == 200


def test_a_database_that_is_away_is_said_so(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    from api.services import runs

    def away(*_: Any) -> None:
        raise OperationalError("INSERT", {}, Exception("database or disk is full"))

    monkeypatch.setattr(runs, "start", away)
    answer = client.post("/api/v1/runs", json={"case": a_case("unlucky")})
    assert (answer.status_code, answer.json()["type"]) == (503, "unavailable")
    assert "INSERT" not in answer.text


def test_logs_name_their_run(capsys: pytest.CaptureFixture[str]) -> None:
    root = logging.getLogger()
    before, level = root.handlers[:], root.level
    try:
        for as_json in (True, False):
            logs.configure("info", as_json)
            with logs.about(run_id="r1", attempt=2):
                logging.getLogger("slowdrift.test").info("said")
        first, second = capsys.readouterr().err.strip().splitlines()[-2:]
    finally:
        root.handlers[:] = before
        root.setLevel(level)
    found = json.loads(first)
    assert (found["message"], found["run_id"], found["attempt"], found["level"]) == ("said", "r1", 2, "INFO")
    assert second.endswith("said run_id=r1 attempt=2")


def test_requests_have_names(client: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    from api.request_ids import HEADER

    made = client.get("/api/v1/runs").headers[HEADER]
    assert made != client.get("/api/v1/runs").headers[HEADER]
    assert client.get("/api/v1/runs/nobody", headers={HEADER: "proxy-7.1"}).headers[HEADER] == "proxy-7.1"
    for strange in ("a b", "x" * 65, "<script>", ""):
        assert client.get("/healthz", headers={HEADER: strange}).headers[HEADER] != strange


def test_logs_name_the_request(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """A fault inside of ours: the answer's id is that in the log, also from a thread."""
    from api.request_ids import HEADER

    seen: list[str] = []

    class Notes(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            seen.append(getattr(record, "about", ""))

    handler = Notes()
    handler.addFilter(logs._Names(as_fields=False))
    logging.getLogger("api.errors").addHandler(handler)

    def away(*_: Any, **__: Any) -> None:
        raise OperationalError("SELECT", {}, Exception("away"))

    monkeypatch.setattr("store.repositories.runs.RunRepository.page", away)
    answer = client.get("/api/v1/runs")
    logging.getLogger("api.errors").removeHandler(handler)
    assert answer.status_code == 503
    assert seen == [f" request_id={answer.headers[HEADER]}"]


@pytest.mark.parametrize("letter", ["\u202e", "\u2066", "\u200f", "\x85", "\ufeff"])
def test_names_do_not_turn_direction(client: TestClient, letter: str) -> None:
    answer = client.post("/api/v1/runs", json={"case": a_case("a"), "name": f"run {letter}gpj.exe"})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["field"] == "name"
    assert client.post("/api/v1/cases", json=a_case(f"case {letter}")).status_code == 422
