"""A case with faults, read as far as it can be, so that one reading finds all of them.

A field that cannot be read is lacking from its part, and raises `Unread` when a check asks for it: the check is left
out, and no fault is reported that only follows from another.
"""

from __future__ import annotations

import types
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from functools import cache
from typing import Annotated, Any, TypeVar, Union, cast, get_args, get_origin

from pydantic import Discriminator, Tag, TypeAdapter, ValidationError

from ..outcome import CaseError, FieldError, Unread
from .quantities import Part

Loc = tuple[str | int, ...]
Kind = TypeVar("Kind", bound=Part)
Found = TypeVar("Found")


def known(check: Callable[..., Iterable[Found]], *arguments: Any) -> Iterator[Found]:
    """What a check finds before it asks for a field that could not be read."""
    try:
        yield from check(*arguments)
    except Unread:
        return


@contextmanager
def noted(errors: list[FieldError]) -> Iterator[None]:
    """Take down the faults that a check raises; one that asks for a field which could not be read is left out."""
    try:
        yield
    except CaseError as error:
        errors += error.errors
    except Unread:
        pass


def read_part(kind: type[Kind], data: dict[str, Any]) -> tuple[Kind, list[FieldError]]:
    """A part without the fields at fault, and the broken rules between fields of parts that have other faults.

    The faults of fields themselves are those of `kind.model_validate`.
    """
    faults: list[FieldError] = []
    return _part(kind, data, (), faults), faults


def _part(kind: type[Kind], data: dict[str, Any], loc: Loc, faults: list[FieldError]) -> Kind:
    for rule in _rules(kind, "before"):
        data = getattr(kind, rule)(data)
    names = {field.alias or name: name for name, field in kind.model_fields.items()}
    strange = [key for key in data if key not in names and key not in kind.model_fields]
    values, lacking = {}, set()
    for key, name in names.items():
        given = next((one for one in (key, name) if one in data), None)
        if given is not None:
            try:
                values[name] = _value(_annotation(kind, name), data[given], (*loc, key), faults)
            except Unread:
                lacking.add(name)
        elif kind.model_fields[name].is_required() or get_close_matches(key, map(str, strange), 1):
            lacking.add(name)
    made = cast(Kind, kind.model_construct(None, **values))
    _drop(made, lacking)
    if not _obeys(made, loc, faults):
        _drop(made, _own_values(made))
    return made


def _drop(part: Part, names: Iterable[str]) -> None:
    for name in names:
        part.__dict__.pop(name, None)


def _obeys(part: Part, loc: Loc, faults: list[FieldError]) -> bool:
    """Whether the rules between the fields hold, as far as the fields are known."""
    for rule in _rules(type(part), "after"):
        try:
            getattr(part, rule)()
        except Unread:
            continue
        except ValueError as error:
            faults.append(FieldError(loc, str(error)))
            return False
    return True


def _rules(kind: type[Part], mode: str) -> list[str]:
    """Names of the validators of a whole part that run `before` its fields are read, or `after`."""
    return [name for name, rule in kind.__pydantic_decorators__.model_validators.items() if rule.info.mode == mode]


def _own_values(part: Part) -> list[str]:
    """The fields a broken rule may be about: all but names and what has parts of its own."""
    kept = str | Part | dict
    return [
        name
        for name, value in part.__dict__.items()
        if not isinstance(value, kept) and not (isinstance(value, tuple) and value and isinstance(value[0], Part))
    ]


@cache
def _annotation(kind: type[Part], name: str) -> Any:
    field = kind.model_fields[name]
    return Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation


def _value(wanted: Any, data: Any, loc: Loc, faults: list[FieldError]) -> Any:
    """A value of the wanted type, its parts read in part. Raises Unread."""
    try:
        return _adapter_of(wanted).validate_python(data)
    except ValidationError:
        pass
    except RecursionError:
        raise Unread from None
    plain = _plain(wanted)
    if get_origin(plain) is dict and isinstance(data, dict):
        inner = get_args(plain)[1]
        return {key: _item(inner, value, (*loc, key), faults) for key, value in data.items() if isinstance(key, str)}
    if get_origin(plain) is tuple and get_args(plain)[1:] == (...,) and isinstance(data, list | tuple):
        inner = get_args(plain)[0]
        return tuple(_item(inner, value, (*loc, index), faults) for index, value in enumerate(data))
    if isinstance(plain, type) and issubclass(plain, Part) and isinstance(data, dict):
        return _part(plain, data, loc, faults)
    raise Unread


def _item(wanted: Any, data: Any, loc: Loc, faults: list[FieldError]) -> Any:
    """One of many: where nothing of a part can be read it is there all the same, for others may refer to it."""
    kind = _chosen(wanted, data)
    if not (isinstance(kind, type) and issubclass(kind, Part)):
        return _value(wanted, data, loc, faults)
    if not isinstance(data, dict):
        made = kind.model_construct(None)
        _drop(made, kind.model_fields)
        return made
    return _value(kind, data, loc, faults)


def _chosen(wanted: Any, data: Any) -> Any:
    """The type itself or, of several told apart by a function, the one that the data are. Raises Unread."""
    plain, marks = (get_args(wanted)[0], get_args(wanted)[1:]) if get_origin(wanted) is Annotated else (wanted, ())
    tell = next((mark.discriminator for mark in marks if isinstance(mark, Discriminator)), None)
    if tell is None or not callable(tell):
        return plain
    tag = tell(data) if isinstance(data, dict) else None
    for one in get_args(plain):
        kind, *given = get_args(one)
        if any(isinstance(mark, Tag) and mark.tag == tag for mark in given):
            return kind
    raise Unread


def _plain(wanted: Any) -> Any:
    """The type without its limits and without None."""
    while get_origin(wanted) is Annotated:
        wanted = get_args(wanted)[0]
    if get_origin(wanted) in (Union, types.UnionType):
        others = [one for one in get_args(wanted) if one is not type(None)]
        return _plain(others[0]) if len(others) == 1 else wanted
    return wanted


_adapters: dict[int, tuple[Any, TypeAdapter[Any]]] = {}


def _adapter_of(wanted: Any) -> TypeAdapter[Any]:
    """Kept by the identity of the type, for not all annotations can be hashed."""
    found = _adapters.get(id(wanted))
    if found is None or found[0] is not wanted:
        found = _adapters[id(wanted)] = (wanted, TypeAdapter(wanted))
    return found[1]
