"""The case editor: form and YAML on one case, faults at their fields, the draft, over the fake service."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from tests.browser import steps
from tests.browser.conftest import Watch

pytestmark = pytest.mark.browser
FPSO = "fpso-2000m"


def test_form_and_yaml_are_one_case(wide: Watch) -> None:
    page = wide.page
    text = steps.choose_example(page, FPSO)
    expect(steps.field(page, "environment", "depth")).to_have_value("2000 m")
    steps.fill(page, "1950.5 m", "environment", "depth")
    changed = page.locator("#case-text").input_value()
    different = [(a, b) for a, b in zip(text.split("\n"), changed.split("\n"), strict=True) if a != b]
    assert [b.strip() for _, b in different] == ["depth: 1950.5 m"]
    steps.write(page, changed.replace("mass: 110000 t", "mass: 120000 t"))
    steps.part(page, "Vessel")
    expect(steps.field(page, "vessel", "mass")).to_have_value("120000 t")
    steps.part(page, "Lines")
    page.get_by_role("button", name="Copy", exact=True).first.click()
    expect(page.locator("#case-text")).to_have_value(re.compile("bow-port copy:"))
    page.locator("summary", has_text="bow-port copy").click()
    page.locator('[data-field="lines.bow-port copy"]').get_by_role("button", name=re.compile("Remove line")).click()
    expect(page.locator("#case-text")).not_to_have_value(re.compile("bow-port copy:"))


def test_a_fault_stands_at_its_field_and_its_line(wide: Watch) -> None:
    page = wide.page
    steps.choose_example(page, FPSO)
    steps.part(page, "Lines")
    steps.fill(page, "-7 m", "lines", "bow-port", "segments", 0, "length")
    wrong = page.locator('[data-field="lines.bow-port.segments.0.length"] .sd-field-wrong')
    expect(wrong).to_contain_text("more than 0 m")
    expect(steps.field(page, "lines", "bow-port", "segments", 0, "length")).to_have_attribute("aria-invalid", "true")
    expect(page.locator("#tab-lines .sd-count")).to_have_text("1")
    expect(page.locator(".sd-line-wrong")).to_contain_text("-7 m")
    steps.part(page, "Sea")
    page.get_by_role("button", name=re.compile("Go to the field")).click()
    expect(steps.field(page, "lines", "bow-port", "segments", 0, "length")).to_be_focused()
    steps.fill(page, "3300 m", "lines", "bow-port", "segments", 0, "length")
    expect(page.locator(".sd-ready")).to_be_visible()
    expect(wrong).to_be_empty()


def test_help_is_the_schemas_and_reached_by_keyboard(wide: Watch) -> None:
    page = wide.page
    steps.empty_case(page)
    button = page.get_by_role("button", name="Help: Depth")
    button.focus()
    page.keyboard.press("Enter")
    note = page.locator("#f-environment-depth-help")
    expect(note).to_be_visible()
    expect(note).to_contain_text("Water depth.")
    expect(note).to_contain_text("m, mm, cm, km, ft, in")
    page.keyboard.press("Escape")
    expect(note).to_be_hidden()
    page.locator("#tab-sea").focus()
    page.keyboard.press("ArrowRight")
    expect(page.locator("#tab-vessel")).to_be_focused()
    expect(page.get_by_text("without one the lines hang")).to_be_visible()


def test_the_preview_draws_space_plan_profile_and_sea(wide: Watch) -> None:
    page = wide.page
    steps.choose_example(page, FPSO)
    expect(page.locator("#preview-picture .gl-container canvas").first).to_be_visible(timeout=steps.PATIENT)
    expect(page.locator("#preview-facts")).to_contain_text("bow-port")
    for view, words in (("Plan", "waves"), ("Profile", "seabed"), ("Sea", "jonswap, Hs 15.7 m, Tp 18.4 s")):
        page.locator("#preview-view").get_by_text(view, exact=True).click()
        expect(page.locator("#preview-picture .js-plotly-plot")).to_contain_text(words)


def test_half_written_yaml_keeps_the_form_and_says_where(wide: Watch) -> None:
    page = wide.page
    text = steps.choose_example(page, FPSO)
    expect(steps.field(page, "environment", "depth")).to_have_value("2000 m")
    steps.write(page, text + "broken: [1, 2")
    expect(page.locator("#case-form")).to_contain_text("The form waits: line")
    expect(steps.field(page, "environment", "depth")).to_have_value("2000 m")
    steps.write(page, text)
    expect(page.locator("#case-form")).not_to_contain_text("The form waits")


def test_the_scheme_follows_the_system_and_is_remembered(wide: Watch) -> None:
    page = wide.page
    page.emulate_media(color_scheme="dark")
    page.goto("/app/")
    scheme = "document.documentElement.getAttribute('data-mantine-color-scheme')"
    assert page.evaluate(scheme) == "dark"
    page.emulate_media(color_scheme="light")
    page.wait_for_function(f"() => {scheme} === 'light'")
    page.locator("#scheme").click()
    page.wait_for_function(f"() => {scheme} === 'dark'")
    page.reload()
    assert page.evaluate(scheme) == "dark"
    steps.choose_example(page, FPSO)
    page.locator("#preview-view").get_by_text("Sea", exact=True).click()
    expect(page.locator("#preview-picture .js-plotly-plot .main-svg").first).to_be_visible(timeout=steps.PATIENT)
    paper = "getComputedStyle(document.querySelector('#preview-picture .main-svg')).background"
    page.wait_for_function(f"() => {paper}.includes('rgb(36, 36, 36)')")
    page.locator("#scheme").click()
    page.wait_for_function(f"() => {paper}.includes('rgb(255, 255, 255)')")
