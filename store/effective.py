"""The case a run computes: a stored case with the run's overrides, and the analyses asked of it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import metadata
from typing import Any

from solver.case import ANALYSES, Case, parse_case
from solver.outcome import CaseError, FieldError

from .pointers import replaced


def stored_case(
    canonical: str, analyses: Sequence[str] | None = None, overrides: Mapping[str, Any] | None = None
) -> Case:
    """The case from its canonical JSON, changed at `overrides` (JSON pointers); with `analyses`, a choice of its own.

    Raises CaseError where one is asked for that the case does not hold, or an override makes it invalid.
    """
    data = json.loads(canonical)
    return chosen(replaced(data, overrides) if overrides else data, analyses)


def chosen(data: Any, analyses: Sequence[str] | None) -> Case:
    """The checked case with a choice of its analyses. Raises CaseError."""
    if analyses is not None and isinstance(data.get("analyses"), dict):
        held = data["analyses"]
        errors = [_absent(index, name, held) for index, name in enumerate(analyses) if name not in held]
        if not analyses:
            errors = [FieldError(("analyses",), "name at least one analysis, or leave this out for all of the case's")]
        if errors:
            raise CaseError(errors)
        data = data | {"analyses": {name: held[name] for name in ANALYSES if name in analyses}}
    return parse_case(data)


def _absent(index: int, name: str, held: dict[str, object]) -> FieldError:
    return FieldError(
        ("analyses", index), f"the case does not hold this analysis; it holds: {', '.join(held)}", repr(name)[:80]
    )


@cache
def solver_version() -> str | None:
    """Version of the installed package; None in a checkout, where the same version need not be the same code."""
    try:
        return metadata.version("slowdrift")
    except metadata.PackageNotFoundError:
        return None


def identity(content_hash: str, data_hash: str | None, analyses: Sequence[str]) -> str | None:
    """Hash of all that decides the numbers of a run, seeds included (they stand in the case); None without a version."""
    version = solver_version()
    if version is None:
        return None
    known = json.dumps([content_hash, data_hash, sorted(analyses), version])
    return hashlib.sha256(known.encode()).hexdigest()
