"""The doorbell: how a message "there is a task" gets from the API to a worker. The database row is the truth.

Redis or RabbitMQ by URL; without one, files in the data folder. Both the API's sender and the worker's Celery app take
their configuration from here, so that they agree on queues and transport.
"""

from __future__ import annotations

import os
import time
import uuid
from pathlib import Path
from queue import Empty
from typing import Any

from kombu import Exchange, Queue
from kombu.exceptions import ChannelError
from kombu.transport import TRANSPORT_ALIASES, filesystem
from kombu.utils.json import dumps, loads

from .settings import Settings

WORK_TASK, PREVIEW_TASK = "slowdrift.work", "slowdrift.preview"
RUNS, QUICK, INTERACTIVE, HYDRODYNAMICS = "runs", "quick", "interactive", "hydrodynamics"
"""Queues of messages. `quick` is a second door for the small tasks of `runs` (store/priority.py)."""
QUEUES = (RUNS, QUICK, INTERACTIVE, HYDRODYNAMICS)
POLL_SECONDS = 0.2
EMBEDDED = "slowdrift-files"


class SafeChannel(filesystem.Channel):
    """Kombu's file transport with whole messages only (kombu #1551: its `_put` is not atomic, its `_get` not alone).

    A message appears under its name complete or not at all, is taken by a rename that only one consumer can win, and
    one that cannot be read is dropped: its row will be rung for again.
    """

    def _put(self, queue: str, message: Any, **_: Any) -> None:  # type: ignore[override]
        folder = Path(self.data_folder_out)
        name = f"{time.time_ns():020d}_{uuid.uuid4().hex}.{queue}.msg"
        temporary = folder / f".{name}.new"
        try:
            with open(temporary, "wb") as file:
                file.write(dumps(message).encode())
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, folder / name)
        except OSError as error:
            raise ChannelError(f"cannot write a message into {folder}: {error.strerror}") from error

    def _get(self, queue: str, timeout: Any = None) -> Any:
        folder = Path(self.data_folder_in)
        ending = f"{queue}.msg"
        for name in sorted(os.listdir(folder)):
            if name.startswith(".") or name.partition(".")[2] != ending:
                continue
            taken = folder / f".{name}.taken"
            try:
                os.rename(folder / name, taken)
                content = taken.read_bytes()
                taken.unlink()
                return loads(content.decode())
            except (OSError, ValueError):
                continue
        raise Empty


class SafeTransport(filesystem.Transport):
    Channel = SafeChannel


TRANSPORT_ALIASES[EMBEDDED] = "store.broker:SafeTransport"


def queue_name(settings: Settings, queue: str) -> str:
    return f"{settings.queue_prefix}-{queue}"


def celery_config(settings: Settings, queues: tuple[str, ...] = QUEUES) -> dict[str, Any]:
    """What sender and worker share; the worker adds its own (worker/app.py)."""
    direct = Exchange("", type="direct")  # the default exchange: a queue's name is its address, nothing to bind
    declared = [Queue(name, direct, routing_key=name) for name in (queue_name(settings, q) for q in queues)]
    return {
        "broker_url": settings.broker_url or f"{EMBEDDED}://",
        "broker_transport_options": _transport_options(settings),
        "broker_connection_timeout": 3,
        "broker_connection_retry_on_startup": True,
        "broker_connection_max_retries": None,
        "task_queues": declared,
        "task_default_queue": declared[0].name,
        "task_default_exchange": "",
        "task_default_routing_key": declared[0].name,
        "task_create_missing_queues": False,
        "task_ignore_result": True,
        "task_store_errors_even_if_ignored": False,
        "task_acks_late": False,
        "task_serializer": "json",
        "accept_content": ["json"],
        "enable_utc": True,
    }


def _transport_options(settings: Settings) -> dict[str, Any]:
    url = settings.broker_url
    if not url:
        folder = settings.data_dir.absolute() / "broker"
        messages, control = folder / "messages", folder / "control"
        for path in (messages, control):
            path.mkdir(parents=True, exist_ok=True)
        return {
            "data_folder_in": str(messages),
            "data_folder_out": str(messages),
            "control_folder": str(control),
            "polling_interval": POLL_SECONDS,
        }
    if url.startswith(("redis", "valkey")):
        return {
            "global_keyprefix": f"{settings.queue_prefix}:",
            "socket_connect_timeout": 3,
            "socket_timeout": 10,
            "socket_keepalive": True,
            "health_check_interval": 30,
        }
    return {}
