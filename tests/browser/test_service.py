"""The whole way through the pages, over the real service: its API, its worker, its solver."""

from __future__ import annotations

import httpx
import pytest
from playwright.sync_api import expect

from tests.browser import steps
from tests.browser.conftest import Watch

pytestmark = [pytest.mark.browser, pytest.mark.slow]


def test_a_riser_from_example_to_curves(real: Watch) -> None:
    page = real.page
    text = steps.choose_example(page, "Hanging riser, moving top")
    steps.write(page, text.replace("length: 170 m", "length: -170 m"))
    expect(page.locator(".sd-problem")).to_contain_text("lines.riser.segments.0.length")
    expect(page.locator(".sd-line-wrong")).to_contain_text("length: -170 m")
    steps.write(page, text)
    expect(page.locator(".sd-ready")).to_contain_text("ready to run")
    steps.start(page)
    steps.expect_done(page)
    steps.open_tab(page, "Along lines")
    expect(page.get_by_role("heading", name="Amplitude of tension", exact=True)).to_be_visible(timeout=steps.PATIENT)
    steps.expect_drawn(page, pictures=6, curves=8)


def test_the_vessel_from_example_to_seven_spectra(real: Watch) -> None:
    if not httpx.get(f"{real.origin}/api/v1/data-sets").json()["items"]:
        pytest.skip("the barge's hydrodynamic data are not bundled")
    page = real.page
    text = steps.choose_example(page, "FPSO 2000 m")
    steps.write(page, "\n".join(line for line in text.splitlines() if "time_domain:" not in line))
    steps.start(page)
    steps.expect_done(page)
    expect(page.get_by_role("cell", name="surge [m]")).to_be_visible()
    steps.open_tab(page, "Spectra")
    steps.expect_drawn(page, pictures=7, curves=14)
    steps.open_tab(page, "Static shape")
    expect(page.locator(".gl-container canvas").first).to_be_visible(timeout=steps.PATIENT)
