"""No query goes around the scope: read from the source, so that one that no test calls is found too.

A class of `store/repositories` that derives from Scoped names a table with a project_id in a query only where it also
passes `_mine`, `_select` or `_one` for that table. Whatever else asks the database is listed here, with the reason.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from store import hydrodynamics, people  # noqa: F401  (their tables belong to the metadata)
from store.models import Base

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "store" / "repositories"
BUILDERS = {"select", "update", "delete", "select_from", "join", "get", "get_one", "exists"}
HELPERS = {"_mine", "_select", "_one"}

UNSCOPED = {
    "EntryRepository": "finds out whom a credential belongs to, and so the scope",
    "AccountRepository": "accounts belong to no project",
    "TeamRepository": "called with the team that api/access.py has let the caller into",
    "ChannelRepository": "reached through a run of the caller's scope",
    "PreviewRepository": "a letter box for a minute; nobody lists it, and only its own request knows the id",
    "TaskRepository": "a worker's: it holds a task, whoever asked for it",
    "RecoveryRepository": "puts right what faults leave behind, of all projects",
    "HydrodynamicTasks": "a worker's",
    "QueueRepository": "counts of the queues, for operators",
    "WatchRepository": "marks of runs that listeners were let into; what has changed is asked for with their scope",
    "TurnRepository": "sums over the queue, of all teams",
    "UsageRepository": "sums over the caller's team, of all its projects",
}
BY_KEY = {
    "CaseRepository.save": "numbers the versions of a case that it has looked up in its scope",
    "CaseRepository.delete": "counts what refers to a case that it has looked up in its scope",
    "DataSetRepository.delete": "counts what refers to a data set that it has looked up in its scope",
    "IdempotencyRepository.sweep": "forgets old ones, of all projects",
    "StudyRepository.cancel": "runs of a study that it has looked up in its scope",
    "StudyRepository.delete": "runs of a study that it has looked up in its scope",
    "StudyRepository._amounts": "sums over studies that were looked up in its scope",
}
"""Functions that name a table with a project_id by the key of a row found in the scope."""

OUTSIDE = {
    "store/database.py": "the ping",
    "store/clock.py": "an expression",
    "store/models.py": "columns",
    "store/hydrodynamics.py": "columns",
    "store/people.py": "columns",
    "store/migrations/__init__.py": "the schema's version",
    "store/health.py": "a row that the health check itself has written",
    "store/estimate.py": "sums over the whole queue: how long a run has to wait depends on everybody's",
    "store/filters.py": "conditions, for a repository's query",
}


def tables_with_a_project() -> set[str]:
    return {mapper.class_.__name__ for mapper in Base.registry.mappers if "project_id" in mapper.columns}


def functions(tree: ast.Module) -> Iterator[tuple[str, ast.FunctionDef]]:
    """("Class.function", node) of methods; of functions of the module too, without a class."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            yield from ((f"{node.name}.{part.name}", part) for part in node.body if isinstance(part, ast.FunctionDef))
        elif isinstance(node, ast.FunctionDef):
            yield node.name, node


def called(node: ast.Call) -> str:
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def models_in(call: ast.Call, known: set[str]) -> set[str]:
    """The models that a call's arguments name, other than as an argument of a call inside."""
    found: set[str] = set()
    for argument in call.args:
        inner = {id(part) for each in ast.walk(argument) if isinstance(each, ast.Call) for part in ast.walk(each)}
        inner -= {id(argument)}
        for part in ast.walk(argument):
            if isinstance(part, ast.Name) and part.id in known and id(part) not in inner:
                found.add(part.id)
    return found


def strays(source: str, known: set[str]) -> list[str]:
    """Functions that ask for rows with a project_id without the scope's condition."""
    found = []
    for name, function in functions(ast.parse(source)):
        if name.partition(".")[0] in UNSCOPED or name in BY_KEY:
            continue
        asked: set[str] = set()
        passed: set[str] = set()
        for call in (node for node in ast.walk(function) if isinstance(node, ast.Call)):
            if called(call) in BUILDERS:
                asked |= models_in(call, known)
            if called(call) in HELPERS:
                passed |= {part.id for part in call.args if isinstance(part, ast.Name)}
        found += [f"{name}: {model}" for model in sorted(asked - passed)]
    return found


def repositories() -> list[Path]:
    return sorted(path for path in FOLDER.glob("*.py") if path.name not in ("__init__.py", "scoped.py"))


@pytest.mark.parametrize("path", repositories(), ids=lambda path: path.stem)
def test_every_query_passes_the_scope(path: Path) -> None:
    assert strays(path.read_text(), tables_with_a_project()) == []


def test_the_check_finds_a_stray() -> None:
    known = tables_with_a_project()
    assert {"Run", "CaseVersion", "DataSet", "Case", "Share", "Study", "Mesh"} <= known
    head = "class RunRepository(Scoped):\n def f(self, key):\n  return "
    for query in (
        "self.session.get(Run, key)",
        "self.session.scalars(select(Run).where(Run.id == key))",
        "self.session.scalar(select(func.count()).select_from(Run))",
        "self.session.scalar(select(Run.state))",
        "self.session.execute(delete(Run).where(Run.id == key))",
        "self.session.execute(select(Task).join(Run))",
        "self.session.scalars(select(Run).where(self._mine(DataSet)))",
    ):
        assert strays(head + query, known) == ["RunRepository.f: Run"], query
    assert strays(head + "self.session.scalars(select(Run).where(self._mine(Run)))", known) == []


def test_only_repositories_ask_the_database() -> None:
    builders = {"select", "update", "delete", "insert", "text", "exists", "union"}
    strange = []
    for folder in ("api", "worker", "cli", "frontend", "store"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            if name in OUTSIDE or name.startswith(("store/repositories/", "store/migrations/versions/")):
                continue
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("sqlalchemy"):
                    strange += [f"{name}: {part.name}" for part in node.names if part.name in builders]
    assert strange == []


def test_the_lists_hold_nothing_old() -> None:
    known = {name for path in repositories() for name, _ in functions(ast.parse(path.read_text()))}
    assert not {name for name in BY_KEY if name not in known}
    classes = {name.partition(".")[0] for name in known if "." in name}
    assert not {name for name in UNSCOPED if name not in classes}
    assert not {name for name in OUTSIDE if not (ROOT / name).is_file()}
