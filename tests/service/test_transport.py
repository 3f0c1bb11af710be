"""The file transport under stress: nothing lost, nothing twice, and rubbish is passed over."""

from __future__ import annotations

import threading
from collections import Counter
from pathlib import Path
from queue import Empty

from kombu import Connection, Exchange, Queue
from kombu.simple import SimpleQueue

from store.broker import celery_config
from store.settings import Settings


def connect(settings: Settings) -> Connection:
    config = celery_config(settings)
    return Connection(config["broker_url"], transport_options=config["broker_transport_options"])


def simple(connection: Connection, name: str) -> SimpleQueue:
    """A queue declared as the service declares its own (store/broker.py)."""
    return connection.SimpleQueue(Queue(name, Exchange("", type="direct"), routing_key=name), no_ack=True)


def test_many_writers_and_readers(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path)
    sent, got = 600, Counter[str]()
    writing = threading.Event()
    writing.set()

    def write(part: int) -> None:
        with connect(settings) as connection:
            queue = simple(connection, f"some.queue-{part % 2}")
            for number in range(sent // 4):
                queue.put({"id": f"{part}/{number}"})

    def read(part: int) -> None:
        with connect(settings) as connection:
            queue = simple(connection, f"some.queue-{part % 2}")
            while True:
                last_round = not writing.is_set()
                try:
                    got[queue.get(timeout=0.05).payload["id"]] += 1
                except (Empty, queue.Empty):
                    if last_round:
                        return

    writers = [threading.Thread(target=write, args=(part,)) for part in range(4)]
    readers = [threading.Thread(target=read, args=(part,)) for part in range(4)]
    for thread in writers + readers:
        thread.start()
    for thread in writers:
        thread.join()
    writing.clear()
    for thread in readers:
        thread.join()
    assert len(got) == sent
    assert set(got.values()) == {1}


def test_rubbish_does_not_stop_a_worker(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path)
    with connect(settings) as connection:
        queue = simple(connection, "q")
        folder = tmp_path / "broker" / "messages"
        for name, content in (
            ("000_a.q.msg", b""),
            ("000_b.q.msg", b"{"),
            ("000_c.q.msg", b"\xff"),
            ("0_d.other.msg", b"{}"),
        ):
            (folder / name).write_bytes(content)
        queue.put({"id": 1})
        assert queue.get(timeout=2).payload == {"id": 1}
    assert [path.name for path in folder.iterdir()] == ["0_d.other.msg"]
