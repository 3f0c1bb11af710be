"""The case a run computes: a stored case with the analyses asked of it."""

from __future__ import annotations

import json
from collections.abc import Sequence

from solver.case import ANALYSES, Case, parse_case
from solver.outcome import CaseError, FieldError


def stored_case(canonical: str, analyses: Sequence[str] | None = None) -> Case:
    """The case from its canonical JSON; with `analyses`, a choice of those it has.

    Raises CaseError where one is asked for that the case does not hold.
    """
    data = json.loads(canonical)
    if analyses is not None:
        held = data["analyses"]
        errors = [_absent(index, name, held) for index, name in enumerate(analyses) if name not in held]
        if not analyses:
            errors = [FieldError(("analyses",), "name at least one analysis, or leave this out for all of the case's")]
        if errors:
            raise CaseError(errors)
        data["analyses"] = {name: held[name] for name in ANALYSES if name in analyses}
    return parse_case(data)


def _absent(index: int, name: str, held: dict[str, object]) -> FieldError:
    return FieldError(
        ("analyses", index), f"the case does not hold this analysis; it holds: {', '.join(held)}", repr(name)[:80]
    )
