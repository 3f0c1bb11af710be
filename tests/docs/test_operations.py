"""docs/operations.md names every setting with its default, and every metric."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from api.metrics import Metrics
from store import migrations
from store.database import Database
from store.settings import Settings

TEXT = (Path(__file__).resolve().parents[2] / "docs" / "operations.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", Settings.model_fields)
def test_every_setting_has_its_line_and_its_default(name: str) -> None:
    found = re.search(rf"^\| `SLOWDRIFT_{name.upper()}` \| ([^|]*) \|", TEXT, re.MULTILINE)
    assert found, f"SLOWDRIFT_{name.upper()} is missing"
    default = Settings.model_fields[name].default
    if isinstance(default, int | float) and not isinstance(default, bool):
        assert float(found.group(1)) == default


def test_every_metric_is_named(tmp_path: Path) -> None:
    database = Database(f"sqlite:///{tmp_path / 'slowdrift.db'}")
    migrations.upgrade(database)
    families = re.findall(r"^# TYPE (slowdrift_\w+) ", Metrics(database).text().decode(), re.MULTILINE)
    database.close()
    assert len(families) >= 8
    for name in families:
        if not name.endswith(("_created", "_database_seconds")):
            assert name in TEXT, name
