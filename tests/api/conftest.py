"""The API in this process, over SQLite and files in a folder of the test's own; no worker."""

from __future__ import annotations

import shutil
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from api.main import create_app
from store import migrations
from store.database import Database
from store.settings import Settings

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # Starlette deprecates httpx under its test client
    from fastapi import testclient

    class TestClient(testclient.TestClient):
        """A client on this machine, as the one person of a service without accounts has it."""

        __test__ = False

        def __init__(self, *arguments: Any, **named: Any):
            super().__init__(*arguments, **{"client": ("127.0.0.1", 50_000)} | named)


ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def migrated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("migrated") / "slowdrift.db"
    database = Database(f"sqlite:///{path}")
    migrations.upgrade(database)
    database.close()
    return path


@pytest.fixture
def service_settings(tmp_path: Path, migrated: Path) -> Settings:
    shutil.copy(migrated, tmp_path / "slowdrift.db")
    return Settings(data_dir=tmp_path, preview_seconds=0.2, solver="tests.service.fake_solver")


@pytest.fixture
def client(service_settings: Settings) -> Iterator[TestClient]:
    app = create_app(service_settings, reconcile=False)
    with TestClient(app, base_url="http://localhost") as client:
        yield client


@pytest.fixture
def database(service_settings: Settings) -> Iterator[Database]:
    database = Database(service_settings.database)
    yield database
    database.close()


@pytest.fixture
def riser() -> str:
    return (ROOT / "examples" / "hanging-riser-case1.yaml").read_text()


@pytest.fixture
def fpso() -> str:
    return (ROOT / "examples" / "fpso-2000m.yaml").read_text()
