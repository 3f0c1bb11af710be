"""The validation ledger names tests, pages and plots that exist, and its page is what its table gives."""

from __future__ import annotations

import ast
import importlib.util
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


def _load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_ledger", ROOT / "docs/make_ledger.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


make_ledger = _load()
ROWS: list[dict[str, Any]] = make_ledger.rows()


def missing(test: str) -> bool:
    """Whether a row names a file, or a test function in it, that does not exist."""
    file, _, name = test.partition("::")
    if not (ROOT / file).is_file():
        return True
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    return name not in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["id"])
def test_a_row_names_what_exists(row: dict[str, Any]) -> None:
    assert not missing(row["test"]), row["test"]
    for key in ("plot", "page"):
        assert key not in row or (ROOT / "docs" / row[key]).is_file()
    assert all(str(row[key]).strip() for key in ("claim", "acceptance", "reference_what", "reference_licence"))


def test_a_row_with_an_invented_test_is_found() -> None:
    assert missing("tests/statics/test_sweep.py::test_that_nobody_wrote")
    assert missing("tests/statics/test_nowhere.py::test_the_sweep_covers_its_ranges")


def test_ids_are_different_and_there_are_more_than_sixty_rows() -> None:
    assert len({row["id"] for row in ROWS}) == len(ROWS) > 60


def test_experiment_sweep_and_shortfalls_are_among_the_rows() -> None:
    assert {row["group"] for row in ROWS} >= {"Physical experiment"}
    assert any("sweep" in row["claim"] for row in ROWS)
    assert sum("known" in row for row in ROWS) >= 2


def test_the_page_is_what_table_and_results_give() -> None:
    page = (ROOT / "docs/validation-ledger.md").read_text(encoding="utf-8")
    assert page == make_ledger.page(make_ledger.read_results())
    assert "FAILED" not in page


def test_a_failure_is_shown(tmp_path: Path) -> None:
    """Cases of one test together: one that fails counts for all; what they recorded is the result."""
    report = tmp_path / "run.xml"
    report.write_text(
        '<testsuites><testsuite><testcase classname="tests.statics.test_sweep" name="test_the_sweep_covers_its_ranges"/>'
        '<testcase classname="tests.verification.test_chain_experiment" name="test_the_whole_table[1]"><properties>'
        '<property name="result" value="3.1 %"/></properties></testcase>'
        '<testcase classname="tests.verification.test_chain_experiment" name="test_the_whole_table[2]"><failure/></testcase>'
        "</testsuite></testsuites>"
    )
    found = make_ledger.outcomes([report])
    assert found["tests/statics/test_sweep.py::test_the_sweep_covers_its_ranges"]["status"] == "passed"
    assert found["tests/verification/test_chain_experiment.py::test_the_whole_table"] == {
        "status": "FAILED",
        "result": "3.1 %",
    }
    (line,) = (one for one in make_ledger.page(found).splitlines() if one.startswith("| X2 |"))
    assert "FAILED" in line
