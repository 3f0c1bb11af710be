"""Prometheus: what was answered and how fast, and what the database says of queues and runs.

Several processes on one port (`slowdrift serve --api-processes`) keep their counts in files of a folder, and whichever
is asked tells those of all; the first of them counts runs that ended.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta

from prometheus_client import CollectorRegistry, Histogram, ProcessCollector, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.multiprocess import MultiProcessCollector
from prometheus_client.registry import Collector
from sqlalchemy.exc import SQLAlchemyError
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from store.clock import utc_now
from store.database import Database
from store.doorbell import Doorbell
from store.health import DEGRADED, OK, Health
from store.models import ACTIVE, FINAL, STATES
from store.priority import name_of
from store.repositories import QueueRepository

from .streams import Streams

WINDOW = timedelta(minutes=10)
"""Runs that ended longer ago than this before a scrape are not seen by the histogram of run times."""
ENDED_SECONDS = 60.0
"""How old the numbers of ended runs may be: to count a hundred thousand takes 20 ms."""
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")
LOOK_SECONDS = 15.0
"""How often the first of several processes looks for runs that ended, since it may never be the one that is asked."""
FAST = (0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 30)
SLOW = (0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000, 3000, 10_000, 30_000)


class Metrics:
    """The registry of one app."""

    def __init__(self, database: Database, count_runs: bool = True):
        self.registry = CollectorRegistry()
        self._counts_runs, self._several = count_runs, bool(os.environ.get("PROMETHEUS_MULTIPROC_DIR"))
        own = None if self._several else self.registry
        self.requests = Histogram(
            "slowdrift_request_seconds", "Time to the end of an answer; event streams apart", ("method", "route", "status"),
            buckets=FAST, registry=own,
        )  # fmt: skip
        self.runs = Histogram(
            "slowdrift_run_seconds", "From a run's first claim to its end", ("kind", "state"), buckets=SLOW,
            registry=own,
        )  # fmt: skip
        self._database, self._lock = database, threading.Lock()
        self._seen: set[str] = set()
        self._first = True
        if self._several:
            MultiProcessCollector(self.registry)
        else:
            ProcessCollector(registry=self.registry)
        self.registry.register(_Rows(database))

    def text(self) -> bytes:
        self._observe_runs()
        return generate_latest(self.registry)

    @contextmanager
    def counting(self) -> Iterator[None]:
        """While the app runs."""
        halt = threading.Event()

        def look() -> None:
            while not halt.is_set():
                self._observe_runs()
                halt.wait(LOOK_SECONDS)

        if self._several and self._counts_runs:
            threading.Thread(target=look, name="metrics", daemon=True).start()
        yield
        halt.set()

    def _observe_runs(self) -> None:
        if self._counts_runs:
            with self._lock:
                self._observe()

    def _observe(self) -> None:
        """Each ended run once; those from before the first scrape are not counted."""
        try:
            with self._database.read() as session:
                ended = QueueRepository(session).ended_since(utc_now() - WINDOW)
        except SQLAlchemyError:
            return
        for run in ended:
            if run.run_id not in self._seen and not self._first:
                self.runs.labels(run.kind, run.state).observe(run.seconds)
        self._seen, self._first = {run.run_id for run in ended}, False


class _Rows(Collector):
    """Gauges out of the database, read at each scrape."""

    def __init__(self, database: Database):
        self._database = database
        self._ended: dict[str, int] = {}
        self._counted_at = -ENDED_SECONDS

    def describe(self) -> list[Metric]:
        return []

    def _states(self, queues: QueueRepository) -> dict[str, int]:
        """Runs by state: active ones as they are, ended ones as they were when they were counted last."""
        if time.monotonic() - self._counted_at >= ENDED_SECONDS:
            self._ended, self._counted_at = queues.states(FINAL), time.monotonic()
        return self._ended | queues.states(ACTIVE)

    def collect(self) -> Iterator[Metric]:
        up = GaugeMetricFamily("slowdrift_database_up", "1 when the database answers")
        began = time.perf_counter()
        try:
            with self._database.read() as session:
                queues = QueueRepository(session)
                waiting, states, workers = queues.waiting(), self._states(queues), queues.workers()
        except SQLAlchemyError:
            up.add_metric([], 0)
            yield up
            return
        up.add_metric([], 1)
        yield up
        yield GaugeMetricFamily(
            "slowdrift_database_seconds", "Time of this scrape's queries", time.perf_counter() - began
        )
        labels = ["queue", "priority"]
        queued = GaugeMetricFamily("slowdrift_tasks_queued", "Tasks that wait", labels=labels)
        running = GaugeMetricFamily("slowdrift_tasks_running", "Tasks at work", labels=labels)
        oldest = GaugeMetricFamily("slowdrift_oldest_queued_seconds", "Age of the oldest run that waits", labels=labels)
        for each in waiting:
            place = [each.queue, name_of(each.priority)]
            queued.add_metric(place, each.queued)
            running.add_metric(place, each.running)
            oldest.add_metric(place, each.oldest_seconds or 0.0)
        yield from (queued, running, oldest)
        runs = GaugeMetricFamily("slowdrift_runs", "Runs in the database by state", labels=["state"])
        for state in STATES:
            runs.add_metric([state], states.get(state, 0))
        yield runs
        yield GaugeMetricFamily("slowdrift_workers_busy", "Worker processes with a task in hand", len(workers))


class ServiceState(Collector):
    """Gauges of this process: what its health checks said last, its dispatcher, and its event streams."""

    def __init__(self, health: Health, doorbell: Doorbell, streams: Streams):
        self._health, self._doorbell, self._streams = health, doorbell, streams

    def describe(self) -> list[Metric]:
        return []

    def collect(self) -> Iterator[Metric]:
        self._health.start()
        states = GaugeMetricFamily("slowdrift_check", "1 ok, 0.5 degraded, 0 not ready", labels=["part"])
        for check in self._health.checks:
            states.add_metric([check.name], {OK: 1.0, DEGRADED: 0.5}.get(check.answer()[0], 0.0))
        yield states
        bell = self._doorbell
        up = 0.0 if bell.last_error else 1.0
        yield GaugeMetricFamily("slowdrift_dispatcher_up", "1 when the broker took the last message", up)
        yield GaugeMetricFamily("slowdrift_dispatcher_waiting", "Messages that wait to be sent", bell.waiting)
        yield CounterMetricFamily("slowdrift_dispatcher_sent", "Messages that the broker took", bell.sent)
        yield CounterMetricFamily("slowdrift_dispatcher_failed", "Messages that it did not take", bell.failed)
        yield GaugeMetricFamily("slowdrift_streams_open", "Event streams", self._streams.open)
        yield GaugeMetricFamily("slowdrift_streams_limit", "Event streams of this process at most", self._streams.most)
        yield CounterMetricFamily(
            "slowdrift_streams_refused", "Event streams refused by a limit", self._streams.refused
        )


class Meter:
    """Times every answer under the address of its route."""

    def __init__(self, app: ASGIApp, metrics: Metrics):
        self.app, self.metrics = app, metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            return await self.app(scope, receive, send)
        began, seen = time.perf_counter(), {"status": 500, "stream": False}

        async def watch(message: Message) -> None:
            if message["type"] == "http.response.start":
                seen["status"] = message["status"]
                seen["stream"] = any(
                    name == b"content-type" and value.startswith(b"text/event-stream")
                    for name, value in message["headers"]
                )
            await send(message)

        try:
            return await self.app(scope, receive, watch)
        finally:
            if not seen["stream"]:
                method = scope["method"] if scope["method"] in METHODS else "other"
                labels = (method, _route(scope), str(seen["status"]))
                self.metrics.requests.labels(*labels).observe(time.perf_counter() - began)


def _route(scope: Scope) -> str:
    """The address with its parameters' names; whatever no route answers is one, so that strangers make no series."""
    path: str | None = getattr(scope.get("route"), "path", None)
    if path is None:
        return "other"
    first = f"/{scope['path'].split('/')[1]}"
    return path if path.startswith(first) or first != "/api" else f"/api/v1{path}"
