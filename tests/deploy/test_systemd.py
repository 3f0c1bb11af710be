"""The units of systemd: systemd's own check, and commands and variables that are ours."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from store.settings import Settings

from .tools import DEPLOY, comments, our_commands, understood

UNITS = ("slowdrift-api.service", "slowdrift-worker@.service")
INSTANCES = ("runs", "interactive", "hydrodynamics")


class Unit:
    """A key may stand several times: its values, in order."""

    def __init__(self, path: Path):
        self.values_of: dict[str, list[str]] = {}
        for line in path.read_text().splitlines():
            key, found, value = line.partition("=")
            if found and not line.startswith("#"):
                self.values_of.setdefault(key, []).append(value)

    def one(self, key: str) -> str:
        [value] = self.values_of[key]
        return value


@pytest.mark.parametrize("name", UNITS)
def test_systemd_takes_it(name: str, tmp_path: Path) -> None:
    if not shutil.which("systemd-analyze"):
        pytest.skip("no systemd-analyze")
    text = (DEPLOY / name).read_text()
    text = text.replace("/opt/slowdrift/bin/slowdrift", "/bin/true").replace("User=slowdrift", "User=root")
    placed = tmp_path / name
    placed.write_text(text)
    done = subprocess.run(["systemd-analyze", "verify", "--man=no", str(placed)], capture_output=True, text=True)
    said = [line for line in done.stderr.splitlines() if name.partition("@")[0].partition(".")[0] in line]
    assert said == []
    placed.write_text(text.replace("RestartSec=2", "RestartSec=soon"))
    done = subprocess.run(["systemd-analyze", "verify", "--man=no", str(placed)], capture_output=True, text=True)
    assert "Failed to parse sec value" in done.stderr


@pytest.mark.parametrize("name", UNITS)
def test_commands_and_variables_are_ours(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    unit = Unit(DEPLOY / name)
    values = dict(pair.split("=", 1) for line in unit.values_of["Environment"] for pair in line.split())
    for variable in values:
        if variable.startswith("SLOWDRIFT_"):
            assert variable.removeprefix("SLOWDRIFT_").lower() in Settings.model_fields
    for instance in INSTANCES if "@" in name else ("",):
        line = unit.one("ExecStart").replace("%i", instance)
        line = re.sub(r"\$\{(\w+)\}", lambda found: values[found.group(1)], line)
        program, *arguments = shlex.split(line)
        assert program == "/opt/slowdrift/bin/slowdrift"
        understood(arguments, monkeypatch)


@pytest.mark.parametrize("name", UNITS)
def test_what_it_may_do(name: str) -> None:
    unit = Unit(DEPLOY / name)
    assert unit.one("User") == "slowdrift"
    assert unit.one("UMask") == "0077"
    assert unit.one("NoNewPrivileges") == "yes"
    assert unit.one("ProtectSystem") == "strict"
    assert unit.one("CapabilityBoundingSet") == ""
    folder = dict(pair.split("=", 1) for line in unit.values_of["Environment"] for pair in line.split())
    assert folder["SLOWDRIFT_DATA_DIR"] == f"/var/lib/{unit.one('StateDirectory')}"
    assert folder["NUMBA_CACHE_DIR"] == f"/var/cache/{unit.one('CacheDirectory')}"
    assert "MemoryDenyWriteExecute" not in unit.values_of, "numba makes code at run time"
    assert unit.one("EnvironmentFile") == "/etc/slowdrift/slowdrift.env"


def test_the_example_of_the_settings() -> None:
    lines = [line for line in (DEPLOY / "slowdrift.env.example").read_text().splitlines() if not line.startswith("#")]
    values = dict(line.split("=", 1) for line in lines)
    settings = Settings.from_env(values)
    assert settings.behind_proxy
    assert values["SLOWDRIFT_SECRET"] == ""
    assert set(values) == {f"SLOWDRIFT_{n.removeprefix('SLOWDRIFT_')}" for n in values}


def test_what_they_tell_people_to_type(monkeypatch: pytest.MonkeyPatch) -> None:
    text = comments(DEPLOY / UNITS[0])
    for unit in re.findall(r"slowdrift-worker@(\w+)", text):
        assert unit in INSTANCES
    commands = our_commands(text)
    assert commands == [["user", "add", "ada@example.org", "--admin"]]
    understood(commands[0], monkeypatch)
