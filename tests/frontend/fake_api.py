"""A small stand-in for the service, in memory: the same routes and shapes, runs live by the clock."""

from __future__ import annotations

import asyncio
import json
import time
import uuid
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import yaml
from fastapi import FastAPI, Query, Request, UploadFile
from fastapi.responses import JSONResponse, Response, StreamingResponse

from solver.case.case import Case
from tests.frontend import fake_results as results
from tests.frontend import fake_time

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
FINAL = ("succeeded", "failed", "cancelled")


def problem(status: int, title: str, detail: str = "", errors: list[dict[str, Any]] | None = None) -> JSONResponse:
    body = {"type": "about:blank", "title": title, "status": status, "detail": detail}
    return JSONResponse(body | ({"errors": errors} if errors else {}), status, media_type="application/problem+json")


def now() -> str:
    return datetime.now(UTC).isoformat()


def line_of(text: str, path: list[str]) -> int | None:
    """The line of a key in YAML text (lists by index)."""
    node: Any = yaml.compose(text)
    line = None
    for part in path:
        if isinstance(node, yaml.MappingNode):
            found = [(k, v) for k, v in node.value if k.value == part]
            if not found:
                return line
            line, node = found[0][0].start_mark.line + 1, found[0][1]
        elif isinstance(node, yaml.SequenceNode):
            node = node.value[int(part)]
            line = node.start_mark.line + 1
    return line


def check(text: str) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Enough of the real check for the pages: syntax, name, depth, lines and segment lengths."""
    try:
        case = yaml.safe_load(text)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        return {}, [{"field": "", "message": str(error.problem), "line": mark.line + 1 if mark else None}]
    if not isinstance(case, dict):
        return {}, [{"field": "", "message": "a case is a mapping of keys", "line": 1}]
    errors = []

    def wrong(path: list[str], message: str) -> None:
        errors.append({"loc": path, "field": ".".join(path), "message": message, "line": line_of(text, path)})

    for key in ("name", "environment", "lines", "analyses"):
        if key not in case:
            wrong([key], "is required")
    for name, line in (case.get("lines") or {}).items():
        for index, segment in enumerate(line.get("segments", [])):
            if float(str(segment["length"]).split()[0]) <= 0:
                wrong(["lines", name, "segments", str(index), "length"], "must be more than 0 m")
    return case, errors


SLOWLY = "# slowly"
"""A case with this comment takes long enough for a busy machine's browser to show it on its way."""


class FakeService:
    def __init__(self, run_seconds: float = 1.5) -> None:
        self.run_seconds = run_seconds
        self.cases: dict[str, dict[str, Any]] = {}
        self.runs: dict[str, dict[str, Any]] = {}
        self.data_sets: list[dict[str, Any]] = []

    def add_case(self, text: str, case: dict[str, Any]) -> dict[str, Any]:
        case_id = uuid.uuid4().hex
        self.cases[case_id] = {
            "id": case_id, "name": case["name"], "version": 1, "content_hash": case_id[:8], "created_at": now(),
            "warnings": [], "case": case, "yaml": text,
        }  # fmt: skip
        return self.cases[case_id]

    def add_run(
        self, case: dict[str, Any], fail: str | None = None, analyses: list[str] | None = None
    ) -> dict[str, Any]:
        run_id = uuid.uuid4().hex
        self.runs[run_id] = {
            "id": run_id, "case_id": case["id"], "case_name": case["name"], "content_hash": case["content_hash"],
            "analyses": analyses or list(case["case"]["analyses"]), "state": "queued", "outcomes": {}, "reason": None,
            "progress": 0.0, "message": "waiting for a worker", "created_at": now(), "started_at": None,
            "finished_at": None, "attempt": 0, "solver_version": None, "warnings": [], "born": time.monotonic(),
            "watched": False,
            "fail": fail, "name": "", "tags": [], "pinned": False, "eta_seconds": 2.0, "created_by": "Ada", "kind": "case",
        }  # fmt: skip
        return self.runs[run_id]

    def watched(self, run_id: str) -> None:
        """A run goes on from when its page is there to see it, however long that took to load."""
        run = self.runs.get(run_id)
        if run is not None and run["state"] not in FINAL and not run["watched"]:
            run.update(born=time.monotonic(), watched=True)

    def advance(self, run: dict[str, Any]) -> dict[str, Any]:
        slowly = SLOWLY in self.cases[run["case_id"]]["yaml"]
        share = (time.monotonic() - run["born"]) / max(15.0 if slowly else self.run_seconds, 1e-9)
        if run["state"] == "cancelling":
            run.update(state="cancelled", finished_at=now(), message="")
        elif run["state"] not in FINAL and share >= 1:
            run["started_at"] = run["started_at"] or now()
            state = "failed" if run["fail"] else "succeeded"
            outcome = dict.fromkeys(run["analyses"], state)
            run.update(state=state, reason=run["fail"], progress=1.0, finished_at=now(), message="", outcomes=outcome)
        elif run["state"] not in FINAL and share > 0.15:
            run["started_at"] = run["started_at"] or now()
            run.update(state="running", progress=round(share, 2), message="frequency domain, iteration", attempt=1)
        return {key: value for key, value in run.items() if key not in ("born", "watched", "fail")}

    def results(self, run: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
        timed = "time_domain" in run["analyses"]
        if "vessel" in self.cases[run["case_id"]]["case"]:
            summary, channels = results.fpso_summary(run["case_name"]), results.fpso_channels()
            if timed:
                summary, channels = fake_time.fpso_with_time(summary), channels | fake_time.fpso_time_channels()
        else:
            summary, channels = results.riser_summary(run["case_name"]), results.riser_channels()
            if timed:
                summary, channels = fake_time.riser_with_time(summary), channels | fake_time.riser_time_channels()
        return summary, channels


def create_fake(run_seconds: float = 1.5) -> FastAPI:
    app = FastAPI()
    app.state.fake = FakeService(run_seconds)
    _cases(app, app.state.fake)
    _runs(app, app.state.fake)
    _results(app, app.state.fake)
    _data_sets(app, app.state.fake)
    return app


def _cases(app: FastAPI, fake: FakeService) -> None:
    @app.get("/api/v1/examples")
    def examples() -> list[dict[str, str]]:
        paths = sorted(EXAMPLES.glob("*.yaml"))
        return [{"name": p.stem, "title": p.stem, "description": "An example.", "yaml": p.read_text()} for p in paths]

    @app.get("/api/v1/schema")
    def schema() -> Any:
        return Case.model_json_schema()

    @app.get("/api/v1/cases")
    def saved(limit: int = 50) -> Any:
        keys = ("id", "name", "version", "content_hash", "created_at", "warnings")
        found = [{key: case[key] for key in keys} for case in reversed(fake.cases.values())]
        return {"items": found[:limit], "next_cursor": None}

    @app.post("/api/v1/preview")
    async def preview(request: Request) -> Any:
        case, _ = check((await request.body()).decode())
        lines = {
            name: {"arc_length": [0, 100, 200], "position": [[300, 40 * i, -100], [150, 20 * i, -90], [10, i, -5]]}
            for i, name in enumerate(case.get("lines") or {})
        }
        ends = {"end_a": {"tension": 5e5}, "end_b": {"tension": 9e5}, "grounded_length": 60.0}
        return {"statics": {"converged": True, "lines": dict.fromkeys(lines, ends)}, "lines": lines, "warnings": []}

    @app.get("/api/v1/auth")
    def auth() -> Any:
        return {"accounts": False, "signed_in": False}

    @app.get("/healthz")
    def healthz() -> Any:
        return {"ok": True}

    @app.post("/api/v1/cases/check")
    async def check_case(request: Request) -> Any:
        case, errors = check((await request.body()).decode())
        if errors:
            return problem(422, "The case is wrong", f"{len(errors)} fields", errors)
        return {"ok": True, "name": case["name"], "analyses": list(case["analyses"]), "warnings": []}

    @app.post("/api/v1/cases", status_code=201)
    async def create(request: Request) -> Any:
        text = (await request.body()).decode()
        case, errors = check(text)
        return problem(422, "The case is wrong", "", errors) if errors else fake.add_case(text, case)

    @app.get("/api/v1/cases/{case_id}")
    def case(case_id: str) -> Any:
        return fake.cases.get(case_id) or problem(404, "No such case")


def _runs(app: FastAPI, fake: FakeService) -> None:
    @app.get("/api/v1/runs")
    def runs(
        limit: int = 50,
        cursor: str | None = None,
        state: str | None = None,
        q: str = "",
        tag: str = "",
        sort: str = "-created",
    ) -> Any:
        made = [fake.advance(run) for run in fake.runs.values()]
        made = made if sort == "created" else made[::-1]
        made = [run for run in made if state is None or run["state"] in state.split(",")]
        made = [run for run in made if q.lower() in f"{run['name']} {run['case_name']}".lower()]
        made = [run for run in made if not tag or tag in run["tags"]]
        start = int(cursor or 0)
        more = str(start + limit) if start + limit < len(made) else None
        return {"items": made[start : start + limit], "next_cursor": more, "total": len(made)}

    @app.post("/api/v1/runs", status_code=202)
    async def start(request: Request) -> Any:
        asked = await request.json()
        case = fake.cases.get(asked.get("case_id"))
        return (
            fake.advance(fake.add_run(case, analyses=asked.get("analyses"))) if case else problem(404, "No such case")
        )

    @app.get("/api/v1/runs/{run_id}")
    def run(run_id: str) -> Any:
        return fake.advance(fake.runs[run_id]) if run_id in fake.runs else problem(404, "No such run")

    @app.patch("/api/v1/runs/{run_id}")
    async def change(run_id: str, request: Request) -> Any:
        fake.runs[run_id].update(await request.json())
        return fake.advance(fake.runs[run_id])

    @app.post("/api/v1/runs/{run_id}/rerun", status_code=202)
    def rerun(run_id: str) -> Any:
        return fake.advance(
            fake.add_run(fake.cases[fake.runs[run_id]["case_id"]], analyses=fake.runs[run_id]["analyses"])
        )

    @app.get("/api/v1/runs/{run_id}/case")
    def case_of(run_id: str) -> Any:
        return fake.cases[fake.runs[run_id]["case_id"]]

    @app.post("/api/v1/runs/{run_id}/cancel", status_code=202)
    def cancel(run_id: str) -> Any:
        if fake.advance(fake.runs[run_id])["state"] in FINAL:
            return problem(409, "The run has ended", "Only a queued or running run can be cancelled.")
        fake.runs[run_id]["state"] = "cancelling"
        return fake.advance(fake.runs[run_id])

    @app.delete("/api/v1/runs/{run_id}", status_code=204)
    def delete(run_id: str) -> Response:
        fake.runs.pop(run_id, None)
        return Response(status_code=204)

    async def stream(request: Request, run_ids: list[str] | None) -> Any:
        seen: dict[str, str] = {}
        for run_id in run_ids or []:
            fake.watched(run_id)
        while not await request.is_disconnected():
            for run_id in run_ids or list(fake.runs):
                if run_id not in fake.runs:
                    continue
                text = json.dumps(fake.advance(fake.runs[run_id]))
                if seen.get(run_id) != text:
                    seen[run_id] = text
                    yield f"event: run\ndata: {text}\n\n"
            if run_ids and all(fake.runs[i]["state"] in FINAL for i in run_ids if i in fake.runs):
                return
            await asyncio.sleep(0.1)

    @app.get("/api/v1/events")
    def events(request: Request) -> StreamingResponse:
        return StreamingResponse(stream(request, None), media_type="text/event-stream")

    @app.get("/api/v1/runs/{run_id}/events")
    def run_events(request: Request, run_id: str) -> StreamingResponse:
        return StreamingResponse(stream(request, [run_id]), media_type="text/event-stream")


def _results(app: FastAPI, fake: FakeService) -> None:
    @app.get("/api/v1/runs/{run_id}/summary")
    def summary(run_id: str) -> Any:
        run = fake.runs[run_id]
        if fake.advance(run)["state"] not in FINAL:
            return problem(409, "The run has not ended")
        return fake.results(run)[0]

    @app.get("/api/v1/runs/{run_id}/channels")
    def channels(run_id: str) -> Any:
        listed = []
        for item in fake.results(fake.runs[run_id])[1].values():
            axes = [
                {"name": a["name"], "unit": a["unit"], "size": len(a["values"]), "first": a["values"][0],
                 "last": a["values"][-1]}
                for a in item["axes"]
            ]  # fmt: skip
            rest = {key: item[key] for key in ("name", "unit", "description", "band")}
            listed.append(rest | {"axes": axes, "dims": [a["name"] for a in axes], "shape": [a["size"] for a in axes]})
        return {"items": listed}

    @app.get("/api/v1/runs/{run_id}/channels/{name:path}")
    def channel(
        run_id: str,
        name: str,
        start: float | None = Query(None, alias="from"),
        stop: float | None = Query(None, alias="to"),
        points: int | None = None,
        seed: int | None = None,
    ) -> Any:
        found = fake.results(fake.runs[run_id])[1].get(name)
        return fake_time.look(found, start, stop, points, seed) if found else problem(404, "No such channel")


def _data_sets(app: FastAPI, fake: FakeService) -> None:
    @app.get("/api/v1/data-sets")
    def listed() -> Any:
        return {"items": fake.data_sets, "next_cursor": None}

    @app.post("/api/v1/data-sets", status_code=201)
    async def upload(file: UploadFile) -> Any:
        content = await file.read()
        if not content.startswith((b"CDF", b"\x89HDF")):
            return problem(422, "Not a hydrodynamic data set", "The file is not NetCDF.")
        made = {
            "id": uuid.uuid4().hex, "name": file.filename, "version": 1, "content_hash": "fake", "size": len(content),
            "summary": {"frequencies": 101, "headings": 13},
        }  # fmt: skip
        fake.data_sets.append(made)
        return made
