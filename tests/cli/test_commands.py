"""The commands as a person types them: help, refusals, and what they leave behind."""

from __future__ import annotations

import socket
import subprocess
from pathlib import Path

import pytest

from cli import options, serve
from cli.main import main
from store.settings import Settings, SettingsError
from tests.service.running import ROOT, command, environment


def slowdrift(tmp_path: Path, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    env = environment(Settings(data_dir=tmp_path)) | variables
    return subprocess.run(command(*arguments), env=env, capture_output=True, text=True, timeout=60, check=False)


def test_help_names_the_commands(tmp_path: Path) -> None:
    done = slowdrift(tmp_path, "--help")
    assert done.returncode == 0
    for name in ("run", "serve", "worker", "demo", "migrate"):
        assert f"\n    {name} " in done.stdout
    assert "{api" not in done.stdout


def test_help_of_run_explains_every_option_and_status(tmp_path: Path) -> None:
    text = " ".join(slowdrift(tmp_path, "run", "--help").stdout.split())
    options = ("--json", "--out", "--channels", "--layout", "--only", "--seeds", "--duration", "--quiet")
    for option in options:
        assert text.count(option) >= 2, option  # in the usage and with its help
    for ending in (".nc", ".h5", ".csv", ".parquet", ".xlsx"):
        assert ending in text
    for status in ("0 done", "2 the case is wrong", "3 an analysis did not converge", "130 stopped"):
        assert status in text


def test_other_machines_are_refused_without_accounts(tmp_path: Path) -> None:
    done = slowdrift(tmp_path, "serve", "--host", "0.0.0.0", "--port", "0")
    assert done.returncode == 2
    assert "no accounts yet" in done.stderr
    assert "--allow-no-login" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("option", "value", "named"),
    [
        ("--public-url", "https://slowdrift.example.org", "SLOWDRIFT_PUBLIC_URL"),
        ("--forwarded-allow-ips", "127.0.0.1", "SLOWDRIFT_FORWARDED_ALLOW_IPS"),
    ],
)
def test_a_proxy_is_refused_without_accounts(tmp_path: Path, option: str, value: str, named: str) -> None:
    done = slowdrift(tmp_path, "serve", option, value, "--port", "0")
    assert done.returncode == 2
    assert f"The settings name a proxy ({named}), and there are no accounts yet" in done.stderr
    assert "--setup" in done.stderr


def test_the_public_name_is_one_of_ours() -> None:
    assert "slowdrift.example.org" in Settings(public_url="https://slowdrift.example.org:8443").hosts
    assert Settings().hosts == ["127.0.0.1", "localhost", "::1"]


@pytest.mark.parametrize(
    ("host", "loopback"),
    [
        ("127.0.0.1", True),
        ("::1", True),
        ("localhost", True),
        ("0.0.0.0", False),
        ("10.1.2.3", False),
        ("example.org", False),
    ],
)
def test_what_counts_as_this_machine(host: str, loopback: bool) -> None:
    assert options.is_loopback(host) is loopback


def test_a_taken_port_is_a_clear_sentence() -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        with pytest.raises(
            options.RefusedError, match=f"port {port} on 127.0.0.1 cannot be used: Address already in use"
        ):
            options.bind("127.0.0.1", port)


def test_wrong_settings_are_named(tmp_path: Path) -> None:
    done = slowdrift(tmp_path, "migrate", SLOWDRIFT_LEASE_SECONDS="soon")
    assert done.returncode == 2
    assert "SLOWDRIFT_LEASE_SECONDS" in done.stderr
    with pytest.raises(SettingsError, match="QUEUE_PREFIX"):
        Settings.from_env({"SLOWDRIFT_QUEUE_PREFIX": "a b"})
    assert Settings.from_env({"SLOWDRIFT_DATABASE_URL": "postgres://a@b/c"}).database == "postgresql+psycopg://a@b/c"


def test_migrate_and_check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("SLOWDRIFT_DATA_DIR", str(tmp_path))
    assert main(["worker", "--check"]) == 2
    assert "slowdrift migrate" in capsys.readouterr().err
    assert main(["migrate"]) == 0
    assert main(["worker", "--check"]) == 0
    monkeypatch.setenv("SLOWDRIFT_BROKER_URL", "redis://127.0.0.1:1/0")
    assert main(["worker", "--check"]) == 2
    assert "the broker cannot be reached" in capsys.readouterr().err


def test_the_settings_are_all_documented() -> None:
    text = (ROOT / "docs" / "operations.md").read_text()
    for name in Settings.model_fields:
        assert f"`SLOWDRIFT_{name.upper()}`" in text, name


@pytest.mark.parametrize("capytaine", [True, False])
def test_the_supervisor_has_no_worker_when_told(monkeypatch: pytest.MonkeyPatch, capytaine: bool) -> None:
    import argparse

    monkeypatch.setattr(serve.importlib.util, "find_spec", lambda _name: object() if capytaine else None)

    parser = argparse.ArgumentParser()
    serve.add_options(parser)
    given = parser.parse_args(["--workers", "0", "--no-pages"])
    assert [child.name for child in serve._children(given, 3, 8000)] == ["api"]
    hulls = ["hydrodynamics"] if capytaine else []
    names = [child.name for child in serve._children(parser.parse_args([]), 3, 8000)]
    assert names == ["api", "worker", "interactive", *hulls]


def test_several_api_processes_share_the_port_and_one_is_the_first(capsys: pytest.CaptureFixture[str]) -> None:
    import argparse

    parser = argparse.ArgumentParser()
    serve.add_options(parser)
    given = parser.parse_args(["--workers", "0", "--api-processes", "3"])
    children = serve._children(given, 3, 8000)
    assert [child.name for child in children] == ["api", "api-2", "api-3"]
    assert [child.descriptors for child in children] == [(3,)] * 3
    assert ["--beside" in child.arguments for child in children] == [False, True, True]
    for wrong in ("0", "65", "two", "-1"):
        with pytest.raises(SystemExit):
            parser.parse_args(["--api-processes", wrong])
        assert f"{wrong!r} is not a number of processes from 1 to 64" in capsys.readouterr().err
