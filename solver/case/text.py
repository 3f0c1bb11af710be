"""YAML and JSON text to a case and back, for text from anybody.

The reader is PyYAML's safe one with YAML 1.2 numbers (`1e9` is a number, `1:30` is not), no repeated keys, bounded
size, depth and node count; aliases count at their full expansion, so that a small text cannot become a large case.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import yaml

from ..outcome import CaseError, FieldError
from .case import MOST_FAULTS, Case, examine_case, too_many

MAX_BYTES = 1_000_000
MAX_NODES = 200_000
MAX_DEPTH = 30


class _Loader(yaml.CSafeLoader if hasattr(yaml, "CSafeLoader") else yaml.SafeLoader):  # type: ignore[misc]
    """Safe loader with YAML 1.2's core numbers and booleans."""


_Loader.yaml_implicit_resolvers = {}
_CORE: dict[str, re.Pattern[str]] = {}
for _tag, _pattern, _first in (
    ("tag:yaml.org,2002:bool", r"^(?:true|True|TRUE|false|False|FALSE)$", "tTfF"),
    ("tag:yaml.org,2002:int", r"^[-+]?[0-9]+$", "-+0123456789"),
    (
        "tag:yaml.org,2002:float",
        r"^(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$",
        "-+0123456789.",
    ),
    ("tag:yaml.org,2002:null", r"^(?:~|null|Null|NULL|)$", ["~", "n", "N", ""]),
    ("tag:yaml.org,2002:merge", r"^(?:<<)$", "<"),
):
    _CORE[_tag] = re.compile(_pattern)
    _Loader.add_implicit_resolver(_tag, _CORE[_tag], list(_first))


def _int(loader: Any, node: yaml.ScalarNode) -> int | float:
    text = str(loader.construct_scalar(node))
    return int(text) if len(text) < 20 else float(text)


def _float(loader: Any, node: yaml.ScalarNode) -> float:
    return float(str(loader.construct_scalar(node)).lower().replace(".inf", "inf").replace(".nan", "nan"))


_Loader.add_constructor("tag:yaml.org,2002:int", _int)
_Loader.add_constructor("tag:yaml.org,2002:float", _float)


Loc = tuple[str | int, ...]


@dataclass
class Reading:
    """What a text says: the case, the fields at fault lacking (partial.py), the faults, and the line of every path."""

    case: Case | None
    errors: list[FieldError]
    lines: Mapping[Loc, int]

    @classmethod
    def of(cls, data: Any, lines: Mapping[Loc, int] | None = None, errors: Iterable[FieldError] = ()) -> Reading:
        """Of plain data. lines : line of every path, where there is a text; errors : faults known already."""
        case, found = examine_case(data)
        reading = cls(case, [], lines or {})
        reading.add([*errors, *found])
        return reading

    def add(self, errors: Iterable[FieldError]) -> None:
        """Add faults, each with its line."""
        self.errors += [error if error.line else with_line(error, self.lines) for error in errors]

    def sound(self) -> Case:
        """The case. Raises CaseError with every fault, by line, or with the first MOST_FAULTS."""
        if self.errors or self.case is None:
            raise CaseError(first_of(sorted(self.errors, key=lambda error: error.place)))
        return self.case


def first_of(errors: list[FieldError]) -> list[FieldError]:
    """All, or the first MOST_FAULTS after one that tells how many there are."""
    if len(errors) <= MOST_FAULTS + 1:
        return errors
    return [too_many(len(errors)), *errors[:MOST_FAULTS]]


def load_case(text: str | bytes) -> Case:
    """A checked case from YAML or JSON text (JSON is read as the YAML it is).

    Raises CaseError; each error carries the line of its field in the text.
    """
    return read_case(text).sound()


def read_case(text: str | bytes) -> Reading:
    """A case and all its faults from YAML or JSON text. Raises CaseError for a text that cannot be read as such."""
    return Reading.of(*read_document(text))


def read_text(text: str | bytes) -> tuple[Any, dict[Loc, int]]:
    """Plain data and the line number of every path, from YAML or JSON text. Raises CaseError."""
    data, lines, repeated = read_document(text)
    if repeated:
        raise CaseError(first_of(repeated))
    return data, lines


def read_document(text: str | bytes) -> tuple[Any, dict[Loc, int], list[FieldError]]:
    """As `read_text`, with a fault for each key that is given twice, of which the data hold the last."""
    if len(text) > MAX_BYTES:
        raise CaseError([FieldError((), f"the text has {len(text)} bytes; allowed: at most {MAX_BYTES}")])
    try:
        text = text.decode("utf-8-sig") if isinstance(text, bytes) else text.encode().decode()
    except UnicodeError as error:
        at, reason = getattr(error, "start", 0), getattr(error, "reason", "")
        raise CaseError([FieldError((), f"the text is not UTF-8: {reason} at byte {at}")]) from None
    try:
        root = _compose(text)
        lines, repeated = _walk(root)
        return _construct(root), lines, repeated
    except yaml.YAMLError as error:
        mark = error.problem_mark if isinstance(error, yaml.MarkedYAMLError) else None
        problem = getattr(error, "problem", None) or str(error).splitlines()[0]
        raise CaseError([FieldError((), f"not valid YAML: {problem}", line=mark.line + 1 if mark else None)]) from None
    except RecursionError:
        raise CaseError([FieldError((), f"nested too deeply; allowed: at most {MAX_DEPTH} levels")]) from None


_PAIR = re.compile(r"(?<!\\)((?:\\\\)*)\\u([dD][89abAB][0-9a-fA-F]{2})\\u([dD][c-fC-F][0-9a-fA-F]{2})")


def _whole_letters(text: str) -> str:
    """JSON writes letters beyond 16 bits as two escapes, which YAML does not know: one escape in their place."""
    return _PAIR.sub(
        lambda found: f"{found[1]}\\U{0x10000 + ((int(found[2], 16) & 0x3FF) << 10) + (int(found[3], 16) & 0x3FF):08x}",
        text,
    )


def _compose(text: str) -> yaml.Node:
    depth = 0
    if text.lstrip().startswith("{"):
        text = _whole_letters(text)
    for event in yaml.parse(text, Loader=_Loader):  # a cheap pass, so that deep nesting never recurses
        depth += isinstance(event, yaml.CollectionStartEvent)
        depth -= isinstance(event, yaml.CollectionEndEvent)
        if depth > MAX_DEPTH:
            line = event.start_mark.line + 1 if event.start_mark else None
            raise CaseError([FieldError((), f"nested too deeply; allowed: at most {MAX_DEPTH} levels", line=line)])
    root = yaml.compose(text, Loader=_Loader)
    if not isinstance(root, yaml.MappingNode):
        raise CaseError([FieldError((), "a case is a mapping of keys to values; this text holds none")])
    return root


def _construct(root: yaml.Node) -> Any:
    loader = _Loader("")
    try:
        return loader.construct_document(root)
    finally:
        loader.dispose()


def _walk(root: yaml.Node) -> tuple[dict[Loc, int], list[FieldError]]:
    """Line of every path, that of its key where it has one, and repeated keys; refuses expansion beyond MAX_NODES."""
    lines: dict[Loc, int] = {}
    repeated: list[FieldError] = []
    stack: list[tuple[Loc, yaml.Node, int]] = [((), root, root.start_mark.line + 1)]
    count = 0
    while stack:
        loc, node, line = stack.pop()
        count += 1
        if count > MAX_NODES or len(loc) > MAX_DEPTH:
            raise CaseError(
                [FieldError((), f"expands to more than {MAX_NODES} values or {MAX_DEPTH} levels (aliases?)")]
            )
        lines[loc] = line
        _plain(loc, node)
        if isinstance(node, yaml.MappingNode):
            values: dict[str, tuple[yaml.Node, int]] = {}
            for key, value in node.value:
                _plain(loc, key, is_key=True)
                name, line = str(key.value), key.start_mark.line + 1
                if name in values:
                    repeated.append(FieldError((*loc, name), "this key is given twice", line=line))
                values[name] = value, line
            stack.extend(((*loc, name), value, line) for name, (value, line) in values.items())
        elif isinstance(node, yaml.SequenceNode):
            stack.extend(((*loc, index), value, value.start_mark.line + 1) for index, value in enumerate(node.value))
    return lines, repeated


def _plain(loc: tuple[str | int, ...], node: yaml.Node, is_key: bool = False) -> None:
    """Refuses tags beyond YAML's core, tags their text does not match, and keys that are not scalars."""
    line = node.start_mark.line + 1
    if is_key and not isinstance(node, yaml.ScalarNode):
        raise CaseError([FieldError(loc, "a key must be a plain word, not a list or a mapping", line=line)])
    if isinstance(node, yaml.ScalarNode):
        pattern = _CORE.get(node.tag)
        fits = node.tag == "tag:yaml.org,2002:str" or (pattern is not None and pattern.match(node.value) is not None)
    else:
        kind = "map" if isinstance(node, yaml.MappingNode) else "seq"
        fits = node.tag == f"tag:yaml.org,2002:{kind}"
    if not fits:
        tag = node.tag.rsplit(":", 1)[-1][:40]
        raise CaseError(
            [FieldError(loc, f"not valid YAML: tag {tag!r} is not allowed, or not with this value", line=line)]
        )


def with_line(error: FieldError, lines: Mapping[Loc, int]) -> FieldError:
    """The error with the line of its field, or of what holds it."""
    loc = error.loc
    while loc and loc not in lines:
        loc = loc[:-1]
    return FieldError(error.loc, error.message, error.value, lines.get(loc))


class _Dumper(yaml.SafeDumper):
    """Safe dumper that quotes whatever this reader, or one of YAML 1.1, would not take for the text it is."""


for _letter, _resolvers in _Loader.yaml_implicit_resolvers.items():
    for _tag, _regexp in _resolvers:
        _Dumper.add_implicit_resolver(_tag, _regexp, [_letter])


def _str(dumper: Any, text: str) -> yaml.ScalarNode:
    """YAML's rarer line ends would be read as other ones, unless they are escaped."""
    style = '"' if re.search("[\x85\u2028\u2029]", text) else None
    node: yaml.ScalarNode = dumper.represent_scalar("tag:yaml.org,2002:str", text, style=style)
    return node


_Dumper.add_representer(str, _str)


def write_text(data: Any, **style: Any) -> str:
    """A mapping as YAML, its texts and numbers such that `read_text` reads the same; `style` as in yaml.dump."""
    text: str = yaml.dump(data, Dumper=_Dumper, sort_keys=False, allow_unicode=True, **style)
    return text


def to_yaml(case: Case) -> str:
    """The case as YAML in SI, angles as `… rad`; reads back to an equal case."""
    return write_text(json.loads(case.canonical()))
