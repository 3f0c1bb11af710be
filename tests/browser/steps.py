"""What a person does on the pages, in words the tests share."""

from __future__ import annotations

import re

from playwright.sync_api import Locator, Page, expect

PATIENT = 60_000  # software WebGL and a shared machine


def choose_example(page: Page, words: str) -> str:
    page.goto("/app/new")
    page.locator("#example").click()
    page.get_by_role("option", name=words, exact=True).click()
    expect(page.locator("#case-text")).not_to_have_value("")
    return page.locator("#case-text").input_value()


def field(page: Page, *path: str | int) -> Locator:
    """The field of the form at a path of the case."""
    return page.locator(f'[data-field="{".".join(map(str, path))}"] .sd-input').first


def part(page: Page, name: str) -> None:
    """Another part of the form: Sea, Vessel, Line types, Lines, Attachments, Analyses."""
    page.locator("#case-form").get_by_role("tab", name=re.compile(f"^{name}")).click()


def fill(page: Page, value: str, *path: str | int) -> None:
    """Type into a field and wait until the text has it."""
    field(page, *path).fill(value)
    field(page, *path).blur()
    expect(page.locator("#case-text")).to_have_value(re.compile(re.escape(value)))


def empty_case(page: Page) -> None:
    page.goto("/app/new")
    page.evaluate("localStorage.clear()")
    page.goto("/app/new")
    expect(page.locator("#tab-sea")).to_be_visible(timeout=PATIENT)
    page.get_by_role("button", name="Empty case").click()
    expect(page.locator("#case-text")).to_have_value(re.compile("New case"))


def write(page: Page, text: str) -> None:
    page.locator("#case-text").fill(text)


def start(page: Page) -> str:
    """Press Run; the id of the run that opens."""
    page.locator("#case-run").click()
    page.wait_for_url(re.compile(r"/app/runs/\w+"))
    found = re.search(r"/runs/(\w+)", page.url)
    assert found
    return found[1]


def expect_done(page: Page) -> None:
    expect(page.locator("#run-badge")).to_have_text("succeeded", timeout=PATIENT)


def open_tab(page: Page, name: str) -> None:
    page.get_by_role("tab", name=name, exact=True).click()


def expect_drawn(page: Page, pictures: int, curves: int) -> None:
    """So many pictures, and so many curves with points in them."""
    expect(page.locator(".js-plotly-plot")).to_have_count(pictures, timeout=PATIENT)
    expect(page.locator(".scatterlayer .trace .lines path")).to_have_count(curves, timeout=PATIENT)
    for curve in page.locator(".scatterlayer .trace .lines path").all():
        assert "L" in (curve.get_attribute("d") or "")


def expect_no_sideways_scroll(page: Page) -> None:
    wide, inner = page.evaluate("[document.documentElement.scrollWidth, window.innerWidth]")
    assert wide <= inner
