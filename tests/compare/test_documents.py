"""The table in words, as a page and in the documentation."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import stiction as st
from stiction.cli import run
from stiction.compare import compare
from stiction.compare.document import figure_line, fill, property_block, symptom_block, write
from stiction.compare.figures import law_figures, name_of
from stiction.errors import InputError

DOCS = Path(__file__).parents[2] / "docs"
LARGEST_FIGURE = 40_000  # bytes
REFRESH = "run: python -m stiction.compare docs"


def block(page, name):
    text = (DOCS / page).read_text("utf-8")
    return re.search(rf"<!-- {name} -->\n\n(.*)\n\n<!-- end of {name} -->", text, re.S)[1]


@pytest.mark.slow
def test_the_documented_table_is_what_the_command_prints(table):
    assert block("compare.md", "properties") == property_block(table), REFRESH


@pytest.mark.slow
def test_laws_by_symptom_follow_from_the_table(table):
    assert block("which-law.md", "symptoms") == symptom_block(table), REFRESH


@pytest.mark.parametrize("record", st.laws(), ids=lambda record: record.name)
def test_every_law_page_shows_the_figure_of_its_law(record):
    page = DOCS / "theory" / f"{record.name.replace('_', '-')}.md"
    assert page.exists()
    assert page.read_text("utf-8").count(figure_line(record.name)) == 1, REFRESH
    picture = DOCS / "figures" / name_of(record.name)
    assert picture.read_bytes().startswith(b"\x89PNG"), REFRESH
    assert picture.stat().st_size <= LARGEST_FIGURE


def test_figures_are_the_same_each_time(tmp_path):
    (tmp_path / "one").mkdir()
    (tmp_path / "other").mkdir()
    one, other = law_figures(tmp_path / "one"), law_figures(tmp_path / "other")
    assert [p.name for p in one] == [name_of(record.name) for record in st.laws()]
    for a, b in zip(one, other, strict=True):
        assert a.read_bytes() == b.read_bytes()


@pytest.mark.slow
def test_refreshing_twice_changes_nothing_but_the_cost(table, tmp_path):
    (tmp_path / "theory").mkdir()
    (tmp_path / "figures").mkdir()
    for name in ("compare.md", "which-law.md", "theory/coulomb.md"):
        (tmp_path / name).write_text((DOCS / name).read_text("utf-8"), encoding="utf-8")
    write(tmp_path, table)
    once = (tmp_path / "theory/coulomb.md").read_text("utf-8")
    write(tmp_path, table)
    assert (tmp_path / "theory/coulomb.md").read_text("utf-8") == once
    assert once.count("law-coulomb.png") == 1


def test_a_page_without_marks_is_refused():
    with pytest.raises(InputError, match=r"page\.md"):
        fill("no marks", "table", "x", Path("page.md"))


def test_the_command_prints_text_or_json_and_writes_a_page(tmp_path, capsys):
    few = ["compare", "coulomb", "maxwell_slip", "--steps", "2000", "--draws", "2"]
    assert run([*few, "-o", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert re.search(r"^coulomb .* yes .* 1\.0 \(\d+\)$", text, re.M)
    assert "14 passive" in text
    page = (tmp_path / "compare.html").read_text("utf-8")
    # A phone stacks the cells of a row: each says of what column it is.
    assert page.count("<td") == len(re.findall(r'<td data-label="[^"]', page))
    assert page.count("<svg") == 2
    assert "http" not in re.sub(r'xmlns(:\w+)?="[^"]*"', "", page)
    assert "<script" not in page
    assert json.loads((tmp_path / "compare.json").read_text("utf-8"))["laws"][0]["law"] == "coulomb"
    assert run([*few, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    cell = data["laws"][1]["properties"]["reverse_points_recovered"]
    assert cell["verdict"] == "yes"
    assert cell["cases"]["defaults"]["numbers"]
    assert {p["criterion"] for p in data["properties"]}


def test_the_command_refuses_an_unknown_law(capsys):
    assert run(["compare", "coulom"]) == 2
    assert "did you mean 'coulomb'" in capsys.readouterr().err


def test_a_table_shows_itself_in_a_notebook():
    html = compare(["coulomb"], steps=1000, draws=1)._repr_html_()
    assert html.startswith("<div")
    assert html.count('<th scope="row">') == 1
