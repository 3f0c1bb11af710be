"""The service under load: `python benchmarks/service_load.py [--kind embedded postgres-redis postgres-rabbitmq]`.

1. Overhead of one run: small frequency-domain runs one after another, from the request's arrival to the stored result,
   less what the solver alone takes in a process of its own.
2. Load: 500 such runs go through while 100 clients poll, each once a second; times of all answers to reads. The runs
   come as one study, and again one by one, each sent as soon as the one before is accepted: then the API's own process
   has never nothing to do, and what is read waits for what is written. Only reads that begin before the last run has
   ended count, so that nobody's idle time makes the numbers better.
3. Queueing: 10 000 runs in one request.

With `--accounts` everybody who asks is a member of the team with an API key of their own, so that each request is
recognised, admitted and counted; without, it is the one person of a service on loopback. On a quiet machine; its load
and the processor time that other machines took are printed beside the numbers.
"""

from __future__ import annotations

import argparse
import asyncio
import contextlib
import json
import os
import random
import statistics
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

import httpx

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from store.database import Database  # noqa: E402
from store.models import DEFAULT_TEAM  # noqa: E402
from store.people import ADMIN, ApiKey  # noqa: E402
from store.repositories.accounts import AccountRepository  # noqa: E402
from store.repositories.teams import TeamRepository  # noqa: E402
from store.settings import Settings  # noqa: E402
from store.tokens import KEY, START, digest, new_token, read_secret  # noqa: E402
from tests.service.conftest import KINDS, RABBITMQ, REDIS, create_database, drop_database  # noqa: E402
from tests.service.running import service, wait_until  # noqa: E402

CASE = (ROOT / "examples" / "hanging-riser-case1.yaml").read_text()
ALL_KEYS = "SD_LOAD_KEYS"
ANALYSES = ["statics", "frequency_domain"]
BARE = """
import json, sys, time
from solver.case import load_case
from solver.run import run, select, warm_up
warm_up()
case = select(load_case(sys.stdin.read()), ("statics", "frequency_domain"))
times = []
for _ in range(60):
    began = time.perf_counter(); run(case, None); times.append(time.perf_counter() - began)
print(json.dumps(sorted(times)[len(times) // 2]))
"""


def bare() -> float:
    """Median seconds of the solver alone."""
    done = subprocess.run(
        [sys.executable, "-c", BARE], input=CASE, capture_output=True, text=True, check=True, cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    return float(json.loads(done.stdout))


@contextlib.contextmanager
def started(kind: str, *options: str, accounts: int = 0, **values: object) -> Iterator[httpx.Client]:
    """The service, and a client of its first member; the keys of all are in the environment of children. values: of
    its settings."""
    name = f"sd_load_{uuid.uuid4().hex[:10]}"
    with tempfile.TemporaryDirectory(prefix="sd-load-", ignore_cleanup_errors=True) as folder:
        given: dict[str, object] = {"data_dir": Path(folder), "queue_prefix": name} | values
        if kind != "embedded":
            given["database_url"] = create_database(name)
            given["broker_url"] = REDIS if kind == "postgres-redis" else RABBITMQ
        try:
            settings = Settings.model_validate(given)
            os.environ["SD_LOAD_FOLDER"] = str(settings.data_dir)
            with service(settings, False, *options) as client:
                keys = team_of(settings, accounts) if accounts else []
                os.environ[ALL_KEYS] = " ".join(keys)
                if keys:
                    client.headers["authorization"] = f"Bearer {keys[0]}"
                    wait_until(lambda: client.get("/api/v1/me").json().get("user"), 10)  # it has seen that there are
                yield client
        finally:
            if kind != "embedded":
                drop_database(name)


def team_of(settings: Settings, members: int) -> list[str]:
    """So many members of the one team, the first its owner, the others editors; a key of each."""
    database, secret, keys = Database(settings.database), read_secret(settings), []
    with database.write() as session:
        accounts, teams = AccountRepository(session), TeamRepository(session)
        for number in range(members):
            user = accounts.add(f"member{number}@example.org", f"Member {number}", "no password", number == 0)
            teams.join(DEFAULT_TEAM, user.id, "editor" if number else "owner")
            keys.append(new_token(KEY))
            accounts.add_key(
                ApiKey(
                    user_id=user.id, name="load", scope=ADMIN, start=keys[-1][:START], digest=digest(keys[-1], secret)
                )
            )
    database.close()
    return keys


def case_of(number: int) -> str:
    """Every run another case, so that nothing is known before."""
    return CASE.replace("name: ", f"name: {number} ", 1)


def submit(client: httpx.Client, number: int) -> str:
    answer = client.post("/api/v1/runs", json={"yaml": case_of(number), "analyses": ANALYSES})
    assert answer.status_code == 202, answer.text
    return str(answer.json()["id"])


def finished(client: httpx.Client, run_id: str) -> dict[str, object]:
    while True:
        run: dict[str, object] = client.get(f"/api/v1/runs/{run_id}").json()
        if run["state"] in ("succeeded", "failed", "cancelled"):
            assert run["state"] == "succeeded", run
            return run
        time.sleep(0.01)


def seconds_of(run: dict[str, object]) -> float:
    """From the request to the stored result, by the server's clock."""
    first, last = (datetime.fromisoformat(str(run[name])) for name in ("created_at", "finished_at"))
    return (last - first).total_seconds()


def overhead(client: httpx.Client, runs: int, alone: float) -> dict[str, float]:
    times = []
    for number in range(runs):
        times.append(seconds_of(finished(client, submit(client, 100_000 + number))) - alone)
        time.sleep(random.uniform(0.2, 0.5))  # so that nobody is awake by chance
    return {"overhead_median_ms": 1e3 * statistics.median(times), "overhead_max_ms": 1e3 * max(times)}


# -- 100 clients


async def _get(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, path: str, key: str) -> int:
    who = f"Authorization: Bearer {key}\r\n" if key else ""
    writer.write(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n{who}Accept-Encoding: identity\r\n\r\n".encode())
    await writer.drain()
    head = await reader.readuntil(b"\r\n\r\n")
    length = next(line for line in head.lower().split(b"\r\n") if line.startswith(b"content-length"))
    await reader.readexactly(int(length.partition(b":")[2]))
    return int(head.split(b" ", 2)[1])


async def _poll(
    port: int, key: str, paths: list[str], stop: asyncio.Event, reads: list[tuple[float, float]], bad: list[int]
) -> None:
    await asyncio.sleep(random.random())
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    chance = random.Random()
    while not stop.is_set():
        began = time.monotonic()
        status = await _get(reader, writer, chance.choice(paths), key)
        took = time.monotonic() - began
        reads.append((began, took))
        if status != 200:
            bad.append(status)
        await asyncio.sleep(max(0.0, 1.0 - took))
    writer.close()


def poll(port: int, clients: int, ids: list[str]) -> None:
    """The child process: until its standard input ends; then it prints when each read began and what it took."""
    reads: list[tuple[float, float]] = []
    bad: list[int] = []
    paths = [f"/api/v1/runs/{run_id}" for run_id in ids] * 3 + ["/api/v1/runs?limit=50"] * len(ids)

    keys = os.environ.get(ALL_KEYS, "").split() or [""] * clients

    async def all_of_them() -> None:
        stop = asyncio.Event()
        clients_at_work = asyncio.gather(*(_poll(port, keys[n], paths, stop, reads, bad) for n in range(clients)))
        await asyncio.to_thread(sys.stdin.read)
        stop.set()
        await clients_at_work

    asyncio.run(all_of_them())
    print(json.dumps({"reads": reads, "bad": bad}))


def start_polling(client: httpx.Client, clients: int, ids: list[str]) -> subprocess.Popen[str]:
    """In a process of its own; gives it when the clients are at work."""
    command = [sys.executable, __file__, "--poll", str(client.base_url.port), str(clients), *ids]
    polling = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT)
    time.sleep(3)
    return polling


def end_polling(polling: subprocess.Popen[str]) -> list[tuple[float, float]]:
    """When each read began and what it took, on this machine's monotonic clock."""
    found = json.loads(polling.communicate()[0])
    assert not found["bad"], found["bad"]
    return [(when, took) for when, took in found["reads"]]


def summary(seconds: list[float]) -> dict[str, float]:
    times = sorted(1e3 * took for took in seconds)
    return {
        "reads": len(times),
        "read_p50_ms": times[len(times) // 2],
        "read_p99_ms": times[int(0.99 * len(times))],
        "read_max_ms": times[-1],
    }


def load(
    client: httpx.Client, runs: int, clients: int, workers: int, alone: float, one_by_one: bool
) -> dict[str, float]:
    first = [submit(client, 200_000 + number) for number in range(10)]
    polling = start_polling(client, clients, first)
    began = time.monotonic()
    if one_by_one:
        for number in range(runs):
            submit(client, number)
    else:
        study(client, runs, 2.0e9)
    submitted = time.monotonic() - began
    wait_until(lambda: client.get("/api/v1/runs?state=queued,running&limit=1&total=true").json()["total"] == 0, 600)
    done = time.monotonic() - began
    reads = end_polling(polling)
    measured = summary([took for when, took in reads if began <= when < began + done]) | {
        "submit_s": submitted,
        "through_s": done,
        "per_run_over_solver_ms": 1e3 * (done * workers / runs - alone),
    }
    return {f"{'one_by_one' if one_by_one else 'study'}_{name}": value for name, value in measured.items()}


def study(client: httpx.Client, runs: int, stiffness: float) -> tuple[str, float]:
    """So many runs in one request, each with an axial stiffness of its own; its id and the seconds to the answer."""
    names = client.post("/api/v1/cases", content=CASE, headers={"content-type": "application/yaml"}).json()
    case = client.get(f"/api/v1/cases/{names['id']}").json()["case"]
    pointer = f"/line_types/{next(iter(case['line_types']))}/EA"
    grid = {pointer: [stiffness + number for number in range(runs)]}
    body = {"case_id": names["id"], "analyses": ANALYSES, "grid": grid}
    began = time.perf_counter()
    answer = client.post("/api/v1/studies", json=body, timeout=300)
    took = time.perf_counter() - began
    assert answer.status_code == 202, answer.text
    return str(answer.json()["id"]), took


def queue(client: httpx.Client, runs: int) -> dict[str, float]:
    key, took = study(client, runs, 1.0e9)
    began = time.perf_counter()
    client.post(f"/api/v1/studies/{key}/cancel", timeout=300)
    return {"queue_10000_s": took, "cancel_10000_s": time.perf_counter() - began}


def cpu_times() -> list[int]:
    """Of the machine since its start, in ticks: user, nice, system, idle, iowait, irq, softirq, steal, …"""
    return [int(ticks) for ticks in Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:]]


def stolen(before: list[int]) -> float:
    """The share of the machine's time since then that other machines on the same host took."""
    spent = [now - then for now, then in zip(cpu_times(), before, strict=True)]
    return spent[7] / sum(spent[:8])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--kind", nargs="*", choices=KINDS, default=["embedded", "postgres-redis"])
    parser.add_argument("--runs", type=int, default=500)
    parser.add_argument("--clients", type=int, default=100)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--api-processes", type=int, default=1)
    parser.add_argument("--accounts", action="store_true", help="everybody who asks has a key")
    parser.add_argument("--poll", nargs="*", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.poll:
        port, clients, *ids = options.poll
        return poll(int(port), int(clients), ids)
    alone = bare()
    print(f"machine: {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; solver alone {1e3 * alone:.1f} ms a run")
    for kind in options.kind:
        given = ("--workers", str(options.workers), "--api-processes", str(options.api_processes))
        before = cpu_times()
        with started(kind, *given, accounts=options.clients if options.accounts else 0) as client:
            finished(client, submit(client, 999_999))  # workers are awake
            found = overhead(client, 30, alone)
            for one_by_one in (False, True):
                found |= load(client, options.runs, options.clients, options.workers, alone, one_by_one)
            found |= queue(client, 10_000)
        who = f"{kind}{', accounts' if options.accounts else ''}, {options.api_processes} API process(es)"
        machine = f"(load {os.getloadavg()[0]:.1f}, stolen {stolen(before):.0%})"
        print(f"{who} {machine}: " + ", ".join(f"{name} {value:.4g}" for name, value in found.items()))
    return None


if __name__ == "__main__":
    main()
