"""Writes slowdrift_client/models.py from the service's OpenAPI: `python docs/make_client.py` (`--check` only compares).

datamodel-code-generator makes the classes; only those that the client answers with are asked of it.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
TARGET = ROOT / "slowdrift_client" / "models.py"
ANSWERS = (
    "CaseCheck", "CaseInfo", "ChannelPage", "ChannelValues", "DataSetInfo", "QueueInfo", "RunCase", "RunInfo",
    "RunPage", "StudyInfo", "StudyPage", "StudyTable",
)  # fmt: skip
HEADER = '"""What the service answers. Made from its OpenAPI by docs/make_client.py; change nothing here."""'
OPTIONS = (
    "--input-file-type", "openapi", "--output-model-type", "pydantic_v2.BaseModel", "--target-python-version", "3.11",
    "--use-standard-collections", "--use-union-operator", "--use-schema-description", "--disable-timestamp",
    "--field-constraints", "--use-annotated", "--collapse-root-models", "--formatters", "black", "isort",
    "--extra-fields", "allow", "--custom-file-header", HEADER,
)  # fmt: skip


def specification() -> dict[str, Any]:
    """The OpenAPI of the service, cut down to the answers of the client and what they refer to."""
    warnings.simplefilter("ignore")
    from api.main import create_app
    from store.settings import Settings

    with tempfile.TemporaryDirectory() as folder:
        whole = create_app(Settings(data_dir=Path(folder)), reconcile=False).openapi()
    schemas, kept, wanted = whole["components"]["schemas"], {}, list(ANSWERS)
    while wanted:
        name = wanted.pop()
        if name not in kept:
            kept[name] = schemas[name]
            text = json.dumps(schemas[name])
            wanted += [other for other in schemas if f'"#/components/schemas/{other}"' in text]
    for schema in kept.values():
        _plain(schema)
    return {
        "openapi": "3.1.0",
        "info": whole["info"],
        "paths": {},
        "components": {"schemas": dict(sorted(kept.items()))},
    }


def _plain(node: Any) -> None:
    """Examples and titles say nothing to a client's types."""
    if isinstance(node, dict):
        if not isinstance(node.get("title"), dict):
            node.pop("title", None)
        node.pop("examples", None)
        for value in node.values():
            _plain(value)
    elif isinstance(node, list):
        for value in node:
            _plain(value)


def generate() -> str:
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder) / "openapi.json", Path(folder) / "models.py"
        source.write_text(json.dumps(specification()))
        command = [sys.executable, "-m", "datamodel_code_generator", "--input", str(source), "--output", str(target)]
        subprocess.run([*command, *OPTIONS], check=True, capture_output=True, text=True, cwd=folder)
        command = [sys.executable, "-m", "ruff", "format", "--config", str(ROOT / "pyproject.toml"), str(target)]
        subprocess.run(command, check=True, capture_output=True, text=True)
        return target.read_text()


def main() -> int:
    made = generate()
    if "--check" in sys.argv:
        if made != TARGET.read_text():
            print("slowdrift_client/models.py is not what the service answers; run python docs/make_client.py")
            return 1
        return 0
    TARGET.write_text(made)
    return 0


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT))
    sys.exit(main())
