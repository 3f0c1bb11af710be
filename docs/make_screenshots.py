"""Pictures of every page for the docs: `python docs/make_screenshots.py [--url URL] [--only NAME]`.

Each page at 1440 and 390 pixels, light and dark, as WebP into docs/screens; the service of --url (or one of its own) is
given the runs that the pages show.
"""

from __future__ import annotations

import argparse
import io
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import httpx
from PIL import Image
from playwright.sync_api import Browser, Page, sync_playwright
from playwright.sync_api import Error as PlaywrightError

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
from benchmarks.pages import FLAGS, run  # noqa: E402

OUT = ROOT / "docs" / "screens"
SIZES = {1440: 900, 390: 844}
QUALITY = 68
TABS = ("overview", "spectra", "time", "raos", "lines", "shape", "motion", "modes", "case")
SHORT = "  time_domain: {step: 0.1 s, build_up: 60 s, duration: 600 s, seeds: 2, output_step: 0.4 s}\n"
STUDY = {"/environment/seastates/0/hs": [6, 9, 12, 15]}


def prepare(origin: str) -> dict[str, str]:
    """Runs and a study to look at; the addresses of the pages by name."""
    examples = {e["name"]: e["yaml"] for e in httpx.get(f"{origin}/api/v1/examples").json()}
    design = examples["fpso-2000m-design"].rstrip() + "\n" + SHORT
    first, second = run(origin, design), run(origin, examples["fpso-2000m-design"])
    run(origin, examples["hanging-riser-case1"])
    httpx.patch(
        f"{origin}/api/v1/runs/{first}",
        json={"name": "FPSO, time and frequency domain", "tags": ["basis"], "pinned": True},
    )
    made = httpx.post(f"{origin}/api/v1/studies", timeout=60, json={
        "name": "Sea states", "yaml": examples["fpso-2000m-design"], "analyses": ["statics", "frequency_domain"], "grid": STUDY,
    }).json()  # fmt: skip
    shared = httpx.post(f"{origin}/api/v1/shares", json={"run_ids": [first], "view": {"tab": "spectra"}}).json()
    sets = httpx.get(f"{origin}/api/v1/data-sets").json()["items"]
    pages = {
        "runs": "/app/", "new": f"/app/new?run={second}", "compare": f"/app/compare?runs={first},{second}",
        "studies": "/app/studies",
        "study": f"/app/studies/{made['id']}", "study-new": "/app/new-study", "data": "/app/data", "hull": "/app/hull",
        "account": "/app/account", "sign-in": "/app/sign-in", "shared": f"/app/shared/{shared['token']}",
    }  # fmt: skip
    if sets:
        pages["data-set"] = f"/app/data/{sets[0]['id']}"
    return pages | {f"run-{tab}": f"/app/runs/{first}?tab={tab}" for tab in TABS}


def settle(page: Page) -> None:
    """Until nothing is asked any more, or what streams has been given its time; then what is drawn is drawn."""
    page.wait_for_timeout(2500)
    try:
        page.wait_for_function(
            "() => !document.querySelector('.dash-graph--pending, .mantine-Skeleton-root, ._dash-loading')",
            timeout=45_000,
        )
    except PlaywrightError:
        print(f"  {page.url} had not settled")
    page.wait_for_timeout(1200)


def shoot(browser: Browser, origin: str, pages: dict[str, str]) -> int:
    """All of them; the bytes written."""
    written = 0
    OUT.mkdir(parents=True, exist_ok=True)
    for width, height in SIZES.items():
        context = browser.new_context(
            viewport={"width": width, "height": height}, base_url=origin, color_scheme="light"
        )
        page = context.new_page()
        for name, path in pages.items():
            page.emulate_media(color_scheme="light")
            page.goto(path)
            settle(page)
            for scheme in ("light", "dark"):
                page.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
                page.wait_for_timeout(900)
                image = Image.open(io.BytesIO(page.screenshot()))
                file = OUT / f"{name}-{width}-{scheme}.webp"
                image.save(file, "WEBP", quality=QUALITY, method=6)
                written += file.stat().st_size
        context.close()
    return written


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--url", help="origin of a running service")
    parser.add_argument("--only", help="only pages whose name contains this")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        process: Any = None
        origin = (options.url or "").rstrip("/")
        if not origin:
            command = [sys.executable, "-m", "cli.main", "serve", "--port", "0", "--data-dir", folder]
            process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
            found = re.search(r"http://[\d.:]+", process.stdout.readline())
            assert found, "slowdrift serve did not say where it is"
            origin = found[0]
        try:
            pages = {name: path for name, path in prepare(origin).items() if not options.only or options.only in name}
            with sync_playwright() as driver:
                browser = driver.chromium.launch(executable_path=shutil.which("chromium") or "chromium", args=FLAGS)
                written = shoot(browser, origin, pages)
                browser.close()
        finally:
            if process:
                process.send_signal(signal.SIGTERM)
                process.wait(timeout=30)
    print(f"{4 * len(pages)} pictures, {written / 1e6:.2f} MB")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
