"""Reads beside long requests: `python benchmarks/long_work.py [--before FOLDER]`.

50 clients poll, each once a second, while one other does what takes long, again and again for `--seconds`: a case with
90 000 unknown keys is checked; a WAMIT `.1` of 51 MB is uploaded; the table of a study of 10 000 rows with summaries of
40 kB is fetched as CSV. Printed: times of the reads and of each long request. One API process, no worker.

`--before` names a folder with another version of the program (`git worktree add FOLDER COMMIT`), measured by turns.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import httpx
from service_load import CASE, ROOT, end_polling, start_polling, started, submit, summary

from store.database import Database
from store.models import Run
from tests.service.running import a_case

UNKNOWN_KEYS, ROWS, WAMIT_BYTES = 90_000, 10_000, 51_000_000


def check_unknown_keys(client: httpx.Client) -> None:
    text = CASE + "\n" + "\n".join(f"k{number}: 1" for number in range(UNKNOWN_KEYS))
    answer = client.post(
        "/api/v1/cases", content=text, headers={"content-type": "application/yaml"}, timeout=300
    )  # fmt: skip
    assert answer.status_code == 422, answer.text[:300]


@cache
def wamit() -> bytes:
    """Added mass and damping of one body at very many periods."""
    made: list[str] = []
    size, number = 0, 0
    while size < WAMIT_BYTES:
        period = 100.0 / (1 + number)
        for i in range(1, 7):
            for j in range(1, 7):
                made.append(f" {period:.6E} {i:5d} {j:5d} {1e3 + number:.6E} {1e2:.6E}\n")
        size += 36 * 53
        number += 1
    return "".join(made).encode()


def upload_wamit(client: httpx.Client) -> None:
    form = {"length": "1", "values": "nondimensional", "density": "1025", "gravity": "9.80665", "depth": "2000"}
    files = {"file": ("large.1", wamit())}
    answer = client.post("/api/v1/data-sets", files=files, data=form, timeout=600)
    assert answer.status_code < 500 or answer.status_code == 503, answer.text[:300]


def fetch_csv(client: httpx.Client) -> None:
    study = client.get("/api/v1/studies?limit=1").json()["items"][0]
    with client.stream("GET", f"/api/v1/studies/{study['id']}/table?format=csv", timeout=600) as answer:
        lines = sum(piece.count(b"\n") for piece in answer.iter_bytes())
    assert lines == ROWS + 1, lines


def fill(url: str, figures: bool) -> None:
    """Runs of a study that have ended with results, as a worker would have ended them."""
    bands = {band: dict.fromkeys(("surge", "sway", "heave", "roll", "pitch", "yaw"), 1.5) for band in ("wf", "lf")}
    lines = {
        f"line-{n}": {"tension_std": {"wf": [1e5] * 200, "lf": [2e5] * 200}, "tension_max": [1e6] * 200}
        for n in range(12)
    }
    result = {"frequency_domain": {"vessel_std": bands, "lines": lines}}
    database = Database(url)
    with database.write() as session:
        values: dict[str, object] = {"state": "succeeded", "summary": json.dumps(result)}
        if figures:
            from store.figures import figures_text

            values["figures"] = figures_text(result)
        session.query(Run).filter(Run.study_id.is_not(None)).update(values, synchronize_session=False)
    database.close()


WORK: dict[str, Callable[[httpx.Client], None]] = {
    "90 000 unknown keys": check_unknown_keys,
    "51 MB of WAMIT": upload_wamit,
    "CSV of 10 000 rows": fetch_csv,
}


def measure(name: str, seconds: float, now: bool) -> dict[str, float]:
    with started("embedded", "--workers", "0") as client:
        if "CSV" in name:
            grid = {"/line_types/t/EA": [1e8 + number for number in range(ROWS)]}
            answer = client.post("/api/v1/studies", json={"case": a_case("table"), "grid": grid}, timeout=300)
            assert answer.status_code == 202, answer.text
            fill(f"sqlite:///{os.environ['SD_LOAD_FOLDER']}/slowdrift.db", now)
        wamit()
        ids = [submit(client, number) for number in range(10)]
        polling = start_polling(client, 50, ids)
        began, took = time.monotonic(), []
        while not took or time.monotonic() - began < seconds:
            at = time.monotonic()
            WORK[name](client)
            took.append(time.monotonic() - at)
        ended = time.monotonic()
        reads = end_polling(polling)
        found = summary([each for when, each in reads if began <= when < ended])
        return found | {"times": len(took), "long_request_s": sum(took) / len(took)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--what", nargs="*", choices=WORK, default=list(WORK))
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--before", type=Path)
    options = parser.parse_args()
    versions = {"now": ROOT} | ({"before": options.before.resolve()} if options.before else {})
    for what in options.what:
        for name, folder in versions.items():
            os.environ["SD_TEST_PATH"] = str(folder)
            found = measure(what, options.seconds, name == "now")
            print(f"{what}, {name}: " + ", ".join(f"{key} {found[key]:.4g}" for key in found), flush=True)


if __name__ == "__main__":
    main()
