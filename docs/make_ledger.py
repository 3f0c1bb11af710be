"""Make docs/validation-ledger.md of docs/data/ledger.yaml and of what test runs said.

    pytest --junitxml=quick.xml -m 'not slow'; pytest --junitxml=slow.xml -m slow
    python docs/make_ledger.py quick.xml slow.xml

A row's status is that of its test in these runs: passed, FAILED, skipped, or not run. A test may record what it found:
`record_property("result", "52.1 N, measured 50.1 N")`. Without any run the results of docs/data/ledger-results.csv stand.
"""

from __future__ import annotations

import argparse
import csv
from collections import Counter
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml

DOCS = Path(__file__).parent
TABLE, RESULTS, PAGE = DOCS / "data/ledger.yaml", DOCS / "data/ledger-results.csv", DOCS / "validation-ledger.md"
HEAD = """# Validation ledger

One row per claim: what is claimed, what it is held against, what is accepted, what came out, and the test that asks.
Made by `docs/make_ledger.py` from `docs/data/ledger.yaml` and the results of test runs; do not edit. Each test named here
exists (`tests/docs/test_ledger.py`). What falls short is listed like the rest, marked *known*.

{summary}

"""


def rows() -> list[dict[str, Any]]:
    """All rows with their group and the words of their reference."""
    table = yaml.safe_load(TABLE.read_text(encoding="utf-8"))
    return [
        {
            **row,
            "group": group,
            **{f"reference_{key}": value for key, value in table["references"][row["reference"]].items()},
        }
        for group, items in table["groups"].items()
        for row in items
    ]


def outcomes(reports: list[Path]) -> dict[str, dict[str, str]]:
    """By test (file::function): the status over its cases, and what they recorded."""
    found: dict[str, list[tuple[str, str]]] = {}
    for report in reports:
        for case in ElementTree.parse(report).getroot().iter("testcase"):
            name = f"{case.get('classname', '').replace('.', '/')}.py::{case.get('name', '').split('[')[0]}"
            said = [one.get("value", "") for one in case.iter("property") if one.get("name") == "result"]
            bad, left = (
                case.find("failure") is not None or case.find("error") is not None,
                case.find("skipped") is not None,
            )
            found.setdefault(name, []).append(("FAILED" if bad else "skipped" if left else "passed", "; ".join(said)))
    return {name: _together(cases) for name, cases in found.items()}


def _together(cases: list[tuple[str, str]]) -> dict[str, str]:
    count = Counter(status for status, _ in cases)
    status = next(one for one in ("FAILED", "passed", "skipped") if count[one])
    said = "; ".join(dict.fromkeys(text for _, text in cases if text))
    return {"status": status, "result": said or f"{count['passed']} of {len(cases)} cases"}


def page(results: dict[str, dict[str, str]]) -> str:
    """The page's text."""
    every = rows()
    count = Counter(results.get(row["test"], {}).get("status", "not run") for row in every)
    known = sum("known" in row for row in every)
    said = ", ".join(f"{number} {status}" for status, number in sorted(count.items()))
    text = [HEAD.format(summary=f"{len(every)} claims: {said}; {known} with a known shortfall.")]
    for group in dict.fromkeys(row["group"] for row in every):
        text.append(
            f"## {group}\n\n| id | claim | reference (licence) | accepted | result | status | test |\n"
            "|---|---|---|---|---|---|---|\n"
        )
        text += [_line(row, results.get(row["test"], {})) for row in every if row["group"] == group]
        text.append("\n")
    return "".join(text).rstrip() + "\n"


def _line(row: dict[str, Any], found: dict[str, str]) -> str:
    claim = row["claim"]
    links = [f"[plot]({row['plot']})" if "plot" in row else "", f"[page]({row['page']})" if "page" in row else ""]
    claim += "".join(f" ({one})" for one in links if one)
    status = found.get("status", "not run") + (f"; *known*: {row['known']}" if "known" in row else "")
    file, name = row["test"].split("::")
    cells = [row["id"], claim, f"{row['reference_what']} ({row['reference_licence']})", row["acceptance"],
             found.get("result", ""), status, f"[{name}](../{file})"]  # fmt: skip
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |\n"


def read_results() -> dict[str, dict[str, str]]:
    """What the last runs said."""
    if not RESULTS.exists():
        return {}
    with RESULTS.open(newline="", encoding="utf-8") as file:
        return {row["test"]: {"status": row["status"], "result": row["result"]} for row in csv.DictReader(file)}


def write_results(results: dict[str, dict[str, str]]) -> None:
    wanted = {row["test"] for row in rows()}
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, ("test", "status", "result"), lineterminator="\n")
        table.writeheader()
        table.writerows({"test": name, **results[name]} for name in sorted(wanted & set(results)))


def main() -> None:
    words = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    words.add_argument("reports", nargs="*", type=Path, help="JUnit files of test runs, the last counts most")
    results = {**read_results(), **outcomes(words.parse_args().reports)}
    write_results(results)
    PAGE.write_text(page(read_results()), encoding="utf-8")


if __name__ == "__main__":
    main()
