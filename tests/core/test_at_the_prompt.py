"""What one meets at the prompt of Python: names, help, tables and figures."""

from __future__ import annotations

import copy
import inspect
import pickle
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import stiction as st
from stiction import plot
from stiction.friction_plot import KINDS, plot_laws

LUGRE = {"drive": {"input": "force_n"}, "body": {"inertia": 1.0}, "friction": {"law": "lugre"}}


def motor() -> st.Motor:
    return st.Motor(0.0076, friction=st.FrictionModel("coulomb", coulomb=0.2))


def linear() -> st.Plant:
    return st.Plant.from_dict({"motion": {"kind": "linear"}, **LUGRE})


@pytest.mark.parametrize("given", ["sigma0", "sigma_0", "σ0", "k0"])
def test_symbols_are_answered_with_the_name_of_every_law_that_has_it(given: str) -> None:
    for record in st.laws():
        names = [each.name for each in record.parameters]
        if "initial_stiffness" in names:
            with pytest.raises(st.InputError, match="called 'initial_stiffness' here"):
                st.FrictionModel(record.name, **{given: 1.0})


def test_every_symbol_of_a_law_leads_to_its_own_parameter() -> None:
    for record in st.laws():
        for each in record.parameters:
            if each.symbol:
                assert each.symbol in each.meaning
                with pytest.raises(st.InputError, match=f"called '{each.name}' here"):
                    st.FrictionModel(record.name, **{each.symbol: 1.0})


def test_the_catalogue_is_read_by_name_and_by_place() -> None:
    laws = st.laws()
    assert laws["lugre"] is next(law for law in laws if law.name == "lugre")
    assert laws[0] is next(iter(laws))
    assert "lugre" in laws
    assert laws["lugre"] in laws
    assert "lugree" not in laws
    assert len(laws) == len(laws.names) == len(laws[:])
    with pytest.raises(KeyError, match="did you mean 'cogging'"):
        st.effects()["coging"]
    assert pickle.loads(pickle.dumps(laws)) == laws


def test_what_a_model_has_cannot_be_changed_in_place() -> None:
    for held in (motor().friction.parameters, motor().friction.options, motor().parameters):
        for change in (
            lambda d: d.update(a=1.0),
            lambda d: d.pop("coulomb", None),
            lambda d: d.__setitem__("coulomb", 1.0),
            lambda d: d.setdefault("x", 1.0),
            lambda d: d.clear(),
        ):
            with pytest.raises(st.InputError, match="cannot be set in place"):
                change(held)
        for again in (pickle.loads(pickle.dumps(held)), copy.deepcopy(held), {**held}):
            again["new"] = 1.0
            assert held == {name: again[name] for name in again if name != "new"}


def test_signatures_and_help_say_everything() -> None:
    for public in (st.Motor, st.FrictionModel, st.Ensemble, st.Motor.simulate, st.fit_curve):
        parameters = inspect.signature(public).parameters.values()
        assert all(each.default is not ... for each in parameters), public
    assert inspect.signature(st.Motor).parameters["input_limit"].default == np.inf
    assert all(name in (st.FrictionModel.__doc__ or "") for name in st.laws().names)
    assert {name for name in dir(st) if not name.startswith("__")} == set(st.__all__) - {
        "__version__"
    }


def test_notebooks_show_tables_with_what_they_hold() -> None:
    ensemble = st.Ensemble(motor(), parameters={"coulomb": [0.1, 0.15]})
    shown = {
        "FrictionModel": (motor().friction, "friction while sliding fast"),
        "Motor": (motor(), "0.0076"),
        "Ensemble": (ensemble, "0.15"),
        "laws": (st.laws(), "lugre"),
        "effects": (st.effects(), "cogging"),
        "Trajectory": (linear().simulate(np.ones(50), 1e-3), "position (m)"),
        "CurveFit": (st.fit_curve(np.arange(1.0, 9.0), np.ones(8)), "friction.coulomb"),
    }
    for name, (held, word) in shown.items():
        html = held._repr_html_()
        assert word in html, name
        assert html.count("<table>") == html.count("</table>") > 0, name


def test_a_trajectory_knows_its_units_and_takes_axes() -> None:
    run = linear().simulate(np.ones(50), 1e-3)
    assert run.units["velocity"] == "m/s"
    panels = run.plot()
    assert [panel.get_ylabel() for panel in panels] == [
        "position\n(m)", "velocity\n(m/s)", "friction\n(N)",
    ]  # fmt: skip
    assert panels._repr_png_().startswith(b"\x89PNG")
    own = Figure().subplots(2)
    assert tuple(run.plot(own)) == tuple(own)
    assert run.plot(own[0])[0] is own[0]
    assert len(own[0].lines) == 2
    assert motor().simulate(np.ones(50), 1e-3).units["friction"] == "N·m or N"
    assert pickle.loads(pickle.dumps(run)).units == run.units
    for wrong in (3, [3], [], Figure().subplots(4)):
        with pytest.raises(st.InputError, match="plot: ax"):
            run.plot(wrong)
    with pytest.raises(st.InputError, match="motion"):
        run.of_motion("round")


def test_axes_are_saved_as_their_figure(tmp_path) -> None:
    panels = linear().simulate(np.ones(50), 1e-3).plot()
    assert plot.save(panels, tmp_path / "run.svg").stat().st_size > 1000
    assert plot.save(panels[0], tmp_path / "one.png").stat().st_size > 1000


@pytest.mark.parametrize("kind", KINDS)
def test_laws_are_drawn_side_by_side(kind: str) -> None:
    axes = plot_laws(["lugre", "coulomb"], kind=kind)
    assert [line.get_label() for line in axes.lines] == ["lugre", "coulomb"]
    assert axes.get_legend() is not None
    assert "(" in axes.get_xlabel()
    assert axes.get_ylabel().endswith("(N·m)")
    assert linear().plot_friction(Figure().subplots(), kind=kind).get_ylabel().endswith("(N)")


def test_what_cannot_be_drawn_is_said() -> None:
    for call, told in (
        (lambda: plot_laws("lugre"), "is a word"),
        (lambda: plot_laws([]), "there are no laws"),
        (lambda: plot_laws(["lugree"]), "did you mean 'lugre'"),
        (lambda: plot_laws(["lugre", linear()]), "draw them apart"),
        (lambda: plot_laws(["lugre"], kind="speeds"), "did you mean 'speed'"),
        (lambda: plot_laws(["hsieh_pan"], kind="breakaway"), "never slides"),
    ):
        with pytest.raises(st.InputError, match=told):
            call()


def test_lugre_breaks_away_earlier_where_it_is_loaded_faster() -> None:
    (line,) = plot_laws(["lugre"], kind="breakaway").lines
    peaks = line.get_ydata()
    assert peaks[0] > 1.1 * peaks[-1]


def test_text_that_no_encoding_has_is_a_symbol_that_nobody_knows() -> None:
    table = {"friction": {"law": "coulomb", "\ud800": 1.0}}
    with pytest.raises(st.InputError, match="is unknown"):
        st.Plant.from_dict(table)


def test_panels_are_saved_as_their_figure_is(tmp_path: Path) -> None:
    panels = motor().simulate([0.5] * 100, 1e-3).plot()
    panels.savefig(tmp_path / "run.png")
    assert (tmp_path / "run.png").stat().st_size > 1000
