"""What the form asks of the pages' own server: what this text holds, and what it is after these edits."""

from __future__ import annotations

from typing import Any

import flask

from frontend.editor import edits
from frontend.editor.text import MAX_TEXT, EditError, read

MAX_EDITS = 200


def register(server: flask.Flask) -> None:
    server.add_url_rule("/editor/read", view_func=_read, methods=["POST"], endpoint="editor-read")
    server.add_url_rule("/editor/apply", view_func=_apply, methods=["POST"], endpoint="editor-apply")


def _sent() -> dict[str, Any]:
    if (flask.request.content_length or 0) > 2 * MAX_TEXT:
        flask.abort(413)
    sent = flask.request.get_json(silent=True)
    if not isinstance(sent, dict) or not isinstance(sent.get("text"), str):
        flask.abort(400)
    return sent


def _told(text: str) -> dict[str, Any]:
    """The tree, or what keeps the form from showing one."""
    try:
        return {"text": text, "tree": read(text), "error": None}
    except EditError as error:
        return {"text": text, "tree": None, "error": {"message": str(error), "line": error.line}}


def _read() -> flask.Response:
    return flask.jsonify(_told(_sent()["text"]))


def _apply() -> flask.Response:
    """A refused edit leaves the text as it was and says why."""
    sent = _sent()
    wanted = sent.get("edits")
    if not isinstance(wanted, list) or len(wanted) > MAX_EDITS or not all(isinstance(edit, dict) for edit in wanted):
        flask.abort(400)
    try:
        text = edits.apply(sent["text"], wanted)
    except EditError as error:
        return flask.jsonify(_told(sent["text"]) | {"refused": str(error)})
    return flask.jsonify(_told(text))
