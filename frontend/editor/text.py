"""A case's YAML as a tree for the form, and the form's changes as a new text: comments, order and spelling stay.

Scalars of the tree are texts as they were written (`170 m`, `1e9`), booleans and null themselves. Changes to one scalar touch
only its own characters; changes of structure go through ruamel.yaml, which keeps comments and the style of the rest.
"""

from __future__ import annotations

import io
import re
from typing import Any

import yaml
from ruamel.yaml import YAML
from ruamel.yaml.comments import CommentedMap, CommentedSeq
from ruamel.yaml.error import YAMLError as RuamelError

MAX_TEXT = 1_000_000
MAX_DEPTH = 30
Path = tuple[str | int, ...]

_SAFE_PLAIN = re.compile(r"(?!-(?:\s|$))[A-Za-z0-9_.+\-][^,\[\]{}#:&*!|>'\"%@`\n]*")
_LOOKS_OTHERWISE = re.compile(r"(?i)(null|true|false|~|\.inf|\.nan|[-+]?[0-9.][0-9.eE+\-]*)")


class EditError(ValueError):
    """The text cannot be read or changed; `line` counts from 1."""

    def __init__(self, message: str, line: int | None = None) -> None:
        super().__init__(message)
        self.line = line


def read(text: str) -> Any:
    """The tree of a text; an empty one is an empty mapping. Raises EditError."""
    node = _compose(text)
    return {} if node is None else _plain(node, 0)


def _compose(text: str) -> yaml.Node | None:
    if len(text) > MAX_TEXT:
        raise EditError(f"the text is {len(text)} characters long; allowed: at most {MAX_TEXT}")
    try:
        depth = 0
        for event in yaml.parse(text, Loader=yaml.CSafeLoader):
            depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
            if depth > MAX_DEPTH:
                raise EditError("the text is nested too deeply", _line(event))
            if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None):
                raise EditError("the form does not follow anchors; write the values out", _line(event))
        node = yaml.compose(text, Loader=yaml.CSafeLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        said = error.problem or error.context or "this is not YAML"
        raise EditError(f"not valid YAML: {said}", min(mark.line, text.count("\n")) + 1 if mark else None) from None
    except yaml.YAMLError as error:
        raise EditError(f"not valid YAML: {str(error)[:120]}") from None
    if node is not None and not isinstance(node, yaml.MappingNode):
        raise EditError("a case is a mapping of keys", node.start_mark.line + 1)
    return node


def _line(event: yaml.Event) -> int | None:
    return event.start_mark.line + 1 if event.start_mark else None


def _plain(node: yaml.Node, depth: int) -> Any:
    if isinstance(node, yaml.MappingNode):
        return {str(key.value): _plain(value, depth + 1) for key, value in node.value}
    if isinstance(node, yaml.SequenceNode):
        return [_plain(item, depth + 1) for item in node.value]
    plain = isinstance(node, yaml.ScalarNode) and node.style is None
    if plain and node.value in ("true", "false"):
        return node.value == "true"
    if plain and node.value in ("", "null", "~"):
        return None
    return node.value


def find(node: yaml.Node | None, path: Path) -> yaml.Node | None:
    """The node at a path, or None."""
    for part in path:
        if isinstance(node, yaml.MappingNode):
            node = next((value for key, value in node.value if key.value == str(part)), None)
        elif isinstance(node, yaml.SequenceNode) and isinstance(part, int) and part < len(node.value):
            node = node.value[part]
        else:
            return None
    return node


def scalar(value: Any, words: bool = False) -> str:
    """A value as YAML writes it. `words`: a free text, which must stay one though it may look like a number."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    text = str(value).strip() if not words else str(value)
    plain = _SAFE_PLAIN.fullmatch(text) and not text.endswith(" ")
    if plain and not (words and _LOOKS_OTHERWISE.fullmatch(text)):
        return text
    if _LOOKS_OTHERWISE.fullmatch(text) and not words:
        return text
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{escaped}"'


def set_scalar(text: str, path: Path, value: Any, words: bool = False) -> str | None:
    """The text with one existing scalar replaced, all else untouched; None when there is no such scalar."""
    node = find(_compose(text), path)
    if not isinstance(node, yaml.ScalarNode) or node.style in ("|", ">"):
        return None
    start, end = node.start_mark.index, node.end_mark.index
    if start == end:
        return None
    return text[:start] + scalar(value, words) + text[end:]


def document(text: str) -> tuple[YAML, CommentedMap]:
    """The text as something whose structure can be changed."""
    _compose(text)
    made = YAML()
    made.width = 100_000
    made.preserve_quotes = True
    made.indent(mapping=2, sequence=4, offset=2)
    try:
        loaded = made.load(text)
    except RuamelError as error:
        raise EditError(f"not valid YAML: {str(error)[:200]}") from None
    return made, loaded if isinstance(loaded, CommentedMap) else CommentedMap()


def written(made: YAML, root: CommentedMap) -> str:
    out = io.StringIO()
    made.dump(root, out)
    return out.getvalue()


def node_of(value: Any, flow: bool | None = None, words: bool = False) -> Any:
    """Plain data as a node in the house style: mappings of mappings in blocks, small things on one line."""
    if isinstance(value, dict):
        mapping = CommentedMap((key, node_of(item, words=words)) for key, item in value.items())
        small = not value or (len(value) <= 8 and not any(_deep(item) for item in value.values()))
        if small if flow is None else flow:
            mapping.fa.set_flow_style()
        return mapping
    if isinstance(value, list):
        sequence = CommentedSeq(node_of(item, words=words) for item in value)
        if not any(_deep(item) for item in value if isinstance(item, dict)):
            sequence.fa.set_flow_style()
        return sequence
    if value is None or isinstance(value, bool):
        return value
    return YAML().load(f"a: {scalar(value, words)}")["a"]


def _deep(item: Any) -> bool:
    return isinstance(item, dict) and any(isinstance(part, dict | list) for part in item.values())
