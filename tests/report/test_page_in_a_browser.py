"""The page as its reader has it: in Chromium, without a network, by mouse and keys, on a phone."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from tests.report.browser import Browser, chromium, opened
from tests.report.canned import diagnosis, trace

from stiction.report import write

HOSTILE = "</script><script>window.hurt = 1</script>&\"' run"
FOUND = chromium()
pytestmark = pytest.mark.skipif(
    FOUND is None or os.name == "nt", reason="no Chromium is installed that a pipe can drive"
)
TOLD = re.compile(r"(.*) \((\w+)\), ([\d.]+) to ([\d.]+) s: residual ([\d.]+) → ([\d.]+)")
READY = "document.getElementById('explorer').dataset.ready"
STATUS = "document.querySelector('[data-status]').textContent"


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three recordings, of which the third tests; each has a name that would break out."""
    folder = tmp_path_factory.mktemp("page")
    return write(diagnosis("missing_effect", name=HOSTILE, names=3), folder)


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    assert FOUND is not None
    with opened(FOUND, tmp_path_factory.mktemp("profile")) as browser:
        yield browser


@pytest.fixture
def browser(running: Browser, page: Path) -> Iterator[Browser]:
    """The page, opened anew; nothing may have been complained of or asked for in the end."""
    running.complaints.clear()
    running.requests.clear()
    running.size(1000, 1400)
    running.dark(False)
    running.open(page)
    running.wait(READY)
    running.wait(STATUS)
    yield running
    assert running.complaints == []
    assert set(running.requests) == {page.resolve().as_uri()}
    assert running.run("window.hurt") is None


def seen(browser: Browser) -> tuple[str, float, float]:
    """Recording, and first and last second that are shown, in the words of the page."""
    found = TOLD.match(browser.run(STATUS))
    assert found is not None, browser.run(STATUS)
    return found[1], float(found[3]), float(found[4])


def changed(browser: Browser, before: str) -> None:
    browser.wait(f"{STATUS} !== {before!r}")


def click(browser: Browser, name: str) -> None:
    before = browser.run(STATUS)
    browser.run(f"document.querySelector('[data-{name}]').click()")
    changed(browser, before)


def pressed(browser: Browser, key: str) -> None:
    before = browser.run(STATUS)
    browser.run("document.querySelector('[data-plots]').focus()")
    browser.press(key)
    changed(browser, before)


def choose(browser: Browser, name: str, value: str) -> None:
    browser.run(
        f"(() => {{ const e = document.querySelector('[data-{name}]'); e.value = '{value}';"
        " e.dispatchEvent(new Event('change')); })()"
    )


def panel(name: str) -> str:
    return f"document.querySelector('[data-time={name}] .u-over')"


def test_it_opens_with_the_recording_of_the_first_figure_and_all_are_reachable(
    browser: Browser,
) -> None:
    name, first, last = seen(browser)
    assert name == f"0 {HOSTILE}"
    assert (first, last) == (0.015, 5.01)
    names = browser.run(
        "[...document.querySelectorAll('[data-recording] option')].map(e => e.textContent)"
    )
    assert names[0] == "All 3 recordings, one after the other"
    assert names[1] == f"2 {HOSTILE} (test)"
    assert sorted(names[2:]) == [f"0 {HOSTILE} (train)", f"1 {HOSTILE} (select)"]
    choose(browser, "recording", "all")
    browser.wait(f"{STATUS}.startsWith('Several recordings')")


def test_residuals_are_told_as_they_are(browser: Browser) -> None:
    found = TOLD.match(browser.run(STATUS))
    assert found is not None
    own = trace("", 1, effects=True)
    used = own.role > 0
    for told, values in zip(found.groups()[-2:], (own.before, own.after), strict=True):
        expected = 1e3 * float(np.sqrt(np.mean(values[used] ** 2)))  # mN·m
        assert float(told) == pytest.approx(expected, rel=0.01)


def test_buttons_zoom_and_move(browser: Browser) -> None:
    _, first, last = seen(browser)
    click(browser, "in")
    _, low, high = seen(browser)
    assert high - low == pytest.approx(0.5 * (last - first), rel=1e-3)
    click(browser, "later")
    assert seen(browser)[1] == pytest.approx(low + 0.3 * (high - low), abs=1e-3)
    click(browser, "whole")
    assert seen(browser)[1:] == (first, last)


def test_a_drag_zooms_all_panels_over_time(browser: Browser) -> None:
    before = browser.run(STATUS)
    _, first, last = seen(browser)
    browser.drag(panel("residual"), 0.25, 0.5)
    changed(browser, before)
    _, low, high = seen(browser)
    assert low == pytest.approx(first + 0.25 * (last - first), abs=0.03)
    assert high == pytest.approx(first + 0.5 * (last - first), abs=0.03)


def test_a_drag_over_speed_keeps_that_speed_alone(browser: Browser) -> None:
    before = browser.run(STATUS)
    browser.drag("document.querySelector('[data-pairs] .u-over')", 0.6, 0.9)
    changed(browser, before)
    assert re.search(r"; speed [\d.]+ to [\d.]+.rad/s alone", browser.run(STATUS))
    assert not browser.run("document.querySelector('[data-clear]').disabled")
    pressed(browser, "Escape")
    assert "alone" not in browser.run(STATUS)


def test_keys_do_all_of_it(browser: Browser) -> None:
    name, first, last = seen(browser)
    pressed(browser, "+")
    _, low, high = seen(browser)
    assert high - low < 0.6 * (last - first)
    pressed(browser, "ArrowRight")
    assert seen(browser)[1] > low
    pressed(browser, "PageDown")
    assert seen(browser)[0] != name
    pressed(browser, "PageUp")
    assert seen(browser) == (name, first, last)
    pressed(browser, ".")
    assert re.search(r"position .* · speed .* · residual", browser.run(STATUS))


def test_pointing_at_a_curve_reads_the_values_of_that_row(browser: Browser) -> None:
    browser.drag(panel("effort"), 0.5, 0.5)
    browser.wait("document.querySelector('[data-readout]').textContent.includes('residual')")
    told = browser.run("document.querySelector('[data-readout]').textContent").replace("−", "-")
    values = re.search(
        r"· ([\d.]+)\xa0s · position ([-\d.]+)\xa0rad, simulated ([-\d.]+) → ([-\d.]+) · "
        r"speed ([-\d.]+)\xa0rad/s · effort ([-\d.]+)\xa0N·m · "
        r"residual ([-\d.]+) → ([-\d.]+)\xa0mN·m",
        told,
    )
    assert values is not None, told
    own = trace("", 1, effects=True)
    row = int(np.argmin(np.abs(own.time - float(values[1]))))
    assert own.simulated is not None
    stored = [own.position, *own.simulated, own.velocity, own.effort, own.before, own.after]
    for text, column, factor in zip(
        values.groups()[1:], stored, (1, 1, 1, 1, 1, 1e3, 1e3), strict=True
    ):
        fine = 0.01 * abs(factor * column[row]) + 5e-4 * factor
        assert float(text) == pytest.approx(factor * column[row], abs=fine)


def test_an_effect_is_drawn_where_it_is_known_what_it_explains(browser: Browser) -> None:
    legend = "document.querySelector('[data-legend-effect]').hidden"
    assert browser.run(legend)
    choose(browser, "candidate", "0")
    assert browser.run("document.querySelector('[data-told]').textContent").startswith("score 40")
    assert not browser.run(legend)
    choose(browser, "candidate", "1")
    assert "was not kept" in browser.run("document.querySelector('[data-told]').textContent")
    assert browser.run(legend)


def test_curves_can_be_hidden_so_that_what_is_left_fills_its_panel(browser: Browser) -> None:
    drawn = "document.querySelectorAll('.uplot').length"
    assert browser.run(drawn) == 7
    for kind in ("before", "measured", "after"):
        button = f"document.querySelector('[data-kind={kind}]')"
        browser.run(f"{button}.click()")
        assert browser.run(f"{button}.getAttribute('aria-pressed')") == "false"
        assert browser.run(drawn) == 7
    browser.run("document.querySelector('[data-kind=after]').click()")
    pressed(browser, "+")


def test_a_phone_shows_it_without_scrolling_sideways(browser: Browser, page: Path) -> None:
    browser.size(360, 740, phone=True)
    browser.open(page)
    browser.wait(READY)
    assert browser.run("document.scrollingElement.scrollWidth") <= 360
    widths = browser.run("[...document.querySelectorAll('.uplot')].map(e => e.clientWidth)")
    assert len(widths) == 7
    assert max(widths) <= 360
    click(browser, "in")


def test_a_finger_meets_what_it_is_to_press(browser: Browser, page: Path) -> None:
    browser.size(390, 844, phone=True)
    browser.open(page)
    browser.wait(READY)
    heights = browser.run(
        "[...document.querySelectorAll('#explorer button, #explorer select')]"
        ".map(e => e.getBoundingClientRect().height)"
    )
    assert min(heights) >= 32


def test_a_wide_screen_is_used_and_not_left(browser: Browser, page: Path) -> None:
    browser.size(1600, 1000)
    browser.open(page)
    browser.wait(READY)
    assert browser.run("document.scrollingElement.scrollWidth") <= 1600
    assert browser.run(f"{panel('residual')}.clientWidth") > 1000


def test_fingers_zoom_move_and_read(browser: Browser, page: Path) -> None:
    browser.size(360, 740, phone=True)
    browser.open(page)
    browser.wait(READY)
    browser.wait(STATUS)
    browser.run(f"{panel('residual')}.scrollIntoView({{block: 'center'}})")
    _, first, last = seen(browser)
    before = browser.run(STATUS)
    browser.touch(panel("residual"), [(0.4, 0.6), (0.3, 0.7), (0.2, 0.8)])
    changed(browser, before)
    _, low, high = seen(browser)
    assert high - low == pytest.approx((last - first) / 3.0, rel=0.05)
    before = browser.run(STATUS)
    browser.touch(panel("residual"), [(0.6,), (0.5,), (0.4,)])
    changed(browser, before)
    assert seen(browser)[1] == pytest.approx(low + 0.2 * (high - low), abs=0.05)
    browser.touch(panel("residual"), [(0.5,)])
    browser.wait("document.querySelector('[data-readout]').textContent.includes('residual')")


def test_it_is_dark_where_the_reader_likes_it_dark(browser: Browser) -> None:
    background = "getComputedStyle(document.body).backgroundColor"
    light = browser.run(background)
    browser.dark()
    dark = browser.run(background)
    brightness = [sum(int(n) for n in re.findall(r"\d+", each)[:3]) for each in (light, dark)]
    assert brightness[0] > 600
    assert brightness[1] < 150
    # Curves are drawn anew in lighter colours.
    assert (
        browser.run(
            "getComputedStyle(document.getElementById('explorer')).getPropertyValue('--after')"
        )
        == "#74b6f2"
    )


def test_paper_has_the_figures_that_stand_still(browser: Browser) -> None:
    shown = "[...document.querySelectorAll('.still, #explorer')].map(e => e.checkVisibility())"
    assert browser.run(shown) == [False, False, True]
    browser.call("Emulation.setEmulatedMedia", media="print")
    assert browser.run(shown) == [True, True, False]
    browser.call("Emulation.setEmulatedMedia", media="")


def test_without_scripts_the_figures_stay(browser: Browser, page: Path) -> None:
    browser.call("Emulation.setScriptExecutionDisabled", value=True)
    browser.open(page)
    shown = "[...document.querySelectorAll('.still, #explorer')].map(e => e.checkVisibility())"
    assert browser.run(shown) == [True, True, False]
    browser.call("Emulation.setScriptExecutionDisabled", value=False)
