"""axe-core on every page, in both schemes and both widths: no serious and no critical fault."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser import steps
from tests.browser.conftest import NARROW, WIDE, Watch, _page
from tests.browser.test_runs import made

axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe-playwright-python is not installed")
pytestmark = [pytest.mark.browser, pytest.mark.slow]
TABS = ("overview", "spectra", "time", "raos", "lines", "shape", "motion", "modes", "case")


@pytest.fixture(params=[WIDE, NARROW], ids=["wide", "narrow"])
def watched(request: pytest.FixtureRequest, chromium: Browser, fake: str) -> Iterator[Watch]:
    yield from _page(chromium, fake, request.param)


@pytest.fixture(params=[WIDE, NARROW], ids=["wide", "narrow"])
def served(request: pytest.FixtureRequest, chromium: Browser, service: str) -> Iterator[Watch]:
    yield from _page(chromium, service, request.param)


def faults(page: Page, where: str) -> list[str]:
    """What axe calls serious or critical, in both schemes, with the elements."""
    found = []
    for scheme in ("light", "dark"):
        page.evaluate("scheme => document.documentElement.setAttribute('data-mantine-color-scheme', scheme)", scheme)
        page.wait_for_timeout(250)
        for item in axe.Axe().run(page, options={"resultTypes": ["violations"]}).response["violations"]:
            if item["impact"] in ("serious", "critical"):
                nodes = [f"{node['html'][:160]} | {node['failureSummary'][:220]}" for node in item["nodes"][:3]]
                found.append(f"{where}, {scheme}: {item['id']}: {nodes}")
    return found


def test_lists_and_editor(watched: Watch) -> None:
    page = watched.page
    page.goto("/app/")
    made(page, "fpso-2000m", tags=["basis"])
    page.goto("/app/")
    expect(page.locator(".ag-row").first).to_be_visible()
    found = faults(page, "runs")
    text = steps.choose_example(page, "fpso-2000m")
    narrow = page.locator("#bench-view").is_visible()
    for part in ("Sea", "Lines") if narrow else ("Sea", "Vessel", "Line types", "Lines", "Attachments", "Analyses"):
        steps.part(page, part)
        found += faults(page, f"editor, {part}")
    steps.write(page, text.replace("3300 m", "-5 m", 1)) if not narrow else None
    if narrow:
        page.locator("#bench-view").get_by_text("YAML").click()
        steps.write(page, text.replace("3300 m", "-5 m", 1))
    expect(page.locator(".sd-problem").first).to_be_visible()
    found += faults(page, "editor with a fault")
    for path in ("compare", "studies", "new-study", "data", "hull", "account", "sign-in"):
        page.goto(f"/app/{path}")
        expect(page.get_by_role("heading", level=1)).to_be_visible()
        found += faults(page, path)
    assert not found, "\n".join(found)


def test_results(watched: Watch) -> None:
    page = watched.page
    page.goto("/app/")
    run_id = made(page, "fpso-2000m")
    page.goto(f"/app/runs/{run_id}")
    steps.expect_done(page)
    found = []
    wide = page.evaluate("window.innerWidth") > NARROW["width"]
    for tab in (
        TABS if wide else ("overview", "time", "lines", "case")
    ):  # what differs on a phone are tables and controls
        page.goto(f"/app/runs/{run_id}?tab={tab}")
        expect(page.locator("#run-panel > div:not(.mantine-Skeleton-root)").first).to_be_visible(timeout=steps.PATIENT)
        found += faults(page, tab)
    assert not found, "\n".join(found)


def test_shared_study_data_and_teams(served: Watch) -> None:
    """What only the real service has."""
    page, found = served.page, []
    page.goto("/app/", timeout=120_000)  # the first page of a service that has just been started
    made = page.evaluate(
        """async () => {
          const ask = async (path, body) => (await fetch('/api/v1' + path, body && {method: 'POST',
            headers: {'content-type': 'application/json'}, body: JSON.stringify(body)})).json();
          const text = (await ask('/examples')).find((one) => one.name === 'hanging-riser-case1').yaml;
          const analyses = ['statics', 'frequency_domain'];
          let run = await ask('/runs', {yaml: text, analyses});
          const grid = {'/line_types/riser/EA': [4e8, 5e8, 6e8]};
          let study = await ask('/studies', {name: 'Stiffness', yaml: text, analyses, grid});
          const busy = () => ask('/runs?state=queued,running&limit=1&total=true');
          while ((await busy()).total) await new Promise((done) => setTimeout(done, 300));
          const share = await ask('/shares', {run_ids: [run.id]});
          const sets = await ask('/data-sets');
          return [`shared/${share.token}`, `studies/${study.id}`, `data/${sets.items[0].id}`, 'teams'];
        }"""
    )
    for path in made:
        page.goto(f"/app/{path}")
        expect(page.get_by_role("heading", level=1)).to_be_visible(timeout=steps.PATIENT)
        expect(page.locator(".mantine-Skeleton-root, .dash-graph--pending")).to_have_count(0, timeout=steps.PATIENT)
        page.wait_for_timeout(1000)
        found += faults(page, path.partition("/")[0])
    assert not found, "\n".join(found)
