"""The one door from error to HTTP: application/problem+json (RFC 9457) through fastapi-problem.

`errors` lists faults of fields, of a case or of a request, in one shape: loc, field, message, value, line.
"""

from __future__ import annotations

import logging
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi_problem.error import Problem, StatusProblem
from fastapi_problem.handler import ExceptionHandler, add_exception_handler, new_exception_handler
from sqlalchemy.exc import DBAPIError, IntegrityError, InterfaceError, OperationalError

from solver.outcome import CaseError, DataError, FieldError, NotConverged, SlowdriftError
from store.errors import (
    ConflictError,
    ForbiddenError,
    NotFoundError,
    QuotaError,
    SignInError,
    TooManyError,
    TooSlowError,
    UnavailableError,
)

log = logging.getLogger(__name__)
DATA = ("vessel", "hydrodynamics", "data")


class ServerProblem(StatusProblem):
    """An error of ours: the server logs it, the answer does not tell."""

    type_ = "internal-error"
    title = "Something went wrong inside Slowdrift."
    status = 500

    def __init__(self, _: str | None = None, **__: Any):
        super().__init__("The server's log has the details.")


def field_problem(errors: list[FieldError], title: str, kind: str) -> Problem:
    detail = "; ".join(str(error) for error in errors[:3]) + (" …" if len(errors) > 3 else "")
    shown = [error.as_dict() for error in errors[:100]]
    return Problem(title, type_=kind, detail=detail, status=422, errors=shown)


def _case(_: ExceptionHandler, __: Request, error: CaseError) -> Problem:
    return field_problem(error.errors, "The case is not valid.", "case-invalid")


def _data(_: ExceptionHandler, __: Request, error: DataError) -> Problem:
    return field_problem([FieldError(DATA, str(error))], "The hydrodynamic data cannot be used.", "data-invalid")


def _request(_: ExceptionHandler, __: Request, error: RequestValidationError) -> Problem:
    faults = []
    for item in error.errors():
        loc = tuple(part for part in item["loc"] if part not in ("body", "query", "path"))
        value = item.get("input")
        shown = repr(value)[:80] if isinstance(value, str | int | float | bool) else ""
        faults.append(FieldError(loc, item["msg"].removeprefix("Value error, "), shown))
    return field_problem(faults, "The request is not valid.", "request-invalid")


def _away(_: ExceptionHandler, __: Request, error: DBAPIError) -> Problem:
    log.warning("The database did not answer a request: %s", error)
    detail = "The database cannot be reached or written to now; nothing was changed. Try again in a moment."
    return Problem("A part of the service is not available.", type_="unavailable", detail=detail, status=503)


def _clash(_: ExceptionHandler, __: Request, error: IntegrityError) -> Problem:
    """What was looked up before the change is another by now: removed, or made by somebody else."""
    log.warning("Two requests clashed: %s", error.orig)
    detail = "Another request changed the same thing at the same time; nothing was changed. Try again."
    return Problem("The present state does not allow this.", type_="conflict", detail=detail, status=409)


def _status(status: int, kind: str, title: str) -> Any:
    def handle(_: ExceptionHandler, __: Request, error: SlowdriftError) -> Problem:
        return Problem(title, type_=kind, detail=str(error), status=status)

    return handle


def _sign_in(_: ExceptionHandler, __: Request, error: SignInError) -> Problem:
    headers = {"www-authenticate": "Bearer"}
    return Problem("Nobody is signed in.", type_="sign-in-required", detail=str(error), status=401, headers=headers)


def _too_many(_: ExceptionHandler, __: Request, error: TooManyError) -> Problem:
    headers = {"retry-after": str(error.retry_after)}
    return Problem("Too many attempts.", type_="too-many", detail=str(error), status=429, headers=headers)


def _quota(_: ExceptionHandler, request: Request, error: QuotaError) -> Problem:
    """Kept too, so that the team sees on its page what was refused."""
    scope = request.scope.get("state", {}).get("admitted")
    if scope is not None:
        request.app.state.refusals.add(scope.team_id, str(error))
    return Problem("A limit is reached.", type_="quota", detail=str(error), status=429)


def install(app: FastAPI) -> None:
    handlers: dict[type[Exception], Any] = {
        CaseError: _case,
        DataError: _data,
        NotConverged: _status(422, "not-converged", "The analysis found no answer."),
        NotFoundError: _status(404, "not-found", "Not found."),
        SignInError: _sign_in,
        ForbiddenError: _status(403, "forbidden", "The caller may not do this."),
        TooManyError: _too_many,
        QuotaError: _quota,
        ConflictError: _status(409, "conflict", "The present state does not allow this."),
        TooSlowError: _status(504, "too-slow", "The answer did not come in time."),
        OperationalError: _away,
        InterfaceError: _away,
        IntegrityError: _clash,
        UnavailableError: _status(503, "unavailable", "A part of the service is not available."),
    }
    handler = new_exception_handler(
        handlers=handlers,
        unhandled_wrappers={"default": ServerProblem},
        request_validation_handler=_request,
    )
    add_exception_handler(app, handler, generic_swagger_defaults=False)
    for kind in (SlowdriftError, OperationalError, InterfaceError, IntegrityError):
        app.add_exception_handler(kind, handler)
