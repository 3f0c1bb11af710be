"""What a table shows is kept when a run ends, and is what the summary would have said."""

from __future__ import annotations

import json
from typing import Any

import pytest

from solver.case.case import MOST_FAULTS
from solver.case.text import read_case
from solver.outcome import CaseError
from store.database import Database
from store.figures import figures_of, figures_text, is_kept, plain, taken, usual
from store.models import Run
from store.reading import SMALL_TEXT, read_case_data
from store.reading import read_case as read_apart
from tests.api.conftest import TestClient
from tests.service.running import a_case

EA = "/line_types/t/EA"
SUMMARY: dict[str, Any] = {
    "frequency_domain": {
        "vessel_std": {"wf": {"surge": 1.5, "heave": 0.5}, "lf": {"surge": 4.0}},
        "lines": {"bow-port": {"tension_std": {"wf": [1e5, 3e5, 2e5]}}, "bow.odd": {"tension_std": {"wf": [1.0]}}},
    },
    "time_domain": {"lines": {"bow-port": {"tension_max": [[1e6, 2e6], [3e6, 1e6]]}}},
    "modes": [{"label": "surge", "period": 120.0, "damping_lines": 0.05}, {"label": "line", "period": 9.0}],
    "statics": {"converged": True},
}


def test_figures_are_what_the_summary_says() -> None:
    found = figures_of(SUMMARY)
    assert found["max(frequency_domain.lines.bow-port.tension_std.wf)"] == 3e5
    assert found["max(time_domain.lines.bow-port.tension_max)"] == 3e6
    assert found["modes.0.period"] == 120.0
    for name, value in found.items():
        assert is_kept(name)
        assert value == plain(taken(SUMMARY, name))
    for name in usual(SUMMARY):  # a kept name without a value has none in the summary either
        if is_kept(name) and name not in found:
            assert taken(SUMMARY, name) is None
    assert not is_kept("statics.converged")
    assert not is_kept("max(frequency_domain.lines.bow-port.tension_std)")


def test_very_many_figures_are_not_kept() -> None:
    lines = {f"line-{n}": {"tension_std": {"wf": [1.0]}} for n in range(1000)}
    assert figures_text({"frequency_domain": {"lines": lines}}) is None


@pytest.mark.parametrize("kept", [True, False])
def test_tables_are_the_same_from_either(client: TestClient, database: Database, kept: bool) -> None:
    study = client.post(
        "/api/v1/studies", json={"case": a_case("s"), "grid": {EA: [1e8 + k for k in range(230)]}}
    ).json()
    with database.write() as session:
        values: dict[str, Any] = {"state": "succeeded", "summary": json.dumps(SUMMARY)}
        if kept:  # a table that reads the summary would find nothing
            values |= {"figures": figures_text(SUMMARY), "summary": "{}"}
        session.query(Run).update(values)
    address = f"/api/v1/studies/{study['id']}/table"
    table = client.get(address).json()
    assert len(table["rows"]) == 230
    row = dict(zip(table["columns"], table["rows"][229], strict=True))
    assert row["index"] == 229
    assert row[EA] == 1e8 + 229
    assert row["frequency_domain.vessel_std.lf.surge"] == 4.0
    assert row["max(time_domain.lines.bow-port.tension_max)"] == 3e6
    lines = client.get(address, params={"format": "csv"}).text.splitlines()
    assert len(lines) == 231
    assert lines[0].split(",") == table["columns"]
    assert [int(line.split(",")[0]) for line in lines[1:]] == list(range(230))


def test_a_worker_keeps_them(client: TestClient, work: Any, database: Database) -> None:
    client.post("/api/v1/studies", json={"case": a_case("s"), "grid": {EA: [1e8]}})
    work()
    with database.read() as session:
        run = session.query(Run).one()
        assert run.figures == figures_text(json.loads(run.summary or ""))


# -- very many faults


def faulty(keys: int) -> str:
    return "slowdrift: 1\n" + "\n".join(f"key{number}: 1" for number in range(keys))


@pytest.mark.parametrize("keys", [MOST_FAULTS + 500, 20_000])
def test_faults_are_told_up_to_a_number(keys: int) -> None:
    for read in (read_case, read_apart):
        with pytest.raises(CaseError) as told:
            read(faulty(keys)).sound()
        errors = told.value.errors
        assert len(errors) == MOST_FAULTS + 1
        assert f"these are the first {MOST_FAULTS}" in errors[0].message
    with pytest.raises(CaseError, match="these are the first"):
        read_case_data({f"key{number}": 1 for number in range(keys)}).sound()


def test_a_large_case_without_fault_is_read_in_a_child() -> None:
    import yaml

    text = yaml.safe_dump(a_case("large")) + "#" * SMALL_TEXT
    assert read_apart(text).sound() == read_case(text).sound()
    wrong = text.replace("name: large", "name: large\nstrange: 1\nstrange: 2")
    with pytest.raises(CaseError) as here:
        read_case(wrong).sound()
    with pytest.raises(CaseError) as there:
        read_apart(wrong).sound()
    assert there.value.errors == here.value.errors
