"""Charts are placed by arithmetic alone, and matplotlib draws the same marks."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.report.canned import diagnosis
from tests.report.test_left_out import whole

from stiction.report import figures, motion_figures
from stiction.report.axis import Axis, Scaling, around
from stiction.report.chart import Area, Bars, Chart, Line, Panel, Span, Words
from stiction.report.chart_figure import make_figure
from stiction.report.chart_svg import text_width, write_svg

SVG = "{http://www.w3.org/2000/svg}"
UNIT = Axis(0.0, 1.0)


def texts(axis: Axis) -> list[str]:
    return [text for _, text in axis.ticks()]


def drawn(chart: Chart) -> ElementTree.Element:
    return ElementTree.fromstring(write_svg(chart))


@pytest.mark.parametrize(
    ("axis", "told"),
    [
        (Axis(0.0, 10.0, most=5), ["0", "2", "4", "6", "8", "10"]),
        (Axis(-7.3, 7.3, most=2), ["−5", "0", "5"]),
        (Axis(3.0, -1.0, most=4), ["−1", "0", "1", "2", "3"]),
        (Axis(1e-4, 10.0, most=3, scaling="log"), ["10⁻⁴", "0.01", "1"]),
        (Axis(0.15, 9.0, most=4, scaling="log"), ["0.2", "0.5", "1", "2", "5"]),
        (
            Axis(-1e-3, 1.0, most=4, scaling="symlog", linear_to=1e-3),
            ["0", "0.001", "0.01", "0.1", "1"],
        ),
        (Axis(1.4, -0.6, names=("a", "b")), ["a", "b"]),
    ],
)  # fmt: skip
def test_ticks_are_round_and_not_too_many(axis: Axis, told: list[str]) -> None:
    assert texts(axis) == told


@pytest.mark.parametrize("scaling", ["linear", "log", "symlog"])
def test_places_rise_from_end_to_end_and_gaps_stay(scaling: Scaling) -> None:
    axis = Axis(1e-3, 10.0, scaling=scaling, linear_to=0.01)
    values = np.array([-1.0, 1e-3, 0.01, np.nan, 1.0, 10.0, 20.0])
    places = axis.place(values)
    assert np.isnan(places[3])
    seen = places[np.isfinite(places)]
    assert (seen[0], seen[1], seen[-2], seen[-1]) == (0.0, 0.0, 1.0, 1.0)
    assert (np.diff(seen[1:-1]) > 0.0).all()


@pytest.mark.parametrize("scaling", ["linear", "log", "symlog"])
@pytest.mark.parametrize("values", [[], [np.nan], [2.0, 2.0], [1e-3, 5.0]])
def test_an_axis_goes_around_whatever_there_is(scaling: Scaling, values: list[float]) -> None:
    axis = around([np.array(values)], Axis(0.0, 1.0, scaling=scaling, linear_to=0.1))
    assert np.isfinite([axis.low, axis.high]).all()
    assert axis.low < axis.high
    assert all(axis.low < value < axis.high for value in values if np.isfinite(value))
    assert axis.ticks()


def test_a_line_breaks_where_it_has_no_value() -> None:
    line = Line(np.arange(5.0) / 4.0, np.array([0.0, 1.0, np.nan, 0.5, 0.25]), "#123456")
    (path,) = [
        each for each in drawn(Chart(200.0, [Panel(UNIT, UNIT, [line], 50.0)])).iter(f"{SVG}path")
        if each.get("stroke") == "#123456"
    ]  # fmt: skip
    assert path.get("d", "").count("M") == 2
    assert len(re.findall(r"[\d.]+,[\d.]+", path.get("d", ""))) == 4


def test_numbers_and_words_have_room() -> None:
    """Nothing is written beyond the edges, though fonts differ."""
    words = Words(np.array([1.0]), np.array([0.5]), ["a word beside it"])
    upright = Axis(0.0, 1.0, "up", names=("a name that is long",))
    panel = Panel(replace(UNIT, label="across"), upright, [words], 40.0, title="A title")
    for each in drawn(Chart(300.0, [panel])).iter(f"{SVG}text"):
        if each.get("transform"):
            continue
        size, at = float(each.get("font-size", "")), float(each.get("x", ""))
        wide = text_width(each.text or "", size)
        start = {"end": at - wide, "middle": at - 0.5 * wide}.get(each.get("text-anchor", ""), at)
        assert start >= 0.0
        assert start + wide <= 300.0


def test_a_title_that_is_too_long_is_written_smaller() -> None:
    panel = Panel(UNIT, UNIT, [], 40.0, title="w" * 60)
    sizes = {each.text: each.get("font-size") for each in
             drawn(Chart(300.0, [panel, panel], columns=2)).iter(f"{SVG}text")}  # fmt: skip
    assert float(sizes["w" * 60] or "") < panel.size


def test_matplotlib_draws_the_same_marks() -> None:
    at = np.arange(3.0)
    marks = [
        Span("x", 0.0, 1.0, "#dddddd", "span"),
        Area(at, at, at + 1.0, "#cccccc", "area"),
        Bars(at, at, at + 0.5, ["#111111"] * 3, 0.5),
        Line(at, at, "#222222", 0.0, "o", 3.0, "points"),
        Words(at, at, ["a", "b", "c"]),
    ]
    panel = Panel(Axis(0.0, 3.0, "x"), Axis(0.0, 3.0), marks, 60.0, "Title", legend=True)
    figure = make_figure(Chart(300.0, [panel] * 3, 2, legend=True, upright="y"))
    assert len(figure.axes) == 4
    first = figure.axes[0]
    assert [t.get_text() for t in first.get_legend().get_texts()] == ["span", "area", "points"]
    assert (first.get_xlim(), first.get_xlabel()) == ((0.0, 3.0), "x")
    figure.canvas.draw()


def test_every_figure_can_be_a_figure_of_matplotlib() -> None:
    found = whole()
    charts = [getattr(figures, name) for name in figures.__all__ if name not in
              ("cause", "largest_views", "quantity_of")]  # fmt: skip
    charts += [motion_figures.motion, motion_figures.curves]
    for chart in (*(each(found) for each in charts), figures.cause(found, 0)):
        assert len(make_figure(chart).axes) >= len(chart.panels)


def test_a_report_needs_no_library_for_drawing() -> None:
    """Its import takes longer than the whole page."""
    code = (
        "import sys, tempfile; from tests.report.canned import diagnosis; "
        "diagnosis('missing_effect').save(tempfile.mkdtemp()); "
        "assert 'matplotlib' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_figure_of_a_diagnosis_has_its_panels() -> None:
    figure = diagnosis("missing_effect").plot()
    titles = [panel.get_title(loc="left") for panel in figure.axes]
    assert titles[0] == "measured effort"
    assert titles[1].startswith("before: ")
    assert titles[2].startswith("after: ")
