"""Shares within a priority: users and teams get alike, whoever came first and however much they have queued."""

from __future__ import annotations

from collections import Counter

import pytest

from solver.results.part import Chunk
from store.database import Database
from store.models import Project, Run, Team
from store.priority import BATCH, INTERACTIVE, NORMAL
from store.repositories import CaseRepository, RunRepository, TaskRepository
from store.repositories.cases import NewCase
from store.repositories.runs import Labels
from store.scope import Scope

HERE = "a" * 32, "b" * 32
THERE = "c" * 32, "d" * 32


@pytest.fixture
def teams(database: Database, monkeypatch: pytest.MonkeyPatch) -> Database:
    monkeypatch.setattr("store.recent.SECONDS", 0.0)
    with database.write() as session:
        for team, project in (HERE, THERE):
            session.add(Team(id=team, name=team[:3]))
            session.flush()
            session.add(Project(id=project, team_id=team, name="a project"))
    return database


def scope(place: tuple[str, str], user: str) -> Scope:
    return Scope(*place, user_id=user * 32)


def queue(database: Database, who: Scope, runs: int, weight: float = 1.0, priority: int = BATCH) -> None:
    with database.write() as session:
        version, _ = CaseRepository(session, who).save(NewCase("c", "h" * 64, "{}", "x: 1"))
        for _ in range(runs):
            chunks = [Chunk("frequency", weight=weight)]
            RunRepository(session, who).create(version, ["statics"], chunks, labels=Labels(priority=priority))


def served(database: Database, count: int) -> list[str]:
    """Whose tasks are claimed, one after the other: first letters of the users."""
    found = []
    for _ in range(count):
        with database.write() as session:
            ticket = TaskRepository(session).claim_next("runs", "host/1/2", 60, 3)
            assert ticket is not None
            found.append((session.get_one(Run, ticket.run_id).created_by or "-")[0])
    return found


def test_one_user_is_served_in_order(teams: Database) -> None:
    queue(teams, scope(HERE, "1"), 10)
    with teams.write() as session:
        taken = [TaskRepository(session).claim_next("runs", "w", 60, 3) for _ in range(10)]
    ids = [ticket.task_id for ticket in taken if ticket]
    assert ids == sorted(ids)


def test_a_late_user_does_not_wait_for_all_that_was_there(teams: Database) -> None:
    queue(teams, scope(HERE, "1"), 60)
    first = served(teams, 10)
    queue(teams, scope(THERE, "2"), 5)
    later = served(teams, 12)
    assert first == ["1"] * 10
    assert later.count("2") == 5


def test_users_of_a_team_share_what_the_team_gets(teams: Database) -> None:
    queue(teams, scope(THERE, "3"), 60)
    for runs in (1, 60):
        for user in ("1", "2"):
            queue(teams, scope(HERE, user), runs)
    queue(teams, scope(HERE, "1"), 30)  # more of the same changes no share
    shares = Counter(served(teams, 60))
    assert 28 <= shares["3"] <= 32
    assert 13 <= shares["2"] <= 17


def test_shares_are_of_work_not_of_runs(teams: Database) -> None:
    queue(teams, scope(HERE, "1"), 40, weight=10.0)
    queue(teams, scope(THERE, "2"), 40, weight=1.0)
    shares = Counter(served(teams, 33))
    assert shares == {"1": 3, "2": 30} or shares == {"1": 4, "2": 29}


def test_numbers_of_a_moment_ago_keep_the_order(teams: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("store.recent.SECONDS", 60.0)
    queue(teams, scope(HERE, "1"), 10)
    queue(teams, scope(THERE, "2"), 10)
    with teams.write() as session:
        taken = [TaskRepository(session).claim_next("runs", "w", 60, 3) for _ in range(20)]
        users = [(session.get_one(Run, ticket.run_id).created_by or "-")[0] for ticket in taken if ticket]
    assert Counter(users[:10]) == {"1": 5, "2": 5}
    for user in ("1", "2"):
        ids = [ticket.task_id for ticket, whose in zip(taken, users, strict=True) if ticket and whose == user]
        assert ids == sorted(ids)


def test_priority_comes_before_shares(teams: Database) -> None:
    queue(teams, scope(HERE, "1"), 5, priority=NORMAL)
    queue(teams, scope(THERE, "2"), 5, priority=BATCH)
    queue(teams, scope(HERE, "3"), 2, priority=INTERACTIVE)
    assert served(teams, 12) == ["3"] * 2 + ["1"] * 5 + ["2"] * 5
