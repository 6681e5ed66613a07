"""A figure, a section or a law that fails is a sentence in its place, and the answer stands."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import wraps
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.cli.desk import Desk
from tests.report.canned import diagnosis
from tests.report.test_report import Page

import stiction as st
from stiction.cli import run
from stiction.diagnosis import Diagnosis
from stiction.diagnosis.adequacy.omnibus import Rest, View
from stiction.diagnosis.findings.pictures import Tracking
from stiction.report import drawings, figures, motion_figures
from stiction.report.axis import Axis
from stiction.report.chart import Chart, Line, Panel
from stiction.report.sections import BUILDERS, Section, name_of, rest

FILES = {"report.html", "findings.json", "plant.toml", "base.toml", "begins.toml", "figures"}
FAULT = "IndexError: a fault of its own"


def whole() -> Diagnosis:
    """With every figure that there is."""
    found = diagnosis("unexplained")
    assert found.pictures is not None
    time = np.arange(50) * 0.1
    tracking = Tracking("run.csv", time, np.sin(time), 0.9 * np.sin(time), 0.95 * np.sin(time))
    return replace(found, pictures=replace(found.pictures, tracking=tracking))


ORDERS = drawings.orders(whole())


def faulty(*_: object, **__: object) -> Any:
    raise IndexError("a fault of its own")


def quick(order: drawings.Order) -> drawings.Order:
    """The figure in name, with nothing in it."""
    empty = Chart(100.0, [Panel(Axis(0.0, 1.0), Axis(0.0, 1.0), (), 10.0)])
    shown = drawings._Shown(lambda *_, narrow: empty, "A label of it.", "A caption.")
    return drawings.Order(order.name, lambda _: shown)


def answered(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> str:
    """The page that the command writes of the diagnosis; its exit and its files are looked at."""
    desk = Desk(folder)
    monkeypatch.setattr("stiction.diagnosis.diagnose", lambda *_, **__: whole())
    out = folder / "out"
    assert run(["diagnose", str(desk.session), "-o", str(out)]) == 0
    told = capsys.readouterr()
    assert whole().sentence in told.out
    assert "Traceback" not in told.err
    assert {path.name for path in out.iterdir()} == FILES
    assert json.loads((out / "findings.json").read_text("utf-8"))["sentence"] == whole().sentence
    assert st.Plant.load(out / "plant.toml") == whole().plant
    text = (out / "report.html").read_text("utf-8")
    page = Page(text)
    assert page.open == []
    assert whole().sentence in page.text
    return page.text


def test_the_diagnosis_of_these_tests_has_every_figure() -> None:
    names = [order.name.rstrip("0123456789-") for order in ORDERS]
    drawn = {name for name in figures.__all__ if name not in ("largest_views", "quantity_of")}
    drawn |= set(motion_figures.__all__) - {"simulated_trace"}
    assert len(names) == len(drawn)


@pytest.mark.parametrize("name", [order.name for order in ORDERS])
def test_a_figure_that_fails_is_a_sentence_in_its_place(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    left_out: list[str],
) -> None:
    def orders(_: Diagnosis) -> list[drawings.Order]:
        return [
            drawings.Order(each.name, faulty) if each.name == name else quick(each)
            for each in ORDERS
        ]

    monkeypatch.setattr(drawings, "orders", orders)
    stale = tmp_path / "out" / "figures" / f"{name}.svg"
    stale.parent.mkdir(parents=True)
    stale.write_text("of an earlier run")
    text = answered(tmp_path, monkeypatch, capsys)
    (sentence,) = left_out
    assert sentence.startswith(f"The figure {name} could not be made ({FAULT})")
    assert text.count(sentence) == 1
    drawn = {path.stem for path in stale.parent.iterdir()}
    assert drawn == {order.name for order in ORDERS} - {name}


def broken(builder: Callable[..., Section | None]) -> Callable[..., Section | None]:
    """The builder, whose template lacks everything."""

    @wraps(builder)
    def built(*_: object) -> Section:
        return Section(name_of(builder), "Its title", {})

    return built


@pytest.mark.parametrize("name", [name_of(builder) for builder in BUILDERS])
@pytest.mark.parametrize("fault", ["builder", "template"])
def test_a_section_that_fails_is_a_sentence_in_its_place(
    name: str,
    fault: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    left_out: list[str],
) -> None:
    spoilt = broken if fault == "template" else lambda builder: wraps(builder)(faulty)
    builders = tuple(spoilt(each) if name_of(each) == name else each for each in BUILDERS)
    monkeypatch.setattr("stiction.report.page.BUILDERS", builders)
    monkeypatch.setattr(drawings, "orders", lambda _: [quick(each) for each in ORDERS])
    text = answered(tmp_path, monkeypatch, capsys)
    (sentence,) = left_out
    assert sentence.startswith(f"The section {name} could not be made (")
    assert sentence in text


@pytest.mark.parametrize("part", ["drawings.orders", "page._section"])
def test_without_any_figure_or_the_page_itself_the_verdict_is_written(
    part: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    left_out: list[str],
) -> None:
    monkeypatch.setattr(drawings, "orders", lambda _: [quick(each) for each in ORDERS])
    monkeypatch.setattr(f"stiction.report.{part}", faulty)
    text = answered(tmp_path, monkeypatch, capsys)
    assert any(FAULT in sentence and sentence in text for sentence in left_out)


def fewer(view: View, number: int) -> View:
    """The view over so many stretches."""
    parts = {name: getattr(view, name)[:number] for name in ("at", "mean", "low", "high")}
    return replace(view, **parts)


def test_views_before_and_after_need_not_have_the_same_stretches_nor_coordinates() -> None:
    """A noisy effort is drawn over the modelled one, whose stretches move with the model."""
    found = diagnosis("missing_effect")
    assert found.pictures is not None
    before, after = found.pictures.before.views, found.pictures.after.views
    cut = replace(
        found.pictures,
        before=Rest(before[1:]),
        after=Rest(tuple(fewer(view, 20 - k) for k, view in enumerate(after))),
        causes=((before[0], fewer(after[0], 7)),),
    )
    found = replace(found, pictures=cut)
    (panel,) = figures.cause(found, 0).panels
    curves = {mark.label: mark.x for mark in panel.marks if isinstance(mark, Line)}
    assert max(curves["after"]) < max(curves["before"])
    assert len(figures.coordinates(found).panels) >= len(after)
    section = rest.build(found, {})
    assert section is not None
    assert len(section.content["rows"]) == len(after)


@pytest.mark.parametrize("arguments", [["simulate", "PLANT", "SESSION"], ["fit", "SESSION"]])
def test_a_figure_that_fails_ends_no_other_command(
    arguments: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    left_out: list[str],
) -> None:
    desk = Desk(tmp_path)
    for figure in ("plot.overlay", "plot.residual", "report.svg.text_of"):
        monkeypatch.setattr(f"stiction.{figure}", faulty)
    out = tmp_path / "out"
    stale = out / "run-free-run.svg"
    stale.parent.mkdir()
    stale.write_text("of an earlier run")
    paths = {"SESSION": str(desk.session), "PLANT": str(desk.plant)}
    given = [paths.get(word, word) for word in arguments]
    assert run([*given, "-o", str(out)]) == 0
    told = capsys.readouterr().out
    assert left_out
    if arguments[0] == "fit":
        assert {path.name for path in out.iterdir()} >= {
            "plant.toml",
            "begins.toml",
            "fit.json",
            "fit.html",
        }
        told = (out / "fit.html").read_text("utf-8")
    else:
        assert {path.name for path in out.iterdir()} == {"run-trajectory.csv"}
        assert "free run: position error" in told
    assert all(sentence in told for sentence in left_out)


def test_a_figure_of_a_plan_that_fails_leaves_the_signals(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, left_out: list[str]
) -> None:
    desk = Desk(tmp_path)
    monkeypatch.setattr("stiction.plan.result.Signal.plot", faulty)
    out = tmp_path / "out"
    assert run(["plan", str(desk.plant), "--only", "ramps", "-o", str(out)]) == 0
    assert {path.name for path in out.iterdir()} >= {"plan.json", "session.toml", "plant.toml"}
    signals = {path.suffix for path in (out / "signals").iterdir()}
    assert signals == {".csv"}
    assert all("figure of ramps" in sentence for sentence in left_out)


def test_a_figure_of_a_comparison_that_fails_leaves_the_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, left_out: list[str]
) -> None:
    monkeypatch.setattr("stiction.compare.page.law_figure", faulty)
    out = tmp_path / "out"
    arguments = ["compare", "coulomb", "--steps", "1000", "--draws", "0", "-o", str(out)]
    assert run(arguments) == 0
    (sentence,) = left_out
    assert sentence.startswith(f"The figure of coulomb could not be made ({FAULT})")
    assert sentence in (out / "compare.html").read_text("utf-8")
    assert json.loads((out / "compare.json").read_text("utf-8"))


def test_a_figure_of_the_paper_that_fails_leaves_its_numbers(
    tmp_path: Path, left_out: list[str]
) -> None:
    from stiction.cli.paper_sections import render_json, render_text, write_figure
    from stiction.paper import bearing_loops

    result = bearing_loops()
    section = write_figure(tmp_path, "bearing-loops", result, faulty)
    (sentence,) = left_out
    assert list(tmp_path.iterdir()) == []
    assert sentence in render_text([section])
    assert render_json([section])["experiments"][0]["not_drawn"] == sentence


@pytest.mark.parametrize("verb", ["diagnose", "fit"])
def test_where_no_file_can_be_written_the_answer_is_printed_all_the_same(
    verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    desk = Desk(tmp_path)
    monkeypatch.setattr("stiction.diagnosis.diagnose", lambda *_, **__: whole())
    for name in ("findings.json", "fit.json"):
        (tmp_path / "out" / name).mkdir(parents=True)
    assert run([verb, str(desk.session), "-o", str(tmp_path / "out"), "--json"]) == 2
    told = capsys.readouterr()
    assert told.err.count("\n") == 1
    assert "Is a directory" in told.err
    answer = json.loads(told.out)
    assert answer["sentence"] == whole().sentence if verb == "diagnose" else answer["parameters"]
