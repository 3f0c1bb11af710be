"""People's rows on both databases: what must hold when two requests come at once."""

from __future__ import annotations

import threading
from collections.abc import Callable
from datetime import timedelta

from store.clock import utc_now
from store.database import Database
from store.errors import ConflictError, NotFoundError, SlowdriftError
from store.models import DEFAULT_TEAM
from store.people import EDITOR, OWNER, READ, VIEWER, ApiKey, Invitation, User
from store.repositories.accounts import AccountRepository
from store.repositories.entry import EntryRepository
from store.repositories.teams import TeamRepository


def add(database: Database, *names: str, role: str = OWNER) -> list[User]:
    with database.write() as session:
        users = [AccountRepository(session).add(f"{name}@x.org", name, None, True) for name in names]
        for user in users:
            TeamRepository(session).join(DEFAULT_TEAM, user.id, role)
    return users


def at_once(*calls: Callable[[], None]) -> list[Exception | None]:
    """How each ended, when all begin together."""
    gate, ended = threading.Barrier(len(calls)), [None] * len(calls)

    def run(number: int, call: Callable[[], None]) -> None:
        gate.wait()
        try:
            call()
        except SlowdriftError as error:
            ended[number] = error  # type: ignore[call-overload]

    threads = [threading.Thread(target=run, args=item) for item in enumerate(calls)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return list(ended)


def test_an_invitation_is_used_once(database: Database) -> None:
    users = add(database, "a", "b", role=VIEWER)
    with database.write() as session:
        team = TeamRepository(session).add("second", None)
        later = utc_now() + timedelta(hours=1)
        TeamRepository(session).invite(Invitation(team_id=team.id, role=EDITOR, digest="d" * 64, expires_at=later))

    def accept(user: User) -> None:
        with database.write() as session:
            teams = TeamRepository(session)
            row = teams.invitation("d" * 64)
            teams.join(team.id, user.id, row.role)
            teams.use(row, user.id)

    ended = at_once(*(lambda user=user: accept(user) for user in users))  # type: ignore[misc]
    assert sorted(error is None for error in ended) == [False, True]
    assert all(isinstance(error, NotFoundError | ConflictError) for error in ended if error)
    with database.read() as session:
        assert len(TeamRepository(session).members(team.id)) == 1


def test_two_owners_cannot_both_leave(database: Database) -> None:
    users = add(database, "a", "b")

    def leave(user: User) -> None:
        with database.write() as session:
            TeamRepository(session).remove(DEFAULT_TEAM, user.id)

    ended = at_once(*(lambda user=user: leave(user) for user in users))  # type: ignore[misc]
    assert sorted(error is None for error in ended) == [False, True]
    with database.read() as session:
        assert len(TeamRepository(session).members(DEFAULT_TEAM)) == 1


def test_the_same_address_twice(database: Database) -> None:
    def make() -> None:
        with database.write() as session:
            AccountRepository(session).add("a@x.org", "A", None, False)

    ended = at_once(make, make, make)
    assert sorted(error is None for error in ended) == [False, False, True]
    assert all(isinstance(error, ConflictError) for error in ended if error)


def test_sessions_and_homes(database: Database) -> None:
    (user,) = add(database, "a", role=VIEWER)
    with database.write() as session:
        accounts, now = AccountRepository(session), utc_now()
        accounts.sign_in(user.id, "old", "", now - timedelta(seconds=1))
        accounts.sign_in(user.id, "good", "", now + timedelta(hours=1))
    with database.read() as session:
        entry = EntryRepository(session)
        assert entry.any_account()
        assert entry.signed_in("old") is None
        assert entry.signed_in("none") is None
        found = entry.signed_in("good")
        assert found is not None
        assert found[1].id == user.id
        assert [(home.team_name, home.role) for home in found[2]] == [("default", VIEWER)]
        assert list(found[2]) == entry.homes(user.id)
        assert [home.role for home in entry.all_homes()] == [OWNER]


def test_a_key_opens_its_users_teams_or_the_one_it_names(database: Database) -> None:
    (member,) = add(database, "a", role=VIEWER)
    with database.write() as session:
        accounts, teams = AccountRepository(session), TeamRepository(session)
        nobody = accounts.add("b@x.org", "b", None, False)
        second = teams.add("second", member.id).id
        for name, user, team in (
            ("all", member, None), ("one", member, second), ("none", nobody, None), ("not his", nobody, second),
        ):  # fmt: skip
            session.add(
                ApiKey(user_id=user.id, name=name, scope=READ, start="", digest=name, team_id=team)
            )  # one may have left the team since
    with database.read() as session:
        entry = EntryRepository(session)
        opened = {name: entry.key(name) for name in ("all", "one", "none", "not his", "other")}
    homes = {name: [(home.team_name, home.role) for home in found[2]] for name, found in opened.items() if found}
    assert homes == {
        "all": [("default", VIEWER), ("second", OWNER)],
        "one": [("second", OWNER)],
        "none": [],
        "not his": [],
    }


def test_a_team_goes_with_its_projects(database: Database) -> None:
    (user,) = add(database, "a")
    with database.write() as session:
        team = TeamRepository(session).add("second", user.id)
        TeamRepository(session).add_project(team.id, "another")
    with database.write() as session:
        assert [(row[0].name, row[1], row[2], row[3]) for row in TeamRepository(session).of(user.id)] == [
            ("default", OWNER, 1, 1),
            ("second", OWNER, 1, 2),
        ]
        TeamRepository(session).delete(team.id)
    with database.read() as session:
        assert [row[0].name for row in TeamRepository(session).of(user.id)] == ["default"]
