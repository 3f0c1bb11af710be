"""Keys and links are made with the secret of the API, or not at all."""

from __future__ import annotations

import uuid
from collections.abc import Iterator
from pathlib import Path

import pytest

from cli.main import main
from store.database import Database
from store.repositories.accounts import AccountRepository
from store.settings import Settings
from tests.service.conftest import create_database, drop_database, need

ADDRESS = "ada@example.org"
KEY_ADD = ["key", "add", ADDRESS, "nightly"]
LINKS = [["user", "add", "bob@example.org", "--link"], ["user", "reset-password", ADDRESS, "--link"], KEY_ADD]


@pytest.fixture
def server(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Settings]:
    """A database on a server with one account; this machine has no data folder."""
    need("PostgreSQL", 5432)
    name = f"sd_test_{uuid.uuid4().hex[:12]}"
    monkeypatch.setenv("SLOWDRIFT_DATABASE_URL", create_database(name))
    monkeypatch.setenv("SLOWDRIFT_DATA_DIR", str(tmp_path / "data"))
    monkeypatch.delenv("SLOWDRIFT_SECRET", raising=False)
    settings = Settings.from_env()
    assert main(["migrate"]) == 0
    database = Database(settings.database)
    with database.write() as session:
        AccountRepository(session).add(ADDRESS, "Ada", None, True)
    database.close()
    yield settings
    drop_database(name)


@pytest.mark.services
@pytest.mark.parametrize("command", LINKS, ids=" ".join)
def test_no_secret_is_made_beside_a_servers_database(
    server: Settings, command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(command) == 2
    said = capsys.readouterr().err
    assert "SLOWDRIFT_SECRET is not set" in said
    assert "--data-dir" in said
    assert not (server.data_dir / "secret").exists()
    assert main(["user", "list"]) == 0  # needs no secret
    assert "bob@example.org" not in capsys.readouterr().out  # nothing was changed


@pytest.mark.services
@pytest.mark.parametrize("kept", [True, False])
def test_the_secret_of_the_api_will_do(server: Settings, kept: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if kept:
        server.data_dir.mkdir()
        (server.data_dir / "secret").write_text("k" * 64)
    else:
        monkeypatch.setenv("SLOWDRIFT_SECRET", "s" * 64)
    for command in LINKS:
        assert main(command) == 0
    assert (server.data_dir / "secret").exists() == kept


def test_the_embedded_database_has_its_secret_beside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """There the API's data folder is this one, whoever comes first."""
    monkeypatch.delenv("SLOWDRIFT_SECRET", raising=False)
    folder = ["--data-dir", str(tmp_path)]
    assert main(["user", "add", ADDRESS, "--link", *folder]) == 0
    assert main([*KEY_ADD, *folder]) == 0
    assert len((tmp_path / "secret").read_text()) == 64
