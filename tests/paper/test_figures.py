"""Every figure is drawn, has something on it and is the same each time."""

from __future__ import annotations

import json
import subprocess
import sys

import matplotlib
import numpy as np
import pytest

import stiction as st
from stiction import plot
from stiction.cli.paper_sections import (
    Section,
    paper_command,
    render_json,
    render_text,
    write_numbers,
)
from stiction.errors import InputError
from stiction.paper.figures import static_comparison

# Bytes; an empty figure of this size is far smaller.
LEAST_SVG, LEAST_PNG = 15_000, 15_000


def ink(figure):
    """Finite points on all lines and bars of a figure."""
    lines = [line.get_xydata() for panel in figure.axes for line in panel.lines]
    return sum(int(np.isfinite(data).all(axis=1).sum()) for data in lines)


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    out = tmp_path_factory.mktemp("paper")
    return out, paper_command(out)


def test_command_draws_every_experiment_twice_and_writes_the_numbers(drawn):
    out, sections = drawn
    assert len(sections) == 17
    for section in sections:
        svg, png = section.figures
        assert svg.suffix == ".svg"
        assert png.suffix == ".png"
        assert svg.stat().st_size > LEAST_SVG
        assert png.stat().st_size > LEAST_PNG
        assert section.result.numbers
    written = json.loads((out / "numbers.json").read_text(encoding="utf-8"))
    assert written == json.loads(json.dumps(render_json(sections)))
    assert len(written["experiments"]) == len(sections)


def test_command_says_that_the_rig_is_illustrative(drawn):
    _, sections = drawn
    text = render_text(sections)
    assert "illustrative" in text
    for section in sections:
        assert section.result.title in text


def test_command_refuses_a_file_as_folder(tmp_path):
    taken = tmp_path / "taken"
    taken.write_text("")
    with pytest.raises(InputError, match="taken"):
        paper_command(taken)


@pytest.mark.parametrize("name", ["experiment_1", "experiment_2", "experiment_3", "static_1"])
def test_axes_carry_labels_with_units(name, request):
    figure = request.getfixturevalue(name).plot()
    assert ink(figure) > 100
    assert figure.get_suptitle()
    for panel in figure.axes:
        assert "(" in panel.get_ylabel()
    assert "(" in figure.axes[-1].get_xlabel()


def test_comparison_shows_every_way_of_driving(static_1, static_1_stepped):
    figure = static_comparison([static_1, static_1_stepped])
    assert len(figure.axes[0].lines) == 2


def test_no_global_state_is_touched(experiment_2, tmp_path):
    before = dict(matplotlib.rcParams)
    pyplot = sys.modules.get("matplotlib.pyplot")
    plot.save(experiment_2.plot(), tmp_path / "one.svg")
    assert dict(matplotlib.rcParams) == before
    assert sys.modules.get("matplotlib.pyplot") is pyplot


@pytest.mark.parametrize("ending", [".svg", ".png"])
def test_same_figure_gives_the_same_bytes(experiment_2, tmp_path, ending):
    one = plot.save(experiment_2.plot(), tmp_path / f"one{ending}").read_bytes()
    other = plot.save(experiment_2.plot(), tmp_path / f"other{ending}").read_bytes()
    assert one == other
    assert b"dc:date" not in one


def test_another_ending_is_refused(experiment_2, tmp_path):
    with pytest.raises(InputError, match=r"\.pdf"):
        plot.save(experiment_2.plot(), tmp_path / "one.pdf")
    with pytest.raises(InputError, match="there is no folder"):
        plot.save(experiment_2.plot(), tmp_path / "none" / "one.svg")


def test_trajectory_draws_what_it_has():
    motor = st.Motor(inertia=0.0076, friction=st.FrictionModel("hsieh_pan"))
    whole = motor.simulate(np.full(200, 0.2), 1e-4)
    assert len(whole.plot().axes) == 3
    part = motor.simulate(np.full(200, 0.2), 1e-4, outputs=["position"])
    assert len(part.plot().axes) == 1
    states = motor.simulate(np.full(200, 0.2), 1e-4, outputs=["hardening"])
    assert states.plot().axes[0].get_ylabel() == "hardening"


@pytest.mark.parametrize("draw", [plot.overlay, plot.residual])
def test_comparison_has_a_panel_for_the_difference(draw):
    time = np.linspace(0.0, 1.0, 20_000)
    measured = np.sin(6.0 * time)
    figure = draw(time, measured, measured - 0.1, unit="rad", title="A recording")
    upper, lower = figure.axes
    assert len(upper.lines) == 2
    assert np.allclose(lower.lines[-1].get_ydata(), 0.1)
    assert "(rad)" in upper.get_ylabel()
    assert "(rad)" in lower.get_ylabel()


def test_comparison_of_unequal_lengths_is_refused():
    with pytest.raises(InputError, match="equally long"):
        plot.overlay(np.arange(3.0), np.arange(3.0), np.arange(4.0), unit="rad")


def test_thinned_line_keeps_extremes_and_ends():
    time = np.linspace(0.0, 1.0, 100_001)
    line = np.sin(40.0 * time)
    line[5000], line[70_000] = 7.0, -7.0
    x, y = plot.thinned(time, line)
    assert len(x) < 3100
    assert np.all(np.diff(x) > 0.0)
    assert (y.max(), y.min()) == (7.0, -7.0)
    assert (x[0], x[-1]) == (0.0, 1.0)


def test_thinned_line_keeps_gaps_and_short_lines():
    line = np.ones(100_000)
    line[20_000:40_000] = np.nan
    _, y = plot.thinned(np.arange(100_000.0), line)
    assert np.isnan(y).any()
    short = np.array([1.0, np.nan, 2.0])
    assert plot.thinned(np.arange(3.0), short)[1] is short


def test_plotting_is_imported_on_use_only():
    code = "import sys, stiction.paper; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_a_number_that_is_not_known_is_null_in_the_file(tmp_path):
    class Open:
        def to_dict(self):
            return {"measured": float("nan"), "limit": float("inf")}

    write_numbers(tmp_path, [Section("one", Open(), ())])
    (read,) = json.loads((tmp_path / "numbers.json").read_text("utf-8"))["experiments"]
    assert read == {"name": "one", "measured": None, "limit": None, "figures": []}
