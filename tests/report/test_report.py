"""Reports open anywhere, say all that was found, and look the same every time."""

from __future__ import annotations

import json
import os
import re
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path
from types import MappingProxyType
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.report.canned import (
    VERDICTS,
    diagnosis,
    model,
    parameter,
    pictures,
    plant,
    undrawn,
)

import stiction as st
from stiction._support.numbers import between, digits, percent, quantity, tick
from stiction.diagnosis.adequacy.omnibus import Rest
from stiction.diagnosis.data.gain import Gain
from stiction.diagnosis.records import CandidateRow, Verdict
from stiction.fitting.waves import waves_of
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect
from stiction.report import write
from stiction.report.figures import largest_views
from stiction.report.labels import shorten
from stiction.report.sections.parameters import rows_of_effect

LARGEST_REPORT = 5_000_000  # bytes; what an e-mail carries
HOSTILE = "<script>alert(1)</script>&\"' $x^2$ -->]]> \u202e名.csv"
VOID = {"meta", "br", "hr", "img", "link", "input", "wbr"}


class Page(HTMLParser):
    """Tags that balance, identifiers, addresses and the text in between."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.addresses: list[str] = []
        self.tags: list[str] = []
        self.scripts: list[tuple[dict[str, str | None], str]] = []
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag == "script":
            self.scripts.append((dict(attrs), ""))
        for name, value in attrs:
            assert not name.startswith("on"), f"{tag} runs {name}"
            if name == "id":
                self.ids.append(value or "")
            if name in ("src", "href", "xlink:href", "srcset", "action"):
                self.addresses.append(value or "")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, text: str) -> None:
        if self.open and self.open[-1] == "script":
            attributes, before = self.scripts.pop()
            self.scripts.append((attributes, before + text))
        else:
            self.text += text

    @property
    def running(self) -> list[str]:
        """Scripts that run: all others hold data."""
        return [text for attributes, text in self.scripts if "type" not in attributes]


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The report of each verdict."""
    folder = tmp_path_factory.mktemp("reports")
    return {verdict: write(diagnosis(verdict), folder / verdict) for verdict in VERDICTS}


@pytest.mark.parametrize("verdict", VERDICTS)
def test_report_opens_without_a_network(pages: dict[str, Path], verdict: Verdict) -> None:
    assert pages[verdict].name == "report.html"
    text = pages[verdict].read_text("utf-8")
    assert len(text.encode()) < LARGEST_REPORT
    page = Page(text)
    assert page.open == []
    assert len(page.ids) == len(set(page.ids))
    # What runs is named by its sum, and nothing else may be asked for or run.
    policy = re.findall(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', text)
    allowed = re.findall(r"'sha256-([^']*)'", policy[0])
    assert policy[0].startswith("default-src 'none'; ")
    sums = [b64encode(sha256(script.encode()).digest()).decode() for script in page.running]
    assert sums == allowed
    assert len(sums) == (2 if diagnosis(verdict).pictures else 0)
    assert "link" not in page.tags
    files = {path.relative_to(pages[verdict].parent).as_posix()
             for path in pages[verdict].parent.rglob("*")}  # fmt: skip
    for address in page.addresses:
        assert address.removeprefix("#") in page.ids if address[0] == "#" else address in files
    assert not re.search(r"https?:|@import|url\((?!#)", text)
    for used in re.findall(r"url\(#([^)]*)\)", text):
        assert used in page.ids
    assert '<html lang="en">' in text
    # A phone stacks the cells of a row: each says of what column it is.
    assert len(re.findall(r"<td[ >]", text)) == len(re.findall(r'<td data-label="[^"]', text))
    assert 'name="viewport" content="width=device-width' in text
    # An interval that does not fit beside its value goes under it, and is not cut off.
    assert "table.parameters td { flex-wrap: wrap" in text


@pytest.mark.parametrize("verdict", VERDICTS)
def test_report_says_all_that_was_found(pages: dict[str, Path], verdict: Verdict) -> None:
    found = diagnosis(verdict)
    text = Page(pages[verdict].read_text("utf-8")).text
    assert found.sentence in text
    for each in found.effects:
        for said in (each.name, each.means, each.try_, *each.look_alikes):
            assert said.replace("_", " ") in text.replace("_", " ")
        assert "0.0200" in text
        assert "0.0170 to 0.0230" in text
    if found.gain is not None:
        assert "41.2\u00a0%" in text
        assert "35.0 to 47.0\u00a0%" in text
    for row in found.candidates:
        assert row.name.replace("_", " ") in text
        assert row.reason in text
    for law in found.laws:
        assert law.law in text
        assert law.reason in text
    for left in found.unexplained:
        assert left.coordinate in text
        assert "34.0\u00a0%" in text
    for advice in found.advice:
        assert advice.experiment[1:] in text
        assert advice.reason in text
    for check in found.data["checks"]:
        assert check["what"] in text
    assert found.data["hashes"][0] in text
    for each in filter(None, (found.baseline, found.extended)):
        assert each.remarks[0] in text
        assert "at its lower bound" in text


@pytest.mark.parametrize("verdict", VERDICTS)
def test_files_beside_the_report_are_whole(pages: dict[str, Path], verdict: Verdict) -> None:
    folder = pages[verdict].parent
    found = diagnosis(verdict)
    assert json.loads((folder / "findings.json").read_text("utf-8")) == json.loads(found.to_json())
    assert st.Plant.load(folder / "plant.toml") == found.plant
    names = {"report.html", "findings.json", "plant.toml", "base.toml", "begins.toml", "figures"}
    assert {path.name for path in folder.iterdir()} == names
    figures = sorted(path.stem for path in (folder / "figures").iterdir())
    drawn = ["before-after", "candidates", "coordinates", "curves", "errors", "motion"]
    assert figures == ([] if found.pictures is None else
                       sorted([*drawn, *["cause-1-torque_bias"] * len(found.effects)]))  # fmt: skip
    for path in (folder / "figures").iterdir():
        root = ElementTree.parse(path).getroot()
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        assert not list(root.iter("{http://www.w3.org/2000/svg}image"))


def test_figures_in_the_page_are_named_for_those_who_do_not_see_them(
    pages: dict[str, Path],
) -> None:
    text = pages["missing_effect"].read_text("utf-8")
    drawings = re.findall(r"<svg[^>]*>", text)
    assert len(drawings) == 2 * 7 + 1  # each for screens and for phones, and the bar of the gain
    for drawing in drawings:
        assert 'role="img"' in drawing
        assert re.search(r'aria-label="[^"]{20,}"', drawing)


def test_same_diagnosis_gives_the_same_bytes(pages: dict[str, Path], tmp_path: Path) -> None:
    first = pages["missing_effect"].parent
    (tmp_path / "figures").mkdir()
    (tmp_path / "report.html").write_text("an earlier report")
    write(diagnosis("missing_effect"), tmp_path)
    files = [path.relative_to(first) for path in first.rglob("*") if path.is_file()]
    assert len(files) == 12
    for file in files:
        assert (tmp_path / file).read_bytes() == (first / file).read_bytes()


def test_names_of_files_cannot_break_the_page(tmp_path: Path) -> None:
    for verdict in ("unexplained", "data_fault"):
        path = write(diagnosis(verdict, name=HOSTILE), tmp_path / verdict)
        text = path.read_text("utf-8")
        page = Page(text)
        assert len(page.running) == (2 if verdict == "unexplained" else 0)
        assert not any("alert" in script for script in page.running)
        assert HOSTILE in page.text
        for attributes, told in page.scripts:
            if attributes.get("id") == "explorer-data":
                names = [each["name"] for each in json.loads(told)["recordings"]]
                assert names == [f"0 {HOSTILE}", f"1 {HOSTILE}"]
        for figure in (path.parent / "figures").glob("*.svg"):
            ElementTree.parse(figure)


def test_names_that_are_no_text_are_shown_by_their_bytes(tmp_path: Path) -> None:
    name = os.fsdecode(b"run\xff.csv")
    found = undrawn("nothing_missing", name=name)
    path = write(found, tmp_path)
    assert r"run\udcff.csv" in path.read_text("utf-8")
    findings = json.loads((tmp_path / "findings.json").read_text("utf-8"))
    assert findings["data"]["checks"][0]["recording"] == name


def test_an_interrupted_diagnosis_says_so_first(tmp_path: Path) -> None:
    found = replace(
        undrawn("missing_effect"),
        success=False,
        message="interrupted: this is the best so far",
    )
    text = Page(write(found, tmp_path).read_text("utf-8")).text
    told = text.index("Interrupted: this is the best so far")
    assert told < text.index(found.sentence)


def test_without_rows_to_test_on_no_gain_is_claimed(tmp_path: Path) -> None:
    whole = undrawn("missing_effect")
    found = replace(
        whole,
        gain=None,
        effects=(replace(whole.effects[0], gain=None),),
        baseline=model(effects=False, held_out=None),
        extended=model(effects=True, held_out=None),
    )
    text = Page(write(found, tmp_path).read_text("utf-8")).text
    assert "not measured" in text
    assert "on the rows fitted" in text


def test_a_refused_effect_that_scored_as_high_is_named_beside_the_cause(tmp_path: Path) -> None:
    whole = undrawn("missing_effect")
    rival = CandidateRow("direction_asymmetry", 0.5, 0.07, 0.3, "its gain is uncertain")
    found = replace(whole, candidates=(*whole.candidates, rival))
    text = Page(write(found, tmp_path).read_text("utf-8")).text
    assert "But direction asymmetry scored as high before being refused" in text
    assert "cogging scored" not in text


def test_what_is_refused_before_a_later_cause_is_found_is_no_rival_of_that(tmp_path: Path) -> None:
    whole = undrawn("missing_effect")
    later = replace(whole.effects[0], name="run_in", look_alikes=())
    rows = (
        CandidateRow("run_in", 0.01, 0.005, 0.3, "accepted"),
        CandidateRow("direction_asymmetry", 0.02, 0.01, 0.3, "its gain is uncertain"),
    )
    found = replace(whole, effects=(*whole.effects, later), candidates=(*whole.candidates, *rows))
    text = Page(write(found, tmp_path).read_text("utf-8")).text
    assert "scored as high" not in text


def test_a_cause_that_held_out_rows_speak_against_is_told_so(tmp_path: Path) -> None:
    whole = undrawn("missing_effect")
    lost = Gain(-1.76, (-3.16, -0.74))
    cause = replace(whole.effects[0], gain=lost)
    found = replace(whole, gain=lost, effects=(cause, *whole.effects[1:]))
    text = Page(write(found, tmp_path).read_text("utf-8")).text
    assert "these rows speak against it" in text
    assert "The whole interval is below 0" in text
    assert "reaches 0" not in text


def test_what_lost_to_another_cause_is_no_rival_of_this_one(tmp_path: Path) -> None:
    whole = undrawn("missing_effect")
    other = replace(whole.effects[0], name="frictional_lag", look_alikes=())
    lost = CandidateRow("direction_asymmetry", 0.9, 0.07, 0.3, "frictional_lag explains more")
    found = replace(whole, effects=(*whole.effects, other), candidates=(*whole.candidates, lost))
    text = Page(write(found, tmp_path).read_text("utf-8")).text
    # Its score is a share of another residual.
    assert "scored as high" not in text


def test_a_gain_that_may_be_nothing_is_not_praised(tmp_path: Path) -> None:
    found = replace(undrawn("missing_effect"), gain=Gain(0.03, (-0.4, 0.2)))
    text = Page(write(found, tmp_path).read_text("utf-8")).text
    assert "do not prove an improvement" in text
    assert "−40.0 to 20.0\u00a0%" in text


def test_a_second_report_leaves_nothing_of_the_first_but_what_is_not_its_own(
    tmp_path: Path,
) -> None:
    write(undrawn("missing_effect"), tmp_path)
    figures = tmp_path / "figures"
    for name in ("my own.svg", "cause-1-torque_bias.svg"):
        (figures / name).write_text("<svg/>")
    assert (figures / "candidates.svg").exists()
    write(diagnosis("data_fault"), tmp_path)
    assert [path.name for path in figures.iterdir()] == ["my own.svg"]


def test_what_stops_a_report_half_way_leaves_whole_files_and_the_numbers_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = diagnosis("data_fault")
    page = write(found, tmp_path).read_bytes()

    def stopped(*_: object) -> str:
        raise KeyboardInterrupt

    for stage in ("drawings.draw", "page.render"):
        monkeypatch.setattr(f"stiction.report.{stage}", stopped)
        seed = found.seed + len(stage)
        with pytest.raises(KeyboardInterrupt):
            write(replace(found, seed=seed), tmp_path)
        assert json.loads((tmp_path / "findings.json").read_text("utf-8"))["seed"] == seed
        assert (tmp_path / "report.html").read_bytes() == page
        assert {path.name for path in tmp_path.iterdir()} == {
            *("report.html", "findings.json", "plant.toml", "base.toml", "begins.toml", "figures")
        }
        monkeypatch.undo()


def test_a_file_in_place_of_the_folder_is_refused_in_a_sentence(tmp_path: Path) -> None:
    taken = tmp_path / "taken"
    taken.write_text("")
    with pytest.raises(st.InputError, match="cannot be made a folder"):
        write(diagnosis("data_fault"), taken)


def test_names_that_cannot_be_drawn_are_drawn_in_part() -> None:
    assert shorten("run.csv", 30) == "run.csv"
    assert shorten("$a$ 名\udcff\n\u202e", 30) == "$a$ 名???"
    assert shorten("a_long_name_of_a_recording.csv", 15) == "a_long_…ing.csv"


def test_a_headline_is_drawn_only_from_pictures() -> None:
    drawn = diagnosis("missing_effect").plot()
    assert len(drawn.axes) == 3
    assert len(diagnosis("nothing_missing").plot().axes) == 2
    with pytest.raises(st.InputError, match="nothing to draw"):
        diagnosis("data_fault").plot()
    assert all(panel.get_ylabel().endswith("N·m)") for panel in drawn.axes)
    assert drawn.axes[-1].get_xlabel() == "time in the recording (s)"


def test_a_wave_is_told_by_its_amplitude_and_by_the_order_that_was_chosen() -> None:
    record = next(each for each in st.effects() if each.name == "torque_constant_ripple")
    path = "effects.torque_constant_ripple"
    fitted = {
        f"{path}.cosine": parameter(0.03, 0.001, "1"),
        f"{path}.sine": parameter(0.0004, 0.001, "1"),
        f"{path}.cosine_2": parameter(0.0001, 0.001, "1"),
        f"{path}.sine_2": parameter(0.0002, 0.001, "1"),
    }
    waves = waves_of(fitted, np.diag([1e-6] * 4))
    del waves[f"{path}.amplitude_2"]
    values = {"cosine": 0.03, "sine": 0.0004, "order": 6.0, "order_2": 12.0}
    effect = Effect(
        record.name, MappingProxyType({name: Parameter(v) for name, v in values.items()})
    )
    machine = replace(plant(), effects=(effect,))
    rows = rows_of_effect(effect, fitted, waves, record, machine, "N·m")
    # The parts stand alone where a wave is not told as a whole.
    assert [row["name"] for row in rows] == [
        *("amplitude", "phase", "order"),
        *("cosine_2", "sine_2", "order_2"),
    ]
    first, phase, order = rows[:3]
    assert (first["value"], first["unit"]) == ("3.00", "%")
    assert (phase["value"], phase["unit"]) == ("0.013", "rad")
    assert (order["value"], order["unit"]) == ("6", "per turn")
    assert order["notes"] == ["chosen, not fitted"]
    assert rows[3]["notes"] == rows[4]["notes"] == ["not told from 0"]


def test_what_is_flat_everywhere_stands_in_the_table_alone() -> None:
    whole = pictures(effects=True, names=("a",))
    view = whole.after.views[0]
    flat = tuple(
        replace(
            view, coordinate=replace(view.coordinate, name=f"flat {k}"), share=0.001, threshold=1.0
        )
        for k in range(20)
    )
    after, before = Rest((*flat, *whole.after.views)), Rest((*whole.before.views, *flat))
    shown = largest_views(replace(whole, after=after, before=before))
    assert len(shown) == 12
    names = {each.coordinate.name for each in shown}
    assert {each.coordinate.name for each in whole.after.views} <= names


def test_numbers_have_as_many_digits_as_are_known() -> None:
    assert between(94.756, 93.455, 96.057) == ("94.8", "93.5 to 96.1")
    assert between(-0.0336, -0.066, -0.00112) == ("−0.034", "−0.066 to −0.001")
    assert between(2.1e-8, 1.9e-8, 2.3e-8) == ("2.10×10⁻⁸", "(1.90 to 2.30)×10⁻⁸")
    assert between(3.0, -np.inf, np.inf) == ("3.00", "not determined")
    assert between(0.0, 0.0, 0.0) == ("0.000", "0.000 to 0.000")
    assert digits(0.000123456) == "0.000123"
    assert digits(1234567.0) == "1.23×10⁶"
    assert digits(None) == digits(np.nan) == "not known"
    assert quantity(0.5, "1") == "0.500"
    assert percent(-0.0001) == "0.0\u00a0%"
    assert tick(1e-7) == "1×10⁻⁷"
    # Neighbours on an axis that begins far from 0 are told apart.
    assert tick(1.215e7) == "1.215×10⁷"
    assert tick(0.30000000000000004) == "0.3"


@pytest.mark.parametrize(
    ("share", "words"), [(0.1, "none counts"), (0.001, "No coordinate stands")]
)
def test_curves_above_noise_that_are_too_small_to_count_are_said_to_be(
    share: float, words: str, tmp_path: Path
) -> None:
    found = diagnosis("nothing_missing")
    assert found.pictures is not None
    views = tuple(
        replace(view, share=share, threshold=0.02, size=1e-5) for view in found.pictures.after.views
    )
    shown = replace(found.pictures, after=replace(found.pictures.after, views=views))
    page = replace(found, pictures=shown).save(tmp_path).read_text("utf-8")
    assert words in page
