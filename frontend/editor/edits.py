"""What the form may do to a text: set, remove, append, rename, and copy, mirror or repeat lines."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ruamel.yaml.comments import CommentedMap, CommentedSeq

from frontend.editor import pattern
from frontend.editor.text import EditError, Path, document, node_of, read, set_scalar, written

Edit = dict[str, Any]


def apply(text: str, edits: list[Edit]) -> str:
    """The text after the edits, in order. Raises EditError with a sentence; then nothing was changed."""
    for edit in edits:
        text = _one(text, edit)
    return text


def _one(text: str, edit: Edit) -> str:
    path, value = _path(edit.get("path")), edit.get("value")
    words = bool(edit.get("words"))
    if edit.get("op") == "set" and not isinstance(value, dict | list):
        changed = set_scalar(text, path, value, words)
        if changed is not None:
            return changed
    act = ACTIONS.get(str(edit.get("op")))
    if act is None:
        raise EditError(f"no edit {edit.get('op')!r}; known: {', '.join(ACTIONS)}")
    made, root = document(text)
    act(root, path, edit)
    return written(made, root)


def _path(given: Any) -> Path:
    if not isinstance(given, list) or any(not isinstance(part, str | int) or isinstance(part, bool) for part in given):
        raise EditError("a path is a list of keys and positions")
    return tuple(given)


def _reach(root: Any, path: Path, make: bool = True) -> Any:
    """What stands at a path; missing mappings are made on the way."""
    here = root
    for index, part in enumerate(path):
        if isinstance(here, CommentedSeq):
            if not isinstance(part, int) or not 0 <= part < len(here):
                raise EditError(f"nothing at {'.'.join(map(str, path[: index + 1]))}")
            here = here[part]
            continue
        if not isinstance(here, CommentedMap):
            raise EditError(f"{'.'.join(map(str, path[:index]))} is a value, not a mapping")
        if here.get(part) is None:
            if not make:
                raise EditError(f"nothing at {'.'.join(map(str, path[: index + 1]))}")
            here[part] = CommentedMap() if index < 1 else node_of({})
        here = here[part]
    return here


def _set(root: CommentedMap, path: Path, edit: Edit) -> None:
    parent, node = _reach(root, path[:-1]), node_of(edit.get("value"), words=bool(edit.get("words")))
    last = path[-1]
    if isinstance(parent, CommentedSeq) and isinstance(last, int) and last == len(parent):
        parent.append(node)
    elif isinstance(parent, CommentedMap):
        if last not in parent and not parent and len(path) == 2:
            parent.fa.set_block_style()
        parent[last] = node
    elif isinstance(parent, CommentedSeq) and isinstance(last, int) and 0 <= last < len(parent):
        parent[last] = node
    else:
        raise EditError(f"nothing can be set at {'.'.join(map(str, path))}")


def _remove(root: CommentedMap, path: Path, edit: Edit) -> None:
    parent = _reach(root, path[:-1], make=False)
    try:
        del parent[path[-1]]
    except (KeyError, IndexError, TypeError):
        raise EditError(f"nothing at {'.'.join(map(str, path))}") from None


def _append(root: CommentedMap, path: Path, edit: Edit) -> None:
    parent = _reach(root, path[:-1])
    if parent.get(path[-1]) is None:
        parent[path[-1]] = CommentedSeq()
    here = parent[path[-1]]
    if not isinstance(here, CommentedSeq):
        raise EditError(f"{'.'.join(map(str, path))} is not a list")
    if not here and path[0] in ("attachments", "environment"):
        here.fa.set_block_style()
    here.append(node_of(edit.get("value"), flow=True if isinstance(edit.get("value"), dict) else None))


def _rename(root: CommentedMap, path: Path, edit: Edit) -> None:
    """A new name for a line or line type, with all that refer to it."""
    group, old, new = path[0], path[-1], str(edit.get("to") or "").strip()
    mapping = _reach(root, path[:-1], make=False)
    if old not in mapping or not new:
        raise EditError(f"nothing to rename at {'.'.join(map(str, path))}")
    if new == old:
        return
    if new in mapping:
        raise EditError(f"there is a {new!r} already; choose another name")
    mapping.insert(list(mapping).index(old), new, mapping.pop(old))
    if group == "line_types":
        for line in (root.get("lines") or {}).values():
            for segment in line.get("segments") or []:
                if segment.get("type") == old:
                    segment["type"] = new
    for item in (root.get("attachments") or []) if group == "lines" else []:
        if item.get("line") == old:
            item["line"] = new


def _lines(build: Callable[[dict[str, Any], str, Edit], dict[str, Any]]) -> Callable[[CommentedMap, Path, Edit], None]:
    """An action that adds lines made from one: `build(tree, name, edit)` gives them by name."""

    def act(root: CommentedMap, path: Path, edit: Edit) -> None:
        name = str(path[-1])
        lines = _reach(root, ("lines",), make=False)
        if name not in lines:
            raise EditError(f"no line {name!r}")
        made, _ = document("")
        tree = read(written(made, root))
        for added, line in build(tree, name, edit).items():
            if added in lines and added != name:
                raise EditError(f"there is a line {added!r} already; choose another name")
            lines[added] = node_of(line, flow=False)

    return act


ACTIONS: dict[str, Callable[[CommentedMap, Path, Edit], None]] = {
    "set": _set,
    "remove": _remove,
    "append": _append,
    "rename": _rename,
    "copy": _lines(pattern.copy),
    "mirror": _lines(pattern.mirror),
    "pattern": _lines(pattern.repeat),
}
