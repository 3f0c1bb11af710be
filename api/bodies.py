"""Request bodies that hold a case, read with care: bounded, refused with a field error rather than a broken pipe."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

from fastapi import Depends, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ValidationError
from starlette.concurrency import run_in_threadpool

from solver.case.text import MAX_BYTES
from solver.outcome import CaseError, FieldError

from .schemas import RunRequest
from .study_schemas import StudyRequest

Model = TypeVar("Model", bound=BaseModel)

DRAIN_BYTES = 64_000_000
"""A body is read to here, and thrown away beyond what a case may have, so that the client gets its answer."""


SMALL_BYTES = 20_000


@dataclass(frozen=True)
class Body:
    content: bytes
    is_json: bool


Endpoint = TypeVar("Endpoint", bound=Callable[..., Any])


def takes(most: int) -> Callable[[Endpoint], Endpoint]:
    """Says how many bytes a route reads where a case's are too few."""

    def mark(endpoint: Endpoint) -> Endpoint:
        endpoint.most_bytes = most  # type: ignore[attr-defined]
        return endpoint

    return mark


async def read_body(request: Request) -> Body:
    most = getattr(request.scope.get("endpoint"), "most_bytes", 2 * MAX_BYTES)
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    pieces: list[bytes] = []
    size = 0
    async for piece in request.stream():
        size += len(piece)
        if size <= most:
            pieces.append(piece)
        elif size > DRAIN_BYTES:
            break
        else:
            pieces.clear()
    if size > most:
        raise CaseError([FieldError((), f"the request has more than {most} bytes; allowed in a case: {MAX_BYTES}")])
    return Body(b"".join(pieces), kind == "application/json" or kind.endswith("+json"))


def read_json(body: Body) -> Any:
    """Strict JSON: no NaN or Infinity, no repeated keys. Raises CaseError with the line."""
    try:
        return json.loads(body.content, parse_constant=_no_constant, object_pairs_hook=_no_repeats)
    except json.JSONDecodeError as error:
        raise CaseError([FieldError((), f"not valid JSON: {error.msg}", line=error.lineno)]) from None
    except UnicodeDecodeError:
        raise CaseError([FieldError((), "the text is not UTF-8")]) from None
    except RecursionError:
        raise CaseError([FieldError((), "nested too deeply to be read")]) from None
    except ValueError as error:
        raise CaseError([FieldError((), f"not valid JSON: {error}")]) from None


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number that JSON knows")


def _no_repeats(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    made = dict(pairs)
    if len(made) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"the key {twice[:80]!r} is given twice")
    return made


async def read_run_request(body: Annotated[Body, Depends(read_body)]) -> RunRequest:
    return await _read(RunRequest, body)


async def read_study_request(body: Annotated[Body, Depends(read_body)]) -> StudyRequest:
    return await _read(StudyRequest, body)


async def _read(model: type[Model], body: Body) -> Model:
    """A large body is read in a thread: the event loop answers everybody."""
    if len(body.content) <= SMALL_BYTES:
        return _validated(model, body)
    return await run_in_threadpool(_validated, model, body)


def _validated(model: type[Model], body: Body) -> Model:
    data = read_json(body)
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise RequestValidationError(error.errors()) from None


BodyDep = Annotated[Body, Depends(read_body)]
RunRequestDep = Annotated[RunRequest, Depends(read_run_request)]
StudyRequestDep = Annotated[StudyRequest, Depends(read_study_request)]
