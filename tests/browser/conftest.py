"""A real headless Chromium against the pages; every test also fails on console errors and foreign requests."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import uvicorn
from a2wsgi import WSGIMiddleware

from frontend.app import create_app
from tests.frontend.fake_api import create_fake

playwright_api = pytest.importorskip("playwright.sync_api")
Browser, BrowserContext, Page = playwright_api.Browser, playwright_api.BrowserContext, playwright_api.Page
playwright_api.expect.set_options(timeout=15_000)  # machines that do other things too

ROOT = Path(__file__).resolve().parents[2]
# WebGL in software: the 3D picture is drawn without a graphics card
FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]
WIDE, NARROW = {"width": 1440, "height": 900}, {"width": 390, "height": 844}


@dataclass
class Watch:
    """What a page did that it should not have."""

    origin: str
    page: Page
    faults: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.page.on(
            "console", lambda m: self.faults.append(m.text) if m.type == "error" and not self._said(m) else None
        )
        self.page.on("pageerror", lambda error: self.faults.append(str(error.stack or error)))
        self.page.on("request", self._request)

    @staticmethod
    def _said(message: object) -> bool:
        """The browser itself reports a refused check or preview: the page shows it at the field."""
        url = str(message.location.get("url", ""))  # type: ignore[attr-defined]
        text = message.text  # type: ignore[attr-defined]
        refused = "status of 422" in text and url.endswith(("/cases/check", "/preview"))
        return refused or (
            "status of 50" in text and url.endswith("/preview")
        )  # a worker that starts: the page asks again

    def _request(self, request: object) -> None:
        url: str = request.url  # type: ignore[attr-defined]
        if not url.startswith((self.origin, "data:", "blob:")):
            self.faults.append(f"request to another origin: {url}")


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    path = shutil.which("chromium") or shutil.which("chromium-browser")
    if not path:
        if os.environ.get("SLOWDRIFT_REQUIRE_SERVICES") == "1":
            pytest.fail("there is no chromium on this machine, and SLOWDRIFT_REQUIRE_SERVICES=1 asks for one")
        pytest.skip("there is no chromium on this machine")
    with playwright_api.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def fake() -> Iterator[str]:
    """The pages over the fake service, mounted as the real one mounts them; runs take two seconds."""
    app = create_fake(run_seconds=2.0)
    app.mount("/app", WSGIMiddleware(create_app(), workers=8))
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_level="warning", timeout_graceful_shutdown=1))
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    deadline = time.monotonic() + 30
    while not server.started and time.monotonic() < deadline:
        time.sleep(0.05)
    port = server.servers[0].sockets[0].getsockname()[1]
    yield f"http://127.0.0.1:{port}"
    server.should_exit = True
    thread.join(timeout=10)


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The real service: `slowdrift serve` with a database, a broker and a worker of its own."""
    data = tmp_path_factory.mktemp("service")
    path = os.pathsep.join(part for part in (str(ROOT), os.environ.get("PYTHONPATH")) if part)
    process = subprocess.Popen(
        [sys.executable, "-m", "cli.main", "serve", "--port", "0", "--data-dir", str(data)],
        cwd=data, env={**os.environ, "PYTHONPATH": path}, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        found = re.search(r"http://\S+?(?=/)", process.stdout.readline())
        assert found, "slowdrift serve did not say where it is"
        yield f"http://{found[0].removeprefix('http://')}"
    finally:
        process.send_signal(signal.SIGTERM)
        process.wait(timeout=30)


def _page(browser: Browser, origin: str, size: dict[str, int]) -> Iterator[Watch]:
    context: BrowserContext = browser.new_context(viewport=size, base_url=origin)
    context.set_default_timeout(30_000)
    watch = Watch(origin, context.new_page())
    yield watch
    context.close()
    assert not watch.faults


@pytest.fixture
def wide(chromium: Browser, fake: str) -> Iterator[Watch]:
    yield from _page(chromium, fake, WIDE)


@pytest.fixture
def narrow(chromium: Browser, fake: str) -> Iterator[Watch]:
    yield from _page(chromium, fake, NARROW)


@pytest.fixture
def real(chromium: Browser, service: str) -> Iterator[Watch]:
    yield from _page(chromium, service, WIDE)
