"""A few of the faults, with a few runs (the whole: `python -m tests.service.faults`, docs/operations.md)."""

from __future__ import annotations

from pathlib import Path

import pytest

from .conftest import need
from .faults.campaign import campaign
from .faults.faults import FAULTS
from .faults.rig import MissingError

pytestmark = [pytest.mark.services, pytest.mark.slow]


@pytest.mark.parametrize(
    ("kind", "fault"),
    [
        ("embedded", "disk full"),
        ("postgres-redis", "API killed in submissions"),
        ("postgres-redis", "broker killed, data lost"),
        ("postgres-redis", "database killed"),
    ],
)
def test_every_accepted_run_ends_once_with_its_numbers(kind: str, fault: str, tmp_path: Path) -> None:
    if kind != "embedded":
        need("PostgreSQL", 5432)
    try:
        tally = campaign(kind, fault, FAULTS[fault], 20, tmp_path)
    except MissingError as error:
        pytest.skip(str(error))
    assert not tally.wrong, tally
    assert (tally.accepted, tally.failed) == (20, FAULTS[fault].hogs)
    assert tally.seconds_after < 70


@pytest.mark.parametrize("kind", ["embedded"])
def test_a_quick_run_does_not_wait_for_the_long_one_at_hand(kind: str, tmp_path: Path) -> None:
    """One worker, busy for a minute: an interactive run is done by the other process."""
    import time

    from .faults.rig import rig
    from .running import a_case, service, submit, wait_for, wait_until

    with rig(kind, tmp_path) as made:
        from store import migrations
        from store.database import Database

        migrations.upgrade(Database(made.settings.database))
        with service(made.settings, False, "--workers", "1") as client:
            wait_for(client, submit(client, a_case("warm")), 60)
            body = {"case": a_case("long", seconds=60), "priority": "normal"}
            long = client.post("/api/v1/runs", json=body).json()["id"]
            wait_until(lambda: client.get(f"/api/v1/runs/{long}").json()["state"] == "running", 10)
            began = time.monotonic()
            wait_for(client, submit(client, a_case("quick")), 30)
            assert time.monotonic() - began < 8
            assert client.get(f"/api/v1/runs/{long}").json()["state"] == "running"
            client.post(f"/api/v1/runs/{long}/cancel")
            wait_for(client, long)
