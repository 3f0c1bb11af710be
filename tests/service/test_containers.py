"""docker-compose.yml and Dockerfile: well formed, and their commands are ours. (They run in test_all_kinds.)"""

from __future__ import annotations

from typing import Any

import pytest
import yaml

from cli.main import main
from store.settings import Settings

from .running import ROOT

COMPOSE: dict[str, Any] = yaml.safe_load((ROOT / "docker-compose.yml").read_text())


def test_services() -> None:
    services = COMPOSE["services"]
    assert set(services) == {"api", "worker", "interactive", "hydrodynamics", "postgres", "redis"}
    for name, service in services.items():
        assert service["healthcheck"]["test"], name
        assert service.get("image"), name
        assert "container_name" not in service, "a name would forbid --scale"
        assert all(str(port).startswith("127.0.0.1:") for port in service.get("ports", [])), name
    assert "ports" not in services["worker"]


def test_variables_are_settings() -> None:
    for service in ("api", "worker", "interactive", "hydrodynamics"):
        for name in COMPOSE["services"][service]["environment"]:
            assert name.removeprefix("SLOWDRIFT_").lower() in Settings.model_fields


@pytest.mark.parametrize("service", ["api", "worker", "interactive", "hydrodynamics"])
def test_commands_are_understood(service: str, monkeypatch: pytest.MonkeyPatch) -> None:
    import cli.serve
    import cli.worker

    called: list[Any] = []
    monkeypatch.setattr(cli.serve, "serve", lambda options: called.append(options) or 0)
    monkeypatch.setattr(cli.worker, "work", lambda options: called.append(options) or 0)
    command = COMPOSE["services"][service]["command"]
    assert command[0] == "slowdrift"
    assert main(command[1:]) == 0
    assert len(called) == 1


def test_the_image_runs_as_nobody_special() -> None:
    lines = (ROOT / "Dockerfile").read_text().splitlines()
    assert "USER slowdrift" in lines
    assert lines.index("USER slowdrift") > max(i for i, line in enumerate(lines) if line.startswith("FROM"))
    copied = [line.split()[1] for line in lines if line.startswith("COPY") and "--from" not in line]
    ignored = (ROOT / ".dockerignore").read_text().splitlines()
    for path in copied:
        assert f"!{path}" in ignored or path == "pyproject.toml", path
