"""The whole way through the pages, over the fake service."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import expect

from tests.browser import steps
from tests.browser.conftest import Watch
from tests.frontend.fake_api import SLOWLY

pytestmark = pytest.mark.browser
FPSO, RISER = "fpso-2000m", "hanging-riser-case1"


def test_from_an_example_over_an_error_to_the_seven_spectra(wide: Watch) -> None:
    page = wide.page
    text = steps.choose_example(page, FPSO)
    steps.write(page, text.replace("length: 3300 m", "length: -5 m", 1))
    problem = page.locator(".sd-problem")
    expect(problem).to_have_count(1)
    expect(problem).to_contain_text("lines.bow-port.segments.0.length")
    expect(page.locator(".sd-number-wrong")).to_have_count(1)
    expect(page.locator(".sd-line-wrong")).to_contain_text("length: -5 m")
    problem.click()
    assert page.evaluate("document.activeElement.id") == "case-text"
    picked = "(a => a.value.slice(a.selectionStart, a.selectionEnd))(document.activeElement)"
    assert page.evaluate(picked).startswith("length: -5 m")

    steps.write(page, f"{text}\n{SLOWLY}\n")
    expect(page.locator(".sd-ready")).to_contain_text("ready to run")
    expect(page.locator(".sd-number-wrong")).to_have_count(0)
    steps.start(page)
    expect(page.locator("#run-badge")).to_have_text("running")
    expect(page.locator("#run-progress-text")).to_contain_text("%")
    steps.expect_done(page)
    expect(page.locator("#run-title")).to_have_text("FPSO 2000 m")
    expect(page.locator(".sd-key-value").first).to_be_visible()

    steps.open_tab(page, "Spectra")
    steps.expect_drawn(page, pictures=7, curves=28)
    page.get_by_text("One axis, log").click()
    expect(page).to_have_url(re.compile(r"tab=spectra&line=bow-port&scale=log|tab=spectra&scale=log"))
    steps.expect_drawn(page, pictures=7, curves=28)


def test_a_link_opens_what_was_on_the_screen(wide: Watch) -> None:
    page = wide.page
    steps.choose_example(page, FPSO)
    run_id = steps.start(page)
    steps.expect_done(page)
    page.goto(f"/app/runs/{run_id}?tab=lines&line=stern-port")
    expect(page.get_by_role("heading", name="σ of tension, stern-port")).to_be_visible(timeout=steps.PATIENT)
    page.goto(f"/app/runs/{run_id}?tab=shape")
    expect(page.locator(".gl-container canvas").first).to_be_visible(timeout=steps.PATIENT)
    steps.open_tab(page, "Modes")
    expect(page.get_by_role("cell", name="52.40")).to_be_visible()
    steps.open_tab(page, "Case and provenance")
    expect(page.locator("#case-yaml")).to_contain_text("bow-starboard")
    with page.expect_download() as saved:
        page.get_by_text("Summary (JSON)").click()
    assert saved.value.suggested_filename == f"summary-{run_id}.json"


def test_a_riser_shows_amplitudes(wide: Watch) -> None:
    page = wide.page
    steps.choose_example(page, RISER)
    steps.start(page)
    steps.expect_done(page)
    expect(page.get_by_role("tab")).to_have_text(
        ["Overview", "Time domain", "Along lines", "Static shape", "Case and provenance"]
    )
    steps.open_tab(page, "Along lines")
    steps.expect_drawn(page, pictures=4, curves=6)


SHOWN = "(g => [g.data[0].x.length, g.data[0].x[0], g.data[0].x.at(-1)])(document.querySelector('.js-plotly-plot'))"


def test_a_history_shows_more_where_one_looks_closer(wide: Watch) -> None:
    page = wide.page
    steps.choose_example(page, FPSO)
    run_id = steps.start(page)
    steps.expect_done(page)
    page.goto(f"/app/runs/{run_id}?tab=time&response=line:bow-port&seed=2")
    expect(page.get_by_role("heading", name="Tension at end b, bow-port, seed 2")).to_be_visible(timeout=steps.PATIENT)
    steps.expect_drawn(page, pictures=1, curves=1)
    expect(page.get_by_role("heading", name="Extremes of tension [kN]")).to_be_visible()
    before, *whole = page.evaluate(SHOWN)
    box = page.locator(".js-plotly-plot .nsewdrag").first.bounding_box()
    assert box
    page.mouse.move(box["x"] + 300, box["y"] + 100)
    page.mouse.down()
    page.mouse.move(box["x"] + 500, box["y"] + 104, steps=5)
    page.mouse.up()
    page.wait_for_function(f"n => {SHOWN}[0] !== n", arg=before)
    _, start, end = page.evaluate(SHOWN)
    assert whole[0] < start < end < whole[1]
    page.mouse.dblclick(box["x"] + 300, box["y"] + 100)
    page.wait_for_function(f"n => {SHOWN}[0] === n", arg=before)
    assert page.evaluate(SHOWN)[1:] == whole


def test_a_zoom_is_in_the_address_and_a_picture_becomes_a_file(wide: Watch) -> None:
    page = wide.page
    steps.choose_example(page, FPSO)
    run_id = steps.start(page)
    steps.expect_done(page)
    page.goto(f"/app/runs/{run_id}?tab=time&response=surge&seed=1&from=100&to=260")
    expect(page.get_by_role("heading", name="Surge, seed 1")).to_be_visible(timeout=steps.PATIENT)
    steps.expect_drawn(page, pictures=1, curves=1)
    _, start, end = page.evaluate(SHOWN)
    assert start >= 100
    assert end <= 260
    expect(page.locator(".dash-graph--pending")).to_have_count(0, timeout=steps.PATIENT)
    page.evaluate(  # and the window changes its size before the finer curve is there, which says nothing of time
        """async () => {
          const plot = document.querySelector('.js-plotly-plot');
          await window.Plotly.relayout(plot, {'xaxis.range[0]': 120, 'xaxis.range[1]': 200});
          await new Promise((done) => setTimeout(done, 60));
          await window.Plotly.relayout(plot, {autosize: true});
        }"""
    )
    expect(page).to_have_url(re.compile(r"from=120&to=200"))
    page.wait_for_function(f"() => {SHOWN}[1] >= 119 && {SHOWN}[2] <= 201")
    for kind in ("svg", "csv"):
        with page.expect_download() as saved:
            page.locator(f".modebar-btn[data-title*='{kind.upper()}']").first.dispatch_event("click")
        assert saved.value.suggested_filename.endswith(kind)
        text = saved.value.path().read_bytes().decode()
        assert ("<svg" in text) if kind == "svg" else text.startswith("curve,time after the build-up [s],surge [m]\r\n")
    rows = text.strip().split("\r\n")[1:]
    assert len(rows) > 20
    assert all(len(row.split(",")) == 3 for row in rows)


def test_the_list_is_live_and_cancels_and_deletes(wide: Watch) -> None:
    page = wide.page
    steps.choose_example(page, RISER)
    steps.start(page)
    page.get_by_text("All runs").click()
    first = page.locator('.ag-row[row-index="0"]')
    expect(first.locator(".sd-badge")).to_have_text("succeeded", timeout=steps.PATIENT)

    answer = page.evaluate("fetch('/api/v1/runs').then(r => r.json()).then(b => b.items[0].case_id)")
    page.evaluate(
        "id => fetch('/api/v1/runs', {method: 'POST', headers: {'content-type': 'application/json'},"
        " body: JSON.stringify({case_id: id})})",
        answer,
    )
    expect(first.locator(".sd-badge")).to_have_text(re.compile("queued|running"))
    first.get_by_role("button", name=re.compile("Cancel")).click()
    expect(first.locator(".sd-badge")).to_have_text("cancelled")
    before = page.locator("#runs-total").inner_text()
    first.get_by_role("button", name=re.compile("Delete")).click()
    page.locator("#runs-delete").click()
    expect(page.locator("#runs-total")).not_to_have_text(before)


def test_the_draft_survives_a_reload(wide: Watch) -> None:
    page = wide.page
    text = steps.choose_example(page, FPSO)
    steps.write(page, text + "# my own words\n")
    page.wait_for_function("() => Object.values(localStorage).some(kept => kept.includes('my own words'))")
    page.reload()
    expect(page.locator("#case-text")).to_have_value(re.compile("my own words"))


def test_a_data_set_that_is_none_is_refused_with_words(wide: Watch) -> None:
    page = wide.page
    page.goto("/app/new")
    with page.expect_file_chooser() as chooser:
        page.locator("#data-set-upload").click()
    chooser.value.set_files({"name": "barge.nc", "mimeType": "application/x-netcdf", "buffer": b"CDF\x01 small"})
    expect(page.locator("#import-message")).to_contain_text("barge.nc is ready")
    with page.expect_file_chooser() as chooser:
        page.locator("#data-set-upload").click()
    chooser.value.set_files({"name": "notes.txt", "mimeType": "text/plain", "buffer": b"hello"})
    expect(page.locator("#import-message")).to_contain_text("not NetCDF")
    wide.faults[:] = [fault for fault in wide.faults if "422" not in fault]  # the browser reports the refusal itself


def test_nothing_scrolls_sideways_on_a_phone(narrow: Watch) -> None:
    page = narrow.page
    steps.choose_example(page, FPSO)
    steps.expect_no_sideways_scroll(page)
    run_id = steps.start(page)
    steps.expect_done(page)
    tabs = ("overview", "spectra", "time", "raos", "lines", "shape", "modes", "case")
    for tab in tabs:
        page.goto(f"/app/runs/{run_id}?tab={tab}")
        expect(page.locator("#run-panel > div:not(.mantine-Skeleton-root)").first).to_be_visible(timeout=steps.PATIENT)
        steps.expect_no_sideways_scroll(page)
    page.goto("/app/")
    expect(page.locator(".ag-row").first).to_be_visible()
    steps.expect_no_sideways_scroll(page)
    page.get_by_role("button", name="Navigation").click()
    page.locator(".mantine-AppShell-navbar").get_by_text("New run").click()
    expect(page).to_have_url(re.compile("/app/new"))


def test_an_unknown_run_says_so(wide: Watch) -> None:
    wide.page.goto("/app/runs/nothing")
    expect(wide.page.locator("#run-title")).to_have_text("No such run")
    wide.faults[:] = [fault for fault in wide.faults if "404" not in fault]
