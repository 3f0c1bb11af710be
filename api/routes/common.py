"""Pieces that routes share: pages, problem answers for the OpenAPI description, request bodies of cases."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, TypeVar

from fastapi import Path as PathParameter
from fastapi import Query, Response
from pydantic import BaseModel

from store.bundled import examples_dir
from store.models import STATES

from ..bodies import DRAIN_BYTES
from ..schemas import ProblemInfo

CASE_BYTES = DRAIN_BYTES
"""The transport's limit for bodies that hold a case; beyond it a bare 413, below it a field error (api/bodies.py)."""

Limit = Annotated[int, Query(ge=1, le=500)]
Cursor = Annotated[str | None, Query(max_length=64, description="`next_cursor` of the page before")]
Key = Annotated[str, PathParameter(max_length=64)]


StatesQuery = Annotated[
    str | None,
    Query(pattern=rf"^({'|'.join(STATES)})(,({'|'.join(STATES)}))*$", description="one or several, with commas"),
]


def states_of(text: str | None) -> tuple[str, ...]:
    return tuple(text.split(",")) if text else ()


Model = TypeVar("Model", bound=BaseModel)


def as_json(model: Model) -> Model:
    """What a route that is asked often gives back for the model: its JSON. FastAPI would check first, in another
    thread, that the model is what it is."""
    return Response(model.model_dump_json(), media_type="application/json")  # type: ignore[return-value]


def problems(*statuses: int) -> dict[int | str, dict[str, Any]]:
    content = {"application/problem+json": {"schema": _problem_schema()}}
    texts = {
        400: "The body cannot be read.",
        401: "Nobody known asks; sign in, or send a key.",
        403: "The caller may not do this, or a browser's request came from another origin.",
        404: "There is no such thing here.",
        409: "The present state does not allow this.",
        413: "The body is too large.",
        422: "A fault of the case or the request, field by field.",
        429: "Too many attempts; the header Retry-After says for how long to wait.",
        503: "A part of the service is not available.",
        504: "The answer did not come in time.",
    }
    return {status: {"description": texts[status], "content": content} for status in statuses}


def _problem_schema() -> dict[str, Any]:
    """In one piece: a response's schema here cannot refer to another."""
    schema = ProblemInfo.model_json_schema()
    whole = json.dumps({key: value for key, value in schema.items() if key != "$defs"})
    for name, part in schema.get("$defs", {}).items():
        whole = whole.replace(json.dumps({"$ref": f"#/$defs/{name}"}), json.dumps(part))
    return dict(json.loads(whole))


def case_body() -> dict[str, Any]:
    """OpenAPI's requestBody of a case, as YAML text or as a JSON object."""
    text = _example("fpso-2000m")
    return {
        "requestBody": {
            "required": True,
            "content": {
                "application/yaml": {"schema": {"type": "string"}, "example": text},
                "application/json": {"schema": {"type": "object", "description": "see GET /schema"}},
            },
        }
    }


def _example(name: str) -> str:
    path: Path = examples_dir() / f"{name}.yaml"
    return path.read_text() if path.is_file() else "slowdrift: 1\nname: …\n"
