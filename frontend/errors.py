"""What the service said when it refused, as a value that a page can show at the field."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import httpx


@dataclass(frozen=True)
class FieldError:
    """One entry of a problem's `errors`: where in the case, what is wrong, and on which line (from 1) of the text."""

    field: str
    message: str
    line: int | None = None

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> FieldError:
        where = data.get("field") or ".".join(str(part) for part in data.get("loc") or [])
        return cls(where, str(data.get("message") or data.get("msg") or "is not valid"), data.get("line"))


@dataclass
class ApiError(Exception):
    """A problem+json answer, or no answer at all (status 0)."""

    status: int
    title: str
    detail: str = ""
    errors: list[FieldError] = field(default_factory=list)

    @property
    def text(self) -> str:
        return self.detail or self.title

    @classmethod
    def from_response(cls, response: httpx.Response) -> ApiError:
        try:
            body = response.json()
        except ValueError:
            body = {}
        if not isinstance(body, dict):
            body = {}
        detail = body.get("detail") or ""
        listed = body.get("errors") or (detail if isinstance(detail, list) else [])
        return cls(
            response.status_code,
            str(body.get("title") or f"The service answered {response.status_code}"),
            detail if isinstance(detail, str) else "",
            [FieldError.from_json(entry) for entry in listed if isinstance(entry, dict)],
        )


def unreachable(error: Exception) -> ApiError:
    return ApiError(0, "The service does not answer", f"{type(error).__name__}. Is it still running? Try again.")
