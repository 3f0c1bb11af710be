"""JSON pointers (RFC 6901) into a case: looked up, and replaced without touching the original."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from solver.outcome import CaseError, FieldError

LENGTH = 500


def parts_of(pointer: str) -> tuple[str, ...]:
    """`/a/b~1c` -> ("a", "b/c"). Raises ValueError with what is wrong."""
    if len(pointer) > LENGTH:
        raise ValueError(f"a pointer has at most {LENGTH} characters")
    if not pointer.startswith("/") or pointer == "/":
        raise ValueError("a pointer starts with / and names a place, such as /environment/seastates/0/hs")
    if not pointer.isprintable():
        raise ValueError("a pointer holds no control characters")
    return tuple(part.replace("~1", "/").replace("~0", "~") for part in pointer[1:].split("/"))


def replaced(document: Any, changes: Mapping[str, Any]) -> Any:
    """A copy of the document with other values at the pointers; what is not changed is shared with the original.

    A member that an object has not may be added (the case's schema says whether it exists); a place in a list must be.
    Raises CaseError, its location the pointer.
    """
    fresh: set[int] = set()
    errors = []
    for pointer, value in changes.items():
        try:
            document = _put(document, parts_of(pointer), value, fresh)
        except ValueError as error:
            errors.append(FieldError((pointer,), str(error), repr(value)[:80]))
    if errors:
        raise CaseError(errors)
    return document


def _put(node: Any, parts: tuple[str, ...], value: Any, fresh: set[int]) -> Any:
    key = _key(node, parts)
    if id(node) not in fresh:
        node = dict(node) if isinstance(node, dict) else list(node)
        fresh.add(id(node))
    if len(parts) == 1:
        node[key] = value
    elif isinstance(node, dict) and key not in node:
        raise ValueError(f"there is no {parts[0]!r} here; there are: {', '.join(map(str, node))[:200]}")
    else:
        node[key] = _put(node[key], parts[1:], value, fresh)
    return node


def _key(node: Any, parts: tuple[str, ...]) -> Any:
    if isinstance(node, dict):
        return parts[0]
    if isinstance(node, list):
        if parts[0].isascii() and parts[0].isdigit() and int(parts[0]) < len(node):
            return int(parts[0])
        raise ValueError(f"{parts[0]!r} is no place in a list of {len(node)}; allowed: 0 to {len(node) - 1}")
    raise ValueError(f"{'/'.join(parts)!r} leads beyond a single value")


def value_at(document: Any, pointer: str) -> Any:
    """The value there, or None."""
    for part in parts_of(pointer):
        try:
            document = document[int(part)] if isinstance(document, list) else document[part]
        except (KeyError, IndexError, ValueError, TypeError):
            return None
    return document
