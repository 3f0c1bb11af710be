"""The whole way over the real service: a case from nothing, a fault, a run, its results, a link; a server lost and back."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.browser import steps
from tests.browser.conftest import ROOT, WIDE, Watch

pytestmark = [pytest.mark.browser, pytest.mark.slow]


def build(page: Page) -> None:
    """A chain from the seabed to a point at the surface in a regular wave, by the form alone."""
    steps.empty_case(page)
    steps.fill(page, "From nothing", "name")
    steps.fill(page, "95 m", "environment", "depth")
    page.get_by_role("button", name="Add a wave system").click()
    page.get_by_label("Kind of wave system 1").select_option("regular")
    steps.fill(page, "9.5 s", "environment", "seastates", 0, "period")
    steps.part(page, "Line types")
    page.get_by_role("button", name="Add a line type").click()
    steps.fill(page, "0.12 m", "line_types", "chain", "diameter")
    steps.part(page, "Lines")
    page.get_by_role("button", name="Add a line", exact=True).click()
    steps.fill(page, "190.5 m", "lines", "line 1", "segments", 0, "length")
    steps.part(page, "Analyses")
    page.get_by_label("Frequency domain", exact=True).check()
    page.get_by_label("Time domain", exact=True).check()
    steps.fill(page, "20.5 s", "analyses", "time_domain", "build_up")
    steps.fill(page, "95 s", "analyses", "time_domain", "duration")
    expect(page.locator(".sd-ready")).to_contain_text("“From nothing” is ready to run", timeout=steps.PATIENT)


def test_from_nothing_to_a_shared_result(real: Watch, chromium: Browser) -> None:
    page = real.page
    build(page)
    expect(page.locator("#preview-facts")).to_contain_text("line 1", timeout=steps.PATIENT)
    steps.part(page, "Lines")
    steps.fill(page, "-190 m", "lines", "line 1", "segments", 0, "length")
    expect(page.locator('[data-field="lines.line 1.segments.0.length"] .sd-field-wrong')).to_contain_text("> 0")
    steps.fill(page, "191.5 m", "lines", "line 1", "segments", 0, "length")
    expect(page.locator(".sd-ready")).to_be_visible()

    run_id = steps.start(page)
    steps.expect_done(page)
    expect(page.locator("#run-title")).to_have_text("From nothing")
    steps.open_tab(page, "Along lines")
    expect(page.get_by_role("heading", name=re.compile("domains side by side"))).to_be_visible(timeout=steps.PATIENT)
    page.goto(f"/app/compare?runs={run_id}")
    expect(page.locator("#compare-panel .js-plotly-plot").first).to_be_visible(timeout=steps.PATIENT)

    page.goto(f"/app/runs/{run_id}?tab=lines")
    expect(page.get_by_role("heading", name=re.compile("domains side by side"))).to_be_visible(timeout=steps.PATIENT)
    page.get_by_role("button", name="Share").click()
    page.get_by_role("button", name="Make a link").click()
    link = page.get_by_label("The link. It is shown this once.").input_value()
    stranger = Watch(real.origin, chromium.new_context(viewport=WIDE, base_url=real.origin).new_page())
    stranger.page.goto(link)
    expect(stranger.page.get_by_role("heading", name=re.compile("domains side by side"))).to_be_visible(
        timeout=steps.PATIENT
    )
    expect(stranger.page.get_by_role("button", name="Share")).to_be_hidden()
    asked: list[str] = []
    stranger.page.on("request", lambda request: asked.append(request.url))
    stranger.page.reload()
    expect(stranger.page.locator("#run-title")).to_have_text("From nothing", timeout=steps.PATIENT)
    assert not [url for url in asked if "/api/v1/runs" in url]
    assert not stranger.faults
    stranger.page.context.close()


def test_a_running_one_is_cancelled(real: Watch) -> None:
    page = real.page
    build(page)
    steps.part(page, "Analyses")
    steps.fill(page, "90000 s", "analyses", "time_domain", "duration")
    expect(page.locator(".sd-ready")).to_be_visible()
    steps.start(page)
    expect(page.locator("#run-badge")).to_have_text("running", timeout=steps.PATIENT)
    page.get_by_role("button", name="Cancel run").click()
    expect(page.locator("#run-badge")).to_have_text("cancelled", timeout=steps.PATIENT)


@pytest.fixture
def own(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen[str]]]]:
    """A service of this test's own on a port that stays the same when it starts again."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    started: list[subprocess.Popen[str]] = []
    origin = f"http://127.0.0.1:{port}"
    start(started, tmp_path, port)
    yield origin, started
    stop(started)


def start(started: list[subprocess.Popen[str]], data: Path, port: int) -> None:
    command = [
        sys.executable,
        "-m",
        "cli.main",
        "serve",
        "--port",
        str(port),
        "--data-dir",
        str(data),
        "--workers",
        "0",
    ]
    path = os.pathsep.join(part for part in (str(ROOT), os.environ.get("PYTHONPATH")) if part)
    started.append(
        subprocess.Popen(command, cwd=data, env={**os.environ, "PYTHONPATH": path}, stdout=subprocess.PIPE, text=True)
    )
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        try:
            if httpx.get(f"http://127.0.0.1:{port}/healthz").status_code == 200:
                return
        except httpx.HTTPError:
            time.sleep(0.2)
    pytest.fail("the service did not start")


def stop(started: list[subprocess.Popen[str]]) -> None:
    process = started[-1]
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        process.wait(timeout=30)


def test_the_draft_outlives_the_server(
    own: tuple[str, list[subprocess.Popen[str]]], chromium: Browser, tmp_path: Path
) -> None:
    origin, started = own
    page = chromium.new_context(viewport=WIDE, base_url=origin).new_page()
    steps.empty_case(page)
    steps.fill(page, "96 m", "environment", "depth")
    stop(started)
    steps.field(page, "environment", "depth").fill("97 m")  # the form, while nobody listens
    expect(page.locator("#sd-away")).to_be_visible(timeout=steps.PATIENT)
    text = page.locator("#case-text").input_value()
    assert "96 m" in text
    start(started, tmp_path, int(origin.rsplit(":", 1)[1]))
    expect(page.locator("#sd-away")).to_be_hidden(timeout=steps.PATIENT)
    expect(page.locator("#case-text")).to_have_value(re.compile("depth: 97 m"), timeout=steps.PATIENT)
    stop(started)
    steps.write(page, text.replace("96 m", "98 m"))  # the text, and the page left meanwhile
    start(started, tmp_path, int(origin.rsplit(":", 1)[1]))
    page.reload()
    expect(page.locator("#case-text")).to_have_value(re.compile("depth: 98 m"), timeout=steps.PATIENT)
    expect(steps.field(page, "environment", "depth")).to_have_value("98 m", timeout=steps.PATIENT)
    page.context.close()
