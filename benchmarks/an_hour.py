"""An hour's use of the pages with a thousand runs in the list: `python benchmarks/an_hour.py [--minutes 60] [--runs 1000]`.

One tab of a real headless Chromium that is never reloaded, over the real service with a worker at work. A round: the
list, older and newer pages, a search; a run, all its tabs, a zoom in its history; the comparison of its domains; the
editor with an edit; back to the list. Between rounds a new run is started, so that the list moves while one looks. At
each round's end, on the list: heap after a garbage collection, DOM nodes, listeners, and the seconds of each action.
Exit status 1 where the last quarter's heap is over 1.05 times the third's, or an action's median of the last quarter is
over 1.5 times the first's.
"""

from __future__ import annotations

import argparse
import json
import re
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
from benchmarks.pages import DRAWN, FLAGS, LONG, run, timed  # noqa: E402

TABS = ("Overview", "Spectra", "RAOs", "Along lines", "Static shape", "Motion", "Modes", "Case and provenance")
SETTLED = """() => !document.querySelector('.dash-graph--pending, .mantine-Skeleton-root, ._dash-loading')
  && document.querySelector('h1') !== null"""
FIRST_ROW = "id => { const row = document.querySelector('.ag-row'); return row && row.getAttribute('row-id') !== id; }"


class Tab:
    """The one page, and what its actions took."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.seconds: dict[str, list[float]] = {}
        self.memory: list[dict[str, float]] = []
        self._inspector = page.context.new_cdp_session(page)
        self._inspector.send("Performance.enable")

    def act(self, name: str, do: Callable[[], Any]) -> None:
        self.seconds.setdefault(name, []).append(timed(do))
        self.page.wait_for_timeout(400)  # somebody looks

    def go(self, link: str, ready: str) -> None:
        self.page.locator("header nav").get_by_role("link", name=link, exact=True).click()
        self.there(ready)

    def there(self, selector: str) -> None:
        """Not by `wait_for_selector`: the handle that it returns keeps the element, and all about it, in memory."""
        self.page.wait_for_function("selector => document.querySelector(selector) !== null", arg=selector)

    def open(self, name: str) -> None:
        self.page.get_by_role("tab", name=name, exact=True).click()
        self.page.wait_for_timeout(100)
        self.page.wait_for_function(SETTLED)

    def follow(self, href: str) -> None:
        """As a link inside the pages does: nothing is loaded again."""
        self.page.evaluate(
            "href => { history.pushState({}, '', href); window.dispatchEvent(new CustomEvent('_dashprivate_pushstate')); }",
            href,
        )
        self.page.wait_for_function(DRAWN, arg=2)

    def leaf(self) -> None:
        """To the older page of the list and back."""
        for button in ("#runs-older", "#runs-newer"):
            now = self.page.locator(".ag-row").first.get_attribute("row-id")
            self.page.locator(button).click()
            self.page.wait_for_function(FIRST_ROW, arg=now)

    def search(self, words: str) -> None:
        """Exactly one run is called that."""
        self.page.locator("#runs-q").fill(words)
        self.page.wait_for_function("() => document.querySelectorAll('.ag-center-cols-container .ag-row').length === 1")

    def remember(self) -> None:
        for _ in range(2):
            self._inspector.send("HeapProfiler.collectGarbage")
        found = {one["name"]: one["value"] for one in self._inspector.send("Performance.getMetrics")["metrics"]}
        self.memory.append({"heap_mb": round(found["JSHeapUsedSize"] / 1e6, 2), "nodes": found["Nodes"],
                            "listeners": found["JSEventListeners"]})  # fmt: skip


def a_round(tab: Tab, pair: list[str]) -> None:
    page = tab.page
    tab.act("list", lambda: tab.go("Runs", ".ag-row .sd-run-link"))
    tab.act("two pages of the list", tab.leaf)
    tab.act("search", lambda: tab.search("The one to look at"))
    tab.act("run", lambda: (page.locator(".sd-run-link").click(), tab.there("#run-panel .sd-cards")))
    for name in TABS:
        tab.act(f"tab {name}", lambda name=name: tab.open(name))
    tab.act("compare two runs", lambda: tab.follow(f"/app/compare?runs={','.join(pair)}"))
    tab.act("editor", lambda: tab.go("New run", "#case-form"))
    tab.act("list, then search", lambda: (tab.go("Runs", ".ag-row .sd-run-link"), tab.search("A long record")))
    page.locator(".sd-run-link").click()
    page.get_by_role("tab", name=re.compile("^Time")).click()
    page.wait_for_function(DRAWN, arg=1)
    page.wait_for_timeout(1000)
    tab.act("zoom in 150 000 samples", lambda: page.evaluate(
        """async () => {
          const plot = document.querySelector('.js-plotly-plot');
          const from = 1000 + 9000 * Math.random();
          const drawn = new Promise((done, failed) => {
            setTimeout(() => failed(new Error('no finer curve within 30 s')), 30000);
            const look = () => (plot.data[0].x[0] >= from - 1 && plot.data[0].x.at(-1) <= from + 2001
              ? requestAnimationFrame(done) : requestAnimationFrame(look));
            look();
          });
          await window.Plotly.relayout(plot, {'xaxis.range[0]': from, 'xaxis.range[1]': from + 2000});
          await drawn;
        }"""))  # fmt: skip
    tab.go("Runs", ".ag-row .sd-run-link")
    page.wait_for_timeout(1000)


def prepare(origin: str, runs: int) -> tuple[str, list[str]]:
    """A thousand runs in the list; the text of the case that is started between the rounds, and two runs to compare."""
    examples = {e["name"]: e["yaml"] for e in httpx.get(f"{origin}/api/v1/examples", timeout=60).json()}
    looked_at = run(origin, examples["fpso-2000m-design"])
    httpx.patch(f"{origin}/api/v1/runs/{looked_at}", json={"name": "The one to look at"}).raise_for_status()
    other = run(origin, examples["fpso-2000m-design"].replace("name: ", "name: other ", 1))
    run(origin, LONG)
    body = {"name": "many", "yaml": examples["fpso-2000m-design"], "analyses": ["statics"],
            "overrides": [{"/environment/seastates/0/hs": 5 + i / runs} for i in range(runs)]}  # fmt: skip
    study = httpx.post(f"{origin}/api/v1/studies", json=body, timeout=120).raise_for_status().json()
    httpx.post(f"{origin}/api/v1/studies/{study['id']}/cancel", timeout=120)
    return str(examples["hanging-riser-case1"]), [looked_at, other]


def use(origin: str, minutes: float, runs: int) -> Tab:
    small, pair = prepare(origin, runs)
    until = time.monotonic() + 60 * minutes
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium") or "chromium", args=FLAGS)
        context = browser.new_context(viewport={"width": 1440, "height": 900}, base_url=origin)
        context.set_default_timeout(60_000)
        tab = Tab(context.new_page())
        tab.page.goto("/app/")
        while time.monotonic() < until:
            body = {"yaml": small, "analyses": ["statics", "frequency_domain"]}
            httpx.post(f"{origin}/api/v1/runs", json=body, timeout=60).raise_for_status()
            a_round(tab, pair)
            tab.remember()
            print(json.dumps({"round": len(tab.memory), **tab.memory[-1]}), flush=True)
        browser.close()
    return tab


def judge(tab: Tab) -> dict[str, Any]:
    quarter = max(1, len(tab.memory) // 4)
    heap = [one["heap_mb"] for one in tab.memory]
    middle, last = statistics.median(heap[2 * quarter : 3 * quarter] or heap), statistics.median(heap[-quarter:])
    actions = {
        name: {"first_quarter_s": round(statistics.median(all_[:quarter]), 3),
               "last_quarter_s": round(statistics.median(all_[-quarter:]), 3), "worst_s": round(max(all_), 3)}
        for name, all_ in tab.seconds.items()
    }  # fmt: skip
    slower = [name for name, one in actions.items() if one["last_quarter_s"] > 1.5 * one["first_quarter_s"] + 0.05]
    return {"rounds": len(heap), "heap_mb": {"first": heap[0], "third_quarter": middle, "last_quarter": last},
            "actions": actions, "slower": slower, "level": last <= 1.05 * middle}  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--runs", type=int, default=1000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        command = [sys.executable, "-m", "cli.main", "serve", "--port", "0", "--data-dir", folder]
        process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
        found = re.search(r"http://[\d.:]+", process.stdout.readline() if process.stdout else "")
        assert found, "slowdrift serve did not say where it is"
        try:
            answer = judge(use(found[0], options.minutes, options.runs))
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=30)
    print(json.dumps(answer, indent=1))
    return int(bool(answer["slower"]) or not answer["level"])


if __name__ == "__main__":
    raise SystemExit(main())
