"""``st.load`` takes any file; results show and draw themselves."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.cli.desk import Desk

import stiction as st


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    return Desk(tmp_path)


def test_a_file_says_itself_what_it_is(desk: Desk) -> None:
    session = st.load(desk.session)
    assert isinstance(session, st.Session)
    plant = st.load(str(desk.plant))
    assert isinstance(plant, st.Plant)
    assert plant.inertia == 0.01
    columns = {"input": {"name": "u", "unit": "Nm"}, "time": "t"}
    recording = st.load(desk.csv, columns=columns)
    assert isinstance(recording, st.Recording)
    np.testing.assert_array_equal(recording.position, session.recordings[0].position)


def test_findings_and_columns_of_a_session_are_refused_in_a_sentence(desk: Desk) -> None:
    findings = desk.folder / "findings.json"
    findings.write_text("{}")
    with pytest.raises(st.InputError, match=r"plant\.toml beside it"):
        st.load(findings)
    with pytest.raises(st.InputError, match="columns are for a recording"):
        st.load(desk.session, columns={})


def test_a_session_alone_is_fitted_with_its_own_plant(desk: Desk) -> None:
    session = st.load(desk.session)
    alone, both = st.fit(session), st.fit(session.plant, session)
    assert dict(alone.parameters) == dict(both.parameters)
    with pytest.raises(st.InputError, match="there are no recordings"):
        st.fit(session.plant)
    with pytest.raises(st.InputError, match="plant is missing"):
        st.fit(st.Session(session.recordings))


def test_a_session_alone_is_diagnosed_with_its_own_plant(desk: Desk) -> None:
    session = st.load(desk.session)
    few = {"without": [e.name for e in st.effects()][1:], "surrogates": 4}
    alone, both = st.diagnose(session, **few), st.diagnose(session.plant, session, **few)
    assert alone.verdict == both.verdict
    assert alone.baseline == both.baseline
    with pytest.raises(st.InputError, match="there are no recordings"):
        st.diagnose(session.plant)


def test_notebooks_show_escaped_tables_and_small_figures(desk: Desk) -> None:
    session = st.load(desk.session)
    few = {"without": [e.name for e in st.effects()][1:], "surrogates": 4}
    found = st.diagnose(session, **few)
    run = session.plant.simulate(np.sin(np.arange(20000) / 50.0), 1e-3)
    for each in (session, st.fit(session), found, run):
        html = each._repr_html_()
        assert "<table>" in html
        assert "http" not in html.replace("http://www.w3.org/2000/svg", "")
        assert len(html) < 60_000
        svg = ElementTree.fromstring(html[html.index("<svg") : html.index("</svg>") + 6])
        lines = [node for node in svg.iter() if node.tag.endswith("polyline")]
        assert lines
        assert "nan" not in html[html.index("<svg") :]
    assert found.baseline.unit in found._repr_html_()


def test_names_of_files_are_escaped(desk: Desk) -> None:
    evil = desk.instead("<b>&.csv")
    desk.csv.rename(evil)
    html = st.load(desk.session)._repr_html_()
    assert "<b>&" not in html
    assert "&lt;b&gt;&amp;.csv" in html


def test_figures_take_and_return_axes_with_units_and_a_legend(desk: Desk) -> None:
    from matplotlib.figure import Figure

    session = st.load(desk.session)
    fit = st.fit(session)
    for draw in (session.plot, session.plant.plot_friction, fit.plot):
        own = draw()
        assert "(s)" in own.get_xlabel() or "rad/s" in own.get_xlabel()
        assert any(unit in own.get_ylabel() for unit in ("(rad)", "(N·m)"))
        ax = Figure().subplots()
        assert draw(ax) is ax
        assert ax.get_legend().get_texts()
        assert np.isfinite(ax.lines[0].get_ydata()).all()
        with pytest.raises(st.InputError, match="give axes"):
            draw("axes")
    other = st.Plant.from_dict({"friction": {"law": "lugre"}}).plot_friction(ax, label="other")
    assert [text.get_text() for text in other.get_legend().get_texts()][-1] == "other"


def test_a_fit_saves_and_sums_up(desk: Desk) -> None:
    fit = st.fit(st.load(desk.session))
    path = fit.save(desk.folder / "fit.json")
    assert path.read_text("utf-8").strip() == fit.to_json()
    assert fit.summary() == str(fit)


def test_the_package_lists_its_names_and_nothing_else() -> None:
    assert [name for name in dir(st) if not name.startswith("__")] == sorted(
        set(st.__all__) - {"__version__"}
    )


@pytest.mark.parametrize("record", [*st.laws(), *st.effects()], ids=lambda each: each.name)
def test_a_law_or_an_effect_shows_its_parameters_in_a_notebook(record: object) -> None:
    html = record._repr_html_()
    assert f"<b>{record.name}</b>" in html
    assert html.count("<tr>") == 1 + len(record.parameters)
    assert all(f"<td>{each.name}</td>" in html for each in record.parameters)
