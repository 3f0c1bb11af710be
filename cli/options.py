"""Options and refusals that commands share."""

from __future__ import annotations

import argparse
import ipaddress
import os
import socket
import sys
from collections.abc import Mapping
from pathlib import Path

from store.settings import Settings, SettingsError

OPEN_FILES = 65_536


class RefusedError(Exception):
    """The command cannot be carried out; the text is one sentence with a remedy."""


def say(text: str) -> None:
    print(text, flush=True)


def refuse(error: Exception) -> int:
    print(f"slowdrift: {error}", file=sys.stderr, flush=True)
    return 2


def add_data_dir(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--data-dir", type=Path, metavar="DIR", help="folder of database, messages and logs (default: .slowdrift)"
    )


def read_settings(data_dir: Path | None, extra: Mapping[str, str] | None = None) -> Settings:
    """Settings from the environment, options over them. Raises RefusedError."""
    environ = dict(os.environ) | dict(extra or {})
    if data_dir is not None:
        environ["SLOWDRIFT_DATA_DIR"] = str(data_dir)
    environ["SLOWDRIFT_DATA_DIR"] = str(Path(environ.get("SLOWDRIFT_DATA_DIR") or ".slowdrift").absolute())
    try:
        return Settings.from_env(environ)
    except SettingsError as error:
        raise RefusedError(str(error)) from None


def raise_open_files() -> int:
    """Allow this process as many open files as the system lets it; the number."""
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = OPEN_FILES if hard == resource.RLIM_INFINITY else min(hard, OPEN_FILES)
    if soft == resource.RLIM_INFINITY or soft >= wanted:
        return wanted
    try:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
    except (OSError, ValueError):  # some systems have a lower bound of their own
        return soft
    return wanted


def is_loopback(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


def bind(host: str, port: int) -> socket.socket:
    """A bound socket for the service. Raises RefusedError."""
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, kind, protocol)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen(2048)
    except OSError as error:
        raise RefusedError(
            f"port {port} on {host} cannot be used: {error.strerror}. "
            "Another program may have it; end that one, or choose another with --port."
        ) from None
    return listener
