"""One watcher of a process looks at the database for all who follow runs, and tells each what changed.

A look asks for the marks of all followed runs (store/repositories/watch.py) and reads only those whose mark is another
than before. The database is asked as often with two thousand listeners as with one. What a look finds is encoded once.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TypeVar

import anyio
from sqlalchemy.orm import Session

from store.database import Database
from store.models import ACTIVE, FINAL
from store.repositories import RunRepository
from store.repositories.watch import Mark, WatchRepository
from store.scope import Scope

from .services.runs import info

SECONDS, PROJECTS_EVERY = 0.25, 2
"""Between two looks; projects are looked at in each second one."""
SHARE, LONGEST = 4.0, 5.0
"""A look and telling everybody may take one part in SHARE + 1 of the time: after long ones the next is later, at most
LONGEST seconds."""
NEWEST, MOST_ACTIVE = 50, 200
"""Of a project's runs."""
ESTIMATE_SECONDS, ESTIMATES, OF_PROJECTS = 5.0, 50, 8
"""Runs of which nothing changed for so long are read again for their estimates: once a second so many of those that
somebody follows alone, and so many of projects."""
TOLD_AT_ONCE = 10
"""Listeners that are told between two turns of the event loop, so that requests come in between."""
log = logging.getLogger(__name__)

K = TypeVar("K")
Key = tuple[str, bool]
"""A run, and whether it is seen through a share link, where nobody is named."""


@dataclass(frozen=True)
class Seen:
    """A run as it was read last; `event` is what listeners get."""

    mark: Mark
    state: str
    event: bytes
    read_at: float


def event_of(text: str) -> bytes:
    """A server-sent event `run` with a run as JSON."""
    return f"event: run\ndata: {text}\n\n".encode()


class Listener:
    """One stream. What it has not taken yet is replaced by what is newer, so that a slow one does not pile up."""

    def __init__(self, sent: bytes = b"", since: int = 0):
        self.sent, self.since = sent, since
        """Of a single run: the last event, so that the same is not sent twice; and the look during which it came."""
        self._pending: dict[str, bytes] = {}
        self._ready = asyncio.Event()
        self.ended = False

    def offer(self, events: dict[str, bytes]) -> None:
        """Of each run its newest event. The dictionary is not changed here: other listeners have it too."""
        self._pending = {**self._pending, **events} if self._pending else events
        self._ready.set()

    def end(self) -> None:
        self.ended = True
        self._ready.set()

    async def take(self, seconds: float) -> bytes | None:
        """The events since the last call, waited for so long; None where there are none."""
        try:
            async with asyncio.timeout(seconds):
                await self._ready.wait()
        except TimeoutError:
            return None
        self._ready.clear()
        taken, self._pending = self._pending, {}
        return b"".join(taken.values()) or None


@dataclass
class _Followed:
    """A run or a project that somebody listens to."""

    scope: Scope
    listeners: set[Listener] = field(default_factory=set)
    told: dict[str, bytes] = field(default_factory=dict)
    """Of a project: the runs of the last look, as its listeners know them."""
    looked: bool = False


@dataclass(frozen=True)
class _Plan:
    """What a look is to look at: scopes of runs, scopes and last members of projects, what is known already."""

    runs: dict[Key, Scope]
    projects: dict[str, tuple[Scope, tuple[str, ...]]]
    seen: dict[Key, Seen]
    estimate: bool
    """Whether runs that are only older are to be read too."""
    joined: set[Key]
    """Runs to be read whatever their mark says: a listener has come, who knows what it was told elsewhere."""


@dataclass(frozen=True)
class _Look:
    """What a look found: runs read anew, runs that are gone, and the members of each project."""

    read: dict[Key, Seen]
    gone: set[Key]
    members: dict[str, tuple[str, ...]]


class Watcher:
    """Used from the event loop only; its looks are in a thread of their own."""

    def __init__(self, database: Database):
        self._database = database
        self._runs: dict[Key, _Followed] = {}
        self._projects: dict[str, _Followed] = {}
        self._seen: dict[Key, Seen] = {}
        self._joined: set[Key] = set()
        self._number = 0
        """Of the look that is under way, or was last."""
        self._estimated_at = 0.0
        self._task: asyncio.Task[None] | None = None
        self._soon = asyncio.Event()

    # -- listening

    @contextmanager
    def run(self, scope: Scope, run_id: str, sent: bytes) -> Iterator[Listener]:
        """Changes of one run, which the scope has been found to hold; `sent`: the event that the listener has."""
        key = (run_id, scope.run_ids is not None)
        followed = self._runs.setdefault(key, _Followed(scope))
        listener = Listener(sent, self._number)
        followed.listeners.add(listener)
        self._joined.add(key)
        self._start()
        try:
            yield listener
        finally:
            self._leave(self._runs, key, followed, listener)

    @contextmanager
    def project(self, scope: Scope) -> Iterator[Listener]:
        """Its active runs, then every change."""
        key = scope.project_id
        followed = self._projects.setdefault(key, _Followed(scope))
        listener = Listener()
        if followed.looked:  # what the others know already, who get the changes from here on too
            first = {each: text for each, text in followed.told.items() if self._seen[each, False].state in ACTIVE}
            if first:
                listener.offer(first)
        followed.listeners.add(listener)
        self._start()
        try:
            yield listener
        finally:
            self._leave(self._projects, key, followed, listener)

    def _start(self) -> None:
        if self._task is None or self._task.done():
            self._soon = asyncio.Event()
            self._task = asyncio.get_running_loop().create_task(self._watch())
        self._soon.set()

    def _leave(self, table: dict[K, _Followed], key: K, followed: _Followed, listener: Listener) -> None:
        """End the last listener's entry, and the looks with the last entry."""
        followed.listeners.discard(listener)
        if not followed.listeners and table.get(key) is followed:
            del table[key]
        self._stop()

    def _stop(self) -> None:
        if not (self._runs or self._projects) and self._task is not None:
            self._task.cancel()
            self._task, self._seen, self._joined = None, {}, set()

    # -- looking

    async def _watch(self) -> None:
        alone = anyio.CapacityLimiter(1)  # not one of the threads that answer requests
        while True:
            self._soon.clear()
            began = time.monotonic()
            plan = self._plan()
            try:
                found = await anyio.to_thread.run_sync(_look, self._database, plan, limiter=alone)
                await self._tell(found)
                rest = min(SHARE * (time.monotonic() - began), LONGEST)
            except Exception as error:  # the database may come back, and the streams with it
                log.warning("The watcher of runs could not look: %s: %s", type(error).__name__, error)
                self._joined |= plan.joined
                rest = LONGEST
            await asyncio.sleep(rest)
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(max(0.0, SECONDS - rest)):
                    await self._soon.wait()

    def _plan(self) -> _Plan:
        self._number += 1
        joined, self._joined = self._joined, set()
        runs = {key: each.scope for key, each in self._runs.items()}
        turn = self._number % PROJECTS_EVERY == 0
        due = {key: each for key, each in self._projects.items() if turn or not each.looked}
        projects = {key: (each.scope, tuple(each.told)) for key, each in due.items()}
        now = time.monotonic()
        estimate = now - self._estimated_at > 1.0
        self._estimated_at = now if estimate else self._estimated_at
        return _Plan(runs, projects, self._seen, estimate, joined)

    async def _tell(self, found: _Look) -> None:
        self._seen = self._seen | found.read
        told = 0
        for key in [*found.read, *found.gone]:
            followed = self._runs.get(key)
            for listener in list(followed.listeners) if followed else ():
                if listener.since < self._number:  # one that came during the look may know more than it found
                    self._tell_of_run(listener, key, key in found.gone)
                    told = await _turn(told)
        for project, members in found.members.items():
            followed = self._projects.get(project)
            if followed is None:
                continue
            events = self._changes(followed, members)
            for listener in list(followed.listeners) if events else ():
                listener.offer(events)
                told = await _turn(told)
        wanted = set(self._runs) | {(each, False) for followed in self._projects.values() for each in followed.told}
        self._seen = {key: seen for key, seen in self._seen.items() if key in wanted}

    def _tell_of_run(self, listener: Listener, key: Key, gone: bool) -> None:
        if gone:
            return listener.end()
        seen = self._seen[key]
        if seen.event != listener.sent:
            listener.sent = seen.event
            listener.offer({key[0]: seen.event})
        if seen.state in FINAL:
            listener.end()
        return None

    def _changes(self, followed: _Followed, members: Sequence[str]) -> dict[str, bytes]:
        """Of a project whose runs are `members` now: the active ones at the first look, then what changed."""
        now = {run_id: self._seen[run_id, False].event for run_id in members}
        if followed.looked:
            events = {run_id: text for run_id, text in now.items() if followed.told.get(run_id) != text}
        else:
            events = {run_id: text for run_id, text in now.items() if self._seen[run_id, False].state in ACTIVE}
        followed.told, followed.looked = now, True
        return events


async def _turn(told: int) -> int:
    """Let others have the event loop after every few."""
    if told < TOLD_AT_ONCE:
        return told + 1
    await asyncio.sleep(0.002)
    return 0


# -- in a thread


def _look(database: Database, plan: _Plan) -> _Look:
    with database.read() as session:
        watch = WatchRepository(session)
        marks = watch.marks({run_id for run_id, _ in plan.runs})
        scopes, members = dict(plan.runs), {}
        for project, (scope, before) in plan.projects.items():
            found = watch.of_project(project, NEWEST, MOST_ACTIVE)
            active = (each for each in before if plan.seen[each, False].state in ACTIVE)
            ended = [run_id for run_id in active if run_id not in found]
            found |= watch.marks(ended) if ended else {}
            marks |= found
            members[project] = tuple(sorted(found))
            scopes |= {(run_id, False): scope for run_id in found}
        at_work = watch.at_work()
        whole = {run_id: mark + at_work.get(run_id, ()) for run_id, mark in marks.items()}
        read = _read(session, plan, scopes, whole)
    here = {
        project: tuple(each for each in ids if (each, False) in read or (each, False) in plan.seen)
        for project, ids in members.items()
    }
    return _Look(read, {key for key in plan.runs if key[0] not in whole}, here)


def _read(session: Session, plan: _Plan, scopes: dict[Key, Scope], marks: dict[str, Mark]) -> dict[Key, Seen]:
    """The runs that are to be read anew."""
    now = time.monotonic()
    due, older = [], []
    for key in scopes:
        seen, mark = plan.seen.get(key), marks.get(key[0])
        if mark is None:
            continue
        if seen is None or seen.mark != mark or key in plan.joined:
            due.append(key)
        elif plan.estimate and seen.state in ACTIVE and now - seen.read_at > ESTIMATE_SECONDS:
            older.append(key)
    older.sort(key=lambda key: plan.seen[key].read_at)
    due += [key for key in older if key in plan.runs][:ESTIMATES]
    due += [key for key in older if key not in plan.runs][:OF_PROJECTS]
    groups: defaultdict[tuple[str, bool], list[str]] = defaultdict(list)
    for run_id, shared in due:
        groups[scopes[run_id, shared].project_id, shared].append(run_id)
    read: dict[Key, Seen] = {}
    for (_, shared), ids in groups.items():
        scope = scopes[ids[0], shared]
        scope = replace(scope, user_id=None, run_ids=tuple(ids) if shared else None)
        for view in RunRepository(session, scope).views(ids):
            run = view.run
            event = event_of(info(view).model_dump_json())
            read[run.id, shared] = Seen(marks[run.id], run.state, event, now)
    return read
