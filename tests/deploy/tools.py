"""What the tests of deployment files share: the commands in their comments, and commands of ours that only parse."""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

import cli.key
import cli.migrate
import cli.serve
import cli.user
import cli.worker
from cli.main import main

ROOT = Path(__file__).resolve().parents[2]
DEPLOY = ROOT / "deploy"
NPM = ROOT / "tests" / "npm" / "node_modules"


def missing(what: str) -> None:
    """Skip, saying so; fail where SLOWDRIFT_REQUIRE_SERVICES is set."""
    if os.environ.get("SLOWDRIFT_REQUIRE_SERVICES") == "1":
        pytest.fail(what)
    pytest.skip(what)


def npm(package: str) -> Path:
    """The folder of a package from npm."""
    if not (NPM / package).is_dir():
        missing(f"no {package}: run npm ci --prefix tests/npm")
    return NPM / package


def comments(path: Path) -> str:
    return "\n".join(line[1:].strip() for line in path.read_text().splitlines() if line.startswith("#"))


def our_commands(text: str) -> list[list[str]]:
    """The arguments of each `slowdrift …` that a text tells people to type."""
    found = re.findall(
        r"(?:^|[\s`/])slowdrift ((?:serve|user|key|migrate|worker|backup)\b[^`\n;]*)", text, re.MULTILINE
    )
    return [shlex.split(one) for one in found]


def understood(arguments: list[str], monkeypatch: pytest.MonkeyPatch) -> Any:
    """What our command line makes of it; it carries nothing out."""
    called: list[Any] = []
    functions = (
        (cli.serve, "serve"),
        (cli.worker, "work"),
        (cli.user, "user"),
        (cli.key, "key"),
        (cli.migrate, "migrate"),
    )
    for module, name in functions:
        monkeypatch.setattr(module, name, lambda options: called.append(options) or 0)
    assert main(arguments) == 0, arguments
    assert len(called) == 1, arguments
    return called[0]
