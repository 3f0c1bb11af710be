"""The service's REST API as a few methods that answer with typed models (models.py, made from the OpenAPI)."""

from __future__ import annotations

import io
import os
import time
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeVar
from urllib.parse import quote

import httpx
from pydantic import BaseModel

from .models import CaseInfo, ChannelPage, ChannelValues, DataSetInfo, RunCase, RunInfo, RunPage, StudyInfo, StudyTable

if TYPE_CHECKING:
    import xarray

Model = TypeVar("Model", bound=BaseModel)
FINAL = ("succeeded", "failed", "cancelled")
FIRST_PAUSE, LONGEST_PAUSE = 0.1, 2.0
AGAIN = (502, 503, 504)
"""Answers after which the same request may be sent again."""


class ApiError(Exception):
    """What the service refused: `status`, `type`, and the faults of fields in `errors` (RFC 9457)."""

    def __init__(self, status: int, problem: Mapping[str, Any]):
        self.status, self.type = status, str(problem.get("type", ""))
        self.errors: list[dict[str, Any]] = list(problem.get("errors") or [])
        super().__init__(f"{status}: {problem.get('detail') or problem.get('title') or 'no reason given'}")


class RunFailedError(Exception):
    """A run ended without success; `run` has its state and reason."""

    def __init__(self, run: RunInfo):
        self.run = run
        super().__init__(f"run {run.id} {run.state}: {run.reason or 'no reason given'}")


class Client:
    """One service. `key` is a personal API key; without one, SLOWDRIFT_KEY; a service for one person needs none.

    Requests that start something carry a key of their own, so that sending them again after a lost answer starts
    nothing twice; while the service is away they are sent again for `patience` seconds.
    """

    def __init__(
        self, url: str = "http://127.0.0.1:8000", key: str | None = None, timeout: float = 60.0, patience: float = 60.0
    ):
        key = key or os.environ.get("SLOWDRIFT_KEY")
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        self._patience = patience
        self._http = httpx.Client(base_url=url.rstrip("/") + "/api/v1/", headers=headers, timeout=timeout)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        self._http.close()

    # -- runs

    def submit(
        self,
        case: str | Path | Mapping[str, Any],
        analyses: Sequence[str] | None = None,
        *,
        name: str = "",
        tags: Sequence[str] = (),
        reuse: bool = False,
        priority: str | None = None,
    ) -> RunInfo:
        """Queue a run of a case: a file, YAML text, a mapping, or the id of a saved case.

        With `reuse`, a succeeded run of the very same is answered where there is one. Raises ApiError.
        """
        body = _case(case) | _given(analyses=analyses, name=name, tags=list(tags), priority=priority)
        return self._model(RunInfo, "POST", "runs", body | ({"reuse": "allow"} if reuse else {}))

    def run(self, run: str | RunInfo) -> RunInfo:
        return self._model(RunInfo, "GET", f"runs/{_id(run)}")

    def runs(self, **filters: Any) -> Iterator[RunInfo]:
        """All runs that pass the filters of `GET /runs` (state, q, tag, study, case …), newest first."""
        cursor = None
        while True:
            page = self._model(RunPage, "GET", "runs", params=_given(limit=200, cursor=cursor, **filters))
            yield from page.items
            cursor = page.next_cursor
            if cursor is None:
                return

    def wait(
        self,
        run: str | RunInfo,
        timeout: float | None = None,
        on_progress: Callable[[RunInfo], None] | None = None,
    ) -> RunInfo:
        """The run once it has succeeded. Raises RunFailedError if it ends otherwise, TimeoutError."""
        deadline = None if timeout is None else time.monotonic() + timeout
        pause = FIRST_PAUSE
        while (now := self.run(run)).state not in FINAL:
            if on_progress is not None:
                on_progress(now)
            if deadline is not None and time.monotonic() > deadline:
                raise TimeoutError(f"run {now.id} is {now.state}, {now.progress:.0%}, after {timeout} s")
            time.sleep(pause)
            pause = min(1.3 * pause, LONGEST_PAUSE)
        if now.state != "succeeded":
            raise RunFailedError(now)
        return now

    def cancel(self, run: str | RunInfo) -> RunInfo:
        return self._model(RunInfo, "POST", f"runs/{_id(run)}/cancel")

    def rerun(self, run: str | RunInfo) -> RunInfo:
        """The same case version, data version and analyses again."""
        return self._model(RunInfo, "POST", f"runs/{_id(run)}/rerun")

    def case(self, run: str | RunInfo) -> RunCase:
        """The very case that the run computes."""
        return self._model(RunCase, "GET", f"runs/{_id(run)}/case")

    def summary(self, run: str | RunInfo) -> dict[str, Any]:
        """docs/summary.md describes it."""
        found: dict[str, Any] = self._send("GET", f"runs/{_id(run)}/summary").json()
        return found

    def results(self, run: str | RunInfo, channels: str | None = None) -> xarray.DataTree:
        """All channels, or those of a pattern such as `frequency/vessel/*`, as a tree of xarray datasets.

        A channel's name is its path: `results(run)["frequency/vessel/surge"]` has its axes as coordinates and its unit.
        """
        import xarray

        content = self._send(
            "GET", f"runs/{_id(run)}/export", params=_given(format="netcdf", channels=channels)
        ).content
        with xarray.open_datatree(io.BytesIO(content), engine="h5netcdf") as tree:
            return tree.load()

    def channels(self, run: str | RunInfo) -> ChannelPage:
        """Names, axes and units of what the run has."""
        return self._model(ChannelPage, "GET", f"runs/{_id(run)}/channels")

    def channel(self, run: str | RunInfo, name: str, **view: Any) -> ChannelValues:
        """One channel through a view: `start`, `stop` on the first axis, `points`, `seed`, `arc_length`."""
        view = {{"start": "from", "stop": "to"}.get(key, key): value for key, value in view.items()}
        return self._model(ChannelValues, "GET", f"runs/{_id(run)}/channels/{quote(name)}", params=_given(**view))

    # -- cases, data, studies

    def save_case(self, case: str | Path | Mapping[str, Any]) -> CaseInfo:
        given = _case(case)
        if "case" in given:
            return self._model(CaseInfo, "POST", "cases", given["case"])
        text = str(given.get("yaml", "")).encode()
        answer = self._send("POST", "cases", content=text, headers={"Content-Type": "application/yaml"})
        return CaseInfo.model_validate(answer.json())

    def upload(self, path: str | Path, name: str | None = None) -> DataSetInfo:
        """Hydrodynamic data, under a name to which cases may refer."""
        path = Path(path)
        files, data = {"file": (path.name, path.read_bytes())}, _given(name=name)
        return DataSetInfo.model_validate(self._send("POST", "data-sets", files=files, data=data).json())

    def catalogue(
        self, name: str | None = None, diameter: float | str | None = None, stiffness: str | None = None
    ) -> Any:
        """Chain, wire and fibre ropes for line types: all entries, or one with its values at a diameter ("120 mm")."""
        path = "catalogue" if name is None else f"catalogue/{quote(name, safe='')}"
        return self._send("GET", path, params=_given(diameter=diameter, stiffness=stiffness)).json()

    def study(
        self,
        case: str | Path | Mapping[str, Any],
        grid: Mapping[str, Sequence[Any]] | None = None,
        overrides: Sequence[Mapping[str, Any]] | None = None,
        analyses: Sequence[str] | None = None,
        *,
        name: str = "",
        tags: Sequence[str] = (),
    ) -> StudyInfo:
        """Queue a run for every combination of a grid, or for every entry of a list: JSON pointer to value."""
        given = _given(grid=grid, overrides=overrides, analyses=analyses, name=name, tags=list(tags))
        return self._model(StudyInfo, "POST", "studies", _case(case) | given)

    def wait_study(self, study: str | StudyInfo, timeout: float | None = None) -> StudyInfo:
        """The study once no run of it is active. Raises TimeoutError."""
        deadline = None if timeout is None else time.monotonic() + timeout
        pause = FIRST_PAUSE
        while (now := self._model(StudyInfo, "GET", f"studies/{_id(study)}")).state == "active":
            if deadline is not None and time.monotonic() > deadline:
                raise TimeoutError(f"study {now.id}: {now.counts} after {timeout} s")
            time.sleep(pause)
            pause = min(1.3 * pause, LONGEST_PAUSE)
        return now

    def table(self, study: str | StudyInfo, columns: Sequence[str] | None = None) -> list[dict[str, Any]]:
        """A row per run, by column; docs/rest.md says what columns there are."""
        asked = None if columns is None else ",".join(columns)
        rows: list[dict[str, Any]] = []
        cursor = None
        while True:
            params = _given(columns=asked, cursor=cursor, limit=5000)
            page = self._model(StudyTable, "GET", f"studies/{_id(study)}/table", params=params)
            rows += [dict(zip(page.columns, row, strict=True)) for row in page.rows]
            cursor = page.next_cursor
            if cursor is None:
                return rows

    # -- inside

    def _model(self, model: type[Model], method: str, path: str, body: Any = None, **more: Any) -> Model:
        sent = more if body is None else more | {"json": body}
        return model.model_validate(self._send(method, path, **sent).json())

    def _send(self, method: str, path: str, headers: Mapping[str, str] | None = None, **sent: Any) -> httpx.Response:
        """The answer; sent again while the service is away. What starts something has a key, so that it starts once."""
        headers = dict(headers or {}) | ({"Idempotency-Key": uuid.uuid4().hex} if method == "POST" else {})
        deadline, pause = time.monotonic() + self._patience, 0.2
        while True:
            try:
                answer = self._http.request(method, path, headers=headers, **sent)
                if answer.status_code not in AGAIN or time.monotonic() > deadline:
                    break
            except httpx.TransportError:
                if time.monotonic() > deadline:
                    raise
            time.sleep(pause)
            pause = min(2 * pause, 5.0)
        if answer.is_error:
            kind = answer.headers.get("content-type", "")
            raise ApiError(answer.status_code, answer.json() if "json" in kind else {"detail": answer.text[:500]})
        return answer


def _id(thing: str | BaseModel) -> str:
    return quote(thing if isinstance(thing, str) else str(thing.id), safe="")  # type: ignore[attr-defined]


def _case(case: str | Path | Mapping[str, Any]) -> dict[str, Any]:
    """A mapping is a case, a path a file; text with a line break is YAML, else the name of a file or a saved case's id."""
    if isinstance(case, Mapping):
        return {"case": dict(case)}
    if isinstance(case, Path):
        return {"yaml": case.read_text(encoding="utf-8")}
    if "\n" in case:
        return {"yaml": case}
    if case.endswith((".yaml", ".yml", ".json")):
        return {"yaml": Path(case).read_text(encoding="utf-8")}
    return {"case_id": case}


def _given(**values: Any) -> dict[str, Any]:
    return {key: value for key, value in values.items() if value is not None and value != [] and value != ""}
