"""Servers of our own, to be killed, emptied and filled: PostgreSQL, Redis, RabbitMQ; and a small disk."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
import tempfile
import time
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sqlalchemy import create_engine, text

from store.settings import Settings

from ..running import free_port

POSTGRES_BIN = next(iter(sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True)), Path("/usr/bin"))
RABBITMQ_BIN = Path("/usr/lib/rabbitmq/bin")
DISK_MB = 300


class MissingError(Exception):
    """This machine has not what a fault needs; the text says what."""


@dataclass
class Server:
    """A process that can be killed and started again, with its data or without."""

    name: str
    command: list[str]
    folder: Path
    ready: Callable[[], bool]
    environment: dict[str, str] = field(default_factory=dict)
    prepare: Callable[[], None] = lambda: None
    user: dict[str, Any] = field(default_factory=dict)
    """For `subprocess`: whose process it is, where not ours."""
    process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        self.prepare()
        log = (self.folder.parent / f"{self.name}.log").open("ab")
        self.process = subprocess.Popen(
            self.command, env=os.environ | self.environment, stdout=log, stderr=log, start_new_session=True, **self.user
        )
        deadline = time.monotonic() + 60
        while not self.ready():
            if time.monotonic() > deadline or self.process.poll() is not None:
                raise MissingError(f"{self.name} does not start; see {log.name}")
            time.sleep(0.1)

    def kill(self, forget: bool = False) -> None:
        """As if the power had gone; with `forget`, the disk as well."""
        if self.process is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
            self.process = None
        if forget:
            shutil.rmtree(self.folder, ignore_errors=True)

    def alive(self) -> bool:
        return self.process is not None and self.process.poll() is None


@dataclass
class Rig:
    """Everything that one service under test stands on."""

    kind: str
    root: Path
    settings: Settings
    postgres: Server | None = None
    broker: Server | None = None
    disk: Path | None = None

    @property
    def clock_file(self) -> Path:
        """Seconds by which every Python process of the service has its clock put forward."""
        return self.root / "clock"


@contextlib.contextmanager
def _open_folder() -> Iterator[str]:
    """A folder that another user may enter, as PostgreSQL's must: a test's own folder is closed to all but its user."""
    with tempfile.TemporaryDirectory(prefix="slowdrift-rig-", ignore_cleanup_errors=True) as name:
        os.chmod(name, 0o755)
        yield name


def _postgres(folder: Path) -> tuple[Server, str]:
    if not (POSTGRES_BIN / "initdb").exists():
        raise MissingError("no PostgreSQL server is installed here")
    port = free_port()
    url = f"postgresql+psycopg://postgres@127.0.0.1:{port}/postgres"
    user = {"user": "postgres", "group": "postgres", "extra_groups": []} if os.getuid() == 0 else {}  # never as root

    def prepare() -> None:
        if (folder / "PG_VERSION").exists():
            (folder / "postmaster.pid").unlink(missing_ok=True)
            return
        if user:
            shutil.chown(folder, "postgres")
        initdb = [str(POSTGRES_BIN / "initdb"), "-A", "trust", "-U", "postgres", "-N", "-D", str(folder)]
        subprocess.run(initdb, check=True, capture_output=True, cwd="/", **user)
        with (folder / "postgresql.conf").open("a") as file:
            file.write(
                f"port={port}\nlisten_addresses='127.0.0.1'\nunix_socket_directories=''\nmax_connections=200\n"
                "max_wal_size=64MB\nmin_wal_size=32MB\n"
            )

    def ready() -> bool:
        engine = create_engine(url)
        try:
            with engine.connect() as connection:
                connection.execute(text("SELECT 1"))
        except Exception:
            return False
        finally:
            engine.dispose()
        return True

    command = [str(POSTGRES_BIN / "postgres"), "-D", str(folder)]
    return Server("postgres", command, folder, ready, prepare=prepare, user=user), url


def _redis(folder: Path) -> tuple[Server, str]:
    if shutil.which("redis-server") is None:
        raise MissingError("no redis-server is installed here")
    port = free_port()
    command = ["redis-server", "--port", str(port), "--save", "", "--appendonly", "no", "--dir", str(folder)]
    return Server("redis", command, folder, lambda: _listens(port)), f"redis://127.0.0.1:{port}/0"


def _rabbitmq(folder: Path) -> tuple[Server, str]:
    program = RABBITMQ_BIN / "rabbitmq-server"
    if not program.exists():
        raise MissingError("no RabbitMQ server is installed here")
    port, name = free_port(), uuid.uuid4().hex[:8]
    environment = {
        "HOME": str(folder.parent),
        "RABBITMQ_NODENAME": f"sd{name}@localhost",
        "RABBITMQ_CONFIG_FILE": str(folder.parent / "rabbitmq.conf"),
        "RABBITMQ_DIST_PORT": str(free_port()),
        "RABBITMQ_MNESIA_BASE": str(folder),
        "RABBITMQ_LOG_BASE": str(folder.parent),
        "RABBITMQ_ENABLED_PLUGINS_FILE": str(folder.parent / "no-plugins"),
        "RABBITMQ_SERVER_ADDITIONAL_ERL_ARGS": "+S 1:1",
    }

    def prepare() -> None:
        (folder.parent / "rabbitmq.conf").write_text(f"listeners.tcp.1 = 127.0.0.1:{port}\n")
        (folder.parent / "no-plugins").write_text("[].\n")

    server = Server("rabbitmq", [str(program)], folder, lambda: _answers_amqp(port), environment, prepare)
    return server, f"amqp://guest:guest@127.0.0.1:{port}//"


def _listens(port: int) -> bool:
    import socket

    try:
        socket.create_connection(("127.0.0.1", port), 0.5).close()
    except OSError:
        return False
    return True


def _answers_amqp(port: int) -> bool:
    from kombu import Connection

    try:
        with Connection(f"amqp://guest:guest@127.0.0.1:{port}//", connect_timeout=2) as connection:
            connection.connect()
    except Exception:
        return False
    return True


@contextlib.contextmanager
def small_disk(path: Path) -> Iterator[Path]:
    """A file system of its own, in memory, that can be filled without harm."""
    path.mkdir(parents=True, exist_ok=True)
    done = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={DISK_MB}m,mode=777", "tmpfs", str(path)],
        capture_output=True,
        check=False,
    )
    if done.returncode:
        raise MissingError("this process may not mount a file system, so no disk can be filled")
    try:
        yield path
    finally:
        for _ in range(20):
            if not subprocess.run(["umount", str(path)], capture_output=True, check=False).returncode:
                break
            time.sleep(0.5)


@contextlib.contextmanager
def rig(kind: str, root: Path, on_small_disk: bool = False, **settings: Any) -> Iterator[Rig]:
    """Servers for a kind of service (tests/service/conftest.py), started; all is gone afterwards."""
    root.mkdir(parents=True, exist_ok=True)
    root.chmod(0o755)
    with contextlib.ExitStack() as stack:
        place = stack.enter_context(small_disk(root / "disk")) if on_small_disk else root
        given: dict[str, Any] = {
            "data_dir": place / "data",
            "queue_prefix": f"sd_{uuid.uuid4().hex[:12]}",
            "solver": "tests.service.fake_solver",
        }
        made = Rig(kind, root, Settings(), disk=place if on_small_disk else None)
        if kind != "embedded":
            home = place if on_small_disk else Path(stack.enter_context(_open_folder()))
            made.postgres, given["database_url"] = _postgres(home / "postgres")
            make = _redis if kind == "postgres-redis" else _rabbitmq
            made.broker, given["broker_url"] = make(root / "broker")
            for server in (made.postgres, made.broker):
                stack.callback(server.kill)
                server.start()
        made.settings = Settings.model_validate(given | settings)
        yield made
