"""The grid of runs: filters in the address, tags, rerun, edit as new, compare."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Page, expect

from tests.browser import steps
from tests.browser.conftest import Watch

pytestmark = pytest.mark.browser


def made(page: Page, example: str, **more: object) -> str:
    """A run of an example, by REST from the page's own origin."""
    script = """async ([name, more]) => {
      const [text] = (await (await fetch('/api/v1/examples')).json()).filter((one) => one.name === name);
      const saved = await (await fetch('/api/v1/cases', {method: 'POST', body: text.yaml})).json();
      const head = {'content-type': 'application/json'};
      const asked = {method: 'POST', headers: head, body: JSON.stringify({case_id: saved.id})};
      const run = await (await fetch('/api/v1/runs', asked)).json();
      await fetch('/api/v1/runs/' + run.id, {method: 'PATCH', headers: head, body: JSON.stringify(more)});
      return run.id;
    }"""
    run_id: str = page.evaluate(script, [example, more])
    return run_id


def test_filters_are_the_services_and_live_in_the_address(wide: Watch) -> None:
    page = wide.page
    page.goto("/app/")
    made(page, "hanging-riser-case1", name="needle 7", tags=["odd"])
    made(page, "hanging-riser-case1")
    page.goto("/app/")
    page.get_by_label("Search names").fill("needle")
    expect(page.locator(".ag-center-cols-container .ag-row")).to_have_count(1)
    expect(page).to_have_url(re.compile("q=needle"))
    expect(page.locator(".sd-tag")).to_have_text("odd")
    page.goto("/app/?tag=odd&sort=created")
    expect(page.locator(".ag-center-cols-container .ag-row")).to_have_count(1)
    page.get_by_label("Tag", exact=True).fill("none such")
    expect(page.get_by_text("No run is like that")).to_be_visible()


def test_a_run_takes_a_name_and_tags_is_rerun_and_edited_as_new(wide: Watch) -> None:
    page = wide.page
    page.goto("/app/")
    run_id = made(page, "hanging-riser-case1", name="to be named")
    page.goto("/app/?q=to be named")
    row = page.locator(".ag-center-cols-container .ag-row")
    expect(row.locator(".sd-badge")).to_have_text("succeeded", timeout=steps.PATIENT)
    row.get_by_role("button", name=re.compile("^Tag")).click()
    expect(page.get_by_label("Name", exact=True)).to_have_value("to be named")
    page.get_by_label("Name", exact=True).fill("to be named, second")
    page.get_by_role("button", name="Save").click()
    expect(row.locator(".sd-run-link")).to_have_text("to be named, second")
    row.get_by_role("link", name=re.compile("Edit")).click()
    expect(page.locator("#case-text")).to_have_value(re.compile("Hanging riser"))
    assert f"run={run_id}" in page.url
    page.goto("/app/?q=to be named")
    row.get_by_role("button", name=re.compile("^Rerun")).click()
    page.wait_for_url(re.compile(r"/app/runs/\w+"))
    assert run_id not in page.url


def test_chosen_runs_are_compared(wide: Watch) -> None:
    page = wide.page
    page.goto("/app/")
    for number in (1, 2):
        made(page, "hanging-riser-case1", name=f"pair {number}")
    page.goto("/app/?q=pair")
    expect(page.locator(".sd-badge-succeeded")).to_have_count(2, timeout=steps.PATIENT)
    for box in page.locator(".ag-selection-checkbox input").all():
        box.check()
    page.get_by_role("button", name="Compare 2").click()
    page.wait_for_url(re.compile(r"/app/compare\?runs=\w+,\w+"))


def test_pages_are_turned_while_runs_come_in(wide: Watch) -> None:
    """The rows are asked for again in the very moment of the click: the page turns all the same."""
    page = wide.page
    page.goto("/app/")
    for number in range(26):
        made(page, "hanging-riser-case1", name=f"leaf {number}")
    page.goto("/app/?q=leaf")
    rows = page.locator(".ag-center-cols-container .ag-row")
    expect(rows).to_have_count(25)
    script = """(button) => {
      document.querySelector(button).click();
      for (const wait of [0, 5, 20, 40]) {
        setTimeout(() => window.dash_clientside.set_props('runs-refresh', { data: Date.now() + wait }), wait);
      }
    }"""
    page.evaluate(script, "#runs-older")
    expect(rows).to_have_count(1)
    page.evaluate(script, "#runs-newer")
    expect(rows).to_have_count(25)
    expect(page.locator("#runs-newer")).to_be_disabled()
