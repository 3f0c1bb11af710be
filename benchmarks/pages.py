"""How quickly the pages answer, in a real headless Chromium over the real service: `python benchmarks/pages.py [--url URL]`.

Measured from a cold cache (a fresh browser profile each time): the list usable, the editor usable, a run page with twelve
plots (six RAOs, amplitude and phase each); then zooming in a history of 150 000 samples, and the editor's preview after
an edit. Medians of `--times`.
With `--many` also the heap of the list's page after each ten of a hundred reloads of its rows: it stays level.
Without --url a service of its own is started in a temporary folder. `--many N` puts N runs into the list first.
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
from playwright.sync_api import Browser, Page, sync_playwright

ROOT = Path(__file__).resolve().parents[1]
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
LIMITS = {
    "list, cold": 2.0, "list, warm": 2.0, "editor, cold": 2.0, "run page of 12 plots, cold": 2.5,
    "zoom in 150 000 samples": 0.2, "preview after an edit": 1.0, "next page of the list": 1.0,
}  # fmt: skip
DRAWN = """n => document.querySelectorAll('.js-plotly-plot .main-svg').length >= n
  && !document.querySelector('.dash-graph--pending')"""
LONG = """slowdrift: 1
name: A long record
environment: {depth: 100 m, water: {density: 1000, gravity: 9.807}}
line_types: {riser: {diameter: 0.396 m, mass: 165 kg/m, EA: 500 MN}}
lines:
  riser:
    segments: [{type: riser, length: 170 m, elements: 6}]
    end_a: {pinned: [0, 0, -55]}
    end_b: {pinned: [100, 0, -5], motion: {surge: {amplitude: 1 m, period: 27 s}}}
analyses:
  statics: {}
  time_domain: {step: 0.1 s, build_up: 10 s, duration: 15000 s, output_step: 0.1 s}
"""


def run(origin: str, text: str) -> str:
    """The id of a finished run of a case."""
    made = httpx.post(f"{origin}/api/v1/runs", json={"yaml": text}, timeout=60).raise_for_status().json()
    while (state := httpx.get(f"{origin}/api/v1/runs/{made['id']}", timeout=60).json())["state"] not in (
        "succeeded",
        "failed",
    ):
        time.sleep(0.5)
    assert state["state"] == "succeeded", state.get("reason")
    return str(made["id"])


def timed(act: Callable[[], Any]) -> float:
    start = time.perf_counter()
    act()
    return time.perf_counter() - start


class Bench:
    def __init__(self, browser: Browser, origin: str, times: int) -> None:
        self.browser, self.origin, self.times = browser, origin, times
        self.found: dict[str, list[float]] = {}

    def page(self) -> Page:
        context = self.browser.new_context(viewport={"width": 1440, "height": 900}, base_url=self.origin)
        context.set_default_timeout(60_000)
        return context.new_page()

    def note(self, name: str, seconds: float) -> None:
        self.found.setdefault(name, []).append(seconds)

    def load(self, name: str, path: str, ready: Callable[[Page], Any], warm: str | None = None) -> None:
        for _ in range(self.times):
            page = self.page()
            self.note(name, timed(lambda page=page: (page.goto(path, wait_until="commit"), ready(page))))
            if warm:
                self.note(warm, timed(lambda page=page: (page.goto(path, wait_until="commit"), ready(page))))
            page.context.close()

    def zoom(self, run_id: str) -> None:
        """From the end of a drag to the finer curve, drawn: the picture's own events say when."""
        page = self.page()
        page.goto(f"/app/runs/{run_id}?tab=time")
        page.wait_for_function(DRAWN, arg=1)
        script = """async ([from, to]) => {
          const plot = document.querySelector('.js-plotly-plot');
          const start = performance.now();
          const drawn = new Promise((done) => {
            const look = () => (plot.data[0].x[0] >= from - 1 && plot.data[0].x.at(-1) <= to + 1
              ? requestAnimationFrame(() => done(performance.now())) : requestAnimationFrame(look));
            look();
          });
          await window.Plotly.relayout(plot, {'xaxis.range[0]': from, 'xaxis.range[1]': to});
          return ((await drawn) - start) / 1000;
        }"""
        for index in range(self.times + 2):
            self.note("zoom in 150 000 samples", page.evaluate(script, [1000 + 700 * index, 3000 + 500 * index]))
        page.context.close()

    def preview(self) -> None:
        """From the last key to the new equilibrium on the screen."""
        page = self.page()
        page.goto("/app/new")
        text = next(e["yaml"] for e in httpx.get(f"{self.origin}/api/v1/examples").json() if e["name"] == "fpso-2000m")
        page.locator("#case-text").fill(text)
        page.wait_for_function(DRAWN, arg=1)
        changed = "words => document.querySelector('#preview-facts').innerText !== words"
        for index in range(self.times + 1):
            before = page.locator("#preview-facts").inner_text()
            field = page.locator('[data-field="environment.depth"] input')
            seconds = timed(
                lambda f=field, i=index, b=before: (
                    f.fill(f"{1990 - 10 * i} m"),
                    page.wait_for_function(changed, arg=b),
                )
            )
            if index:
                self.note("preview after an edit", seconds)
        page.context.close()

    def pages_of_the_list(self) -> None:
        page = self.page()
        page.goto("/app/")
        page.wait_for_selector(".ag-row")
        first = (
            "id => { const row = document.querySelector('.ag-row'); return row && row.getAttribute('row-id') !== id; }"
        )
        for _ in range(self.times):
            if page.locator("#runs-older").is_disabled():
                break
            now = page.locator(".ag-row").first.get_attribute("row-id")
            self.note(
                "next page of the list",
                timed(lambda n=now: (page.locator("#runs-older").click(), page.wait_for_function(first, arg=n))),
            )
        page.context.close()

    def heap(self) -> list[float]:
        """Megabytes in use after each ten of a hundred reloads of the list's rows."""
        page = self.page()
        page.goto("/app/")
        page.wait_for_selector(".ag-row")
        script = """async () => {
          for (let i = 0; i < 10; i += 1) {
            window.dash_clientside.set_props('runs-refresh', { data: Date.now() });
            await new Promise((done) => setTimeout(done, 150));
          }
        }"""
        inspector = page.context.new_cdp_session(page)
        inspector.send("Performance.enable")
        found = []
        for _ in range(10):
            page.evaluate(script)
            inspector.send("HeapProfiler.collectGarbage")
            metrics = {one["name"]: one["value"] for one in inspector.send("Performance.getMetrics")["metrics"]}
            found.append(round(metrics["JSHeapUsedSize"] / 1e6, 1))
        page.context.close()
        return found


def measure(origin: str, times: int, many: int) -> dict[str, Any]:
    examples = {e["name"]: e["yaml"] for e in httpx.get(f"{origin}/api/v1/examples").json()}
    vessel, long = run(origin, examples["fpso-2000m-design"]), run(origin, LONG)
    if many:
        body = {"name": "many", "yaml": examples["fpso-2000m-design"], "analyses": ["statics"],
                "overrides": [{"/environment/seastates/0/hs": 5 + i / many} for i in range(many)]}  # fmt: skip
        study = httpx.post(f"{origin}/api/v1/studies", json=body, timeout=120).raise_for_status().json()
        httpx.post(f"{origin}/api/v1/studies/{study['id']}/cancel", timeout=120)
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=shutil.which("chromium") or "chromium", args=FLAGS)
        bench = Bench(browser, origin, times)
        bench.load("list, cold", "/app/", lambda page: page.wait_for_selector(".ag-row .sd-run-link"), "list, warm")
        bench.load("editor, cold", "/app/new", lambda page: page.wait_for_selector("#f-environment-depth"))
        bench.load(
            "run page of 12 plots, cold", f"/app/runs/{vessel}?tab=raos",
            lambda page: page.wait_for_function(DRAWN, arg=6),
        )  # fmt: skip
        bench.zoom(long)
        bench.preview()
        bench.pages_of_the_list()
        if many:
            print("heap of the list's page [MB]:", bench.heap())
        browser.close()
    return {name: {"median_s": round(statistics.median(all_), 3), "worst_s": round(max(all_), 3), "limit_s": LIMITS[name]}
            for name, all_ in bench.found.items()}  # fmt: skip


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--url", help="origin of a running service")
    parser.add_argument("--times", type=int, default=3)
    parser.add_argument("--many", type=int, default=0, help="runs in the list")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        process = None
        origin = (options.url or "").rstrip("/")
        if not origin:
            command = [sys.executable, "-m", "cli.main", "serve", "--port", "0", "--data-dir", folder]
            process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
            found = re.search(r"http://[\d.:]+", process.stdout.readline() if process.stdout else "")
            assert found, "slowdrift serve did not say where it is"
            origin = found[0]
        try:
            answer = measure(origin, options.times, options.many)
        finally:
            if process:
                process.send_signal(signal.SIGTERM)
                process.wait(timeout=30)
    print(json.dumps(answer, indent=1))
    return int(any(item["median_s"] > item["limit_s"] for item in answer.values()))


if __name__ == "__main__":
    raise SystemExit(main())
