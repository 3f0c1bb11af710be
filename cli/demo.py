"""`slowdrift demo`: the service, one run of the FPSO example through REST, its results as a table."""

from __future__ import annotations

import argparse
import threading
import time
from typing import Any

from .options import RefusedError, refuse, say
from .serve import Service, add_options, prepare

CASE = "fpso-2000m"
ANALYSES = ["statics", "frequency_domain", "modes"]  # its time domain takes a minute or more: start it from the page
READY_SECONDS = 60.0


def add_parser(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = commands.add_parser("demo", help="start the service and run the FPSO example")
    add_options(parser)
    parser.add_argument("--exit", action="store_true", help="end after the results; status 3 when the run failed")
    parser.set_defaults(func=demo)


def demo(options: argparse.Namespace) -> int:
    try:
        service = prepare(options)
    except RefusedError as error:
        return refuse(error)
    if service.accounts:
        service.supervisor.stop()
        return refuse(RefusedError("people sign in here, and the demo has no account; give it a --data-dir of its own"))
    said: list[int] = []
    thread = threading.Thread(target=lambda: said.append(_tell(service)), daemon=True)
    thread.start()
    try:
        while not service.supervisor.ending and (thread.is_alive() or not options.exit):
            service.supervisor.tick()
            time.sleep(0.1)
    finally:
        service.supervisor.stop()
    return said[0] if said else 3


def _tell(service: Service) -> int:
    import httpx

    try:
        with httpx.Client(base_url=service.url, timeout=30) as client:
            return _run(client, service.url)
    except (httpx.HTTPError, RefusedError) as error:
        if not service.supervisor.ending:
            refuse(error)
        return 3


def _run(client: Any, url: str) -> int:
    say(f"Slowdrift is at {url}/")
    _wait_until_ready(client)
    examples = client.get("/api/v1/examples").json()
    text = next(example["yaml"] for example in examples if example["name"] == CASE)
    answer = client.post("/api/v1/runs", json={"yaml": text, "analyses": ANALYSES})
    if answer.status_code != 202:
        raise RefusedError(f"the example was refused: {answer.json().get('detail')}")
    run = _follow(client, answer.json())
    if run["state"] != "succeeded":
        raise RefusedError(f"the run {run['state']}: {run['reason']}")
    _table(client.get(f"/api/v1/runs/{run['id']}/summary").json())
    say(f"The run's page: {url}/app/runs/{run['id']}")
    return 0


def _wait_until_ready(client: Any) -> None:
    import httpx

    deadline = time.monotonic() + READY_SECONDS
    while time.monotonic() < deadline:
        try:
            if client.get("/readyz").status_code == 200:
                return
        except httpx.HTTPError:
            pass
        time.sleep(0.1)
    raise RefusedError(f"the service was not ready within {READY_SECONDS:g} s; its logs are in the data folder")


def _follow(client: Any, run: dict[str, Any]) -> dict[str, Any]:
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn(run["case_name"]), BarColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns) as bar:
        task = bar.add_task("queued; the first run on a machine compiles the solver", total=1.0)
        while run["state"] in ("queued", "running", "cancelling"):
            time.sleep(0.2)
            run = client.get(f"/api/v1/runs/{run['id']}").json()
            words = run["message"] or run["state"]
            bar.update(task, completed=run["progress"], description=words if run["progress"] else None)
    return run


def _table(summary: dict[str, Any]) -> None:
    from rich.console import Console
    from rich.table import Table

    modes = {mode["label"]: mode for mode in reversed(summary.get("modes", []))}
    sigma = summary["frequency_domain"]["vessel_std"]
    table = Table(title=summary.get("case", ""))
    for heading in ("", "period [s]", "damping: vessel", "lines", "σ wave freq.", "σ slow drift"):
        table.add_column(heading, justify="right" if heading else "left")
    for dof, wave in sigma["wf"].items():
        mode = modes.get(dof)
        unit, scale = ("deg", 57.29577951308232) if dof in ("roll", "pitch", "yaw") else ("m", 1.0)
        table.add_row(
            dof,
            f"{mode['period']:.1f}" if mode else "–",
            f"{100 * mode['damping_vessel']:.1f} %" if mode else "–",
            f"{100 * mode['damping_lines']:.1f} %" if mode else "–",
            f"{scale * wave:.3f} {unit}",
            f"{scale * sigma['lf'][dof]:.3f} {unit}",
        )
    console = Console()
    console.print(table)
    for name, line in summary["frequency_domain"]["lines"].items():
        std = line.get("tension_std")
        if std:
            both = [(w * w + s * s) ** 0.5 for w, s in zip(std["wf"], std["lf"], strict=True)]
            console.print(f"{name}: largest σ of tension {max(both) / 1e3:.0f} kN")
