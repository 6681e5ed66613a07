"""The site has what it promises; that it builds without a dead link, `make site` checks."""

from __future__ import annotations

import os
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from docs.site.check import complaints
from docs.site.doc_comments import comment_of
from docs.site.effect_figure import effect_figure
from docs.site.examples import effect_example, law_example, printed
from docs.site.excerpts import main_text, write_excerpts
from docs.site.gallery import effect_page, law_page
from docs.site.pictures import draw
from docs.site.reference import documented
from docs.site.stage import relinked
from PIL import Image
from tests.report.browser import chromium, opened

import stiction as st
from stiction.compare.figures import law_figures

REPOSITORY = Path(__file__).parents[2]
LAWS, EFFECTS = st.laws(), st.effects()


@pytest.mark.parametrize("record", LAWS, ids=lambda each: each.name)
def test_every_law_has_equation_source_and_an_example_that_prints(record) -> None:
    comment = comment_of("law", record.name)
    assert comment.equation
    assert comment.source
    assert printed(law_example(record)).startswith("friction between")
    page = law_page(record, REPOSITORY / "docs")
    assert all(f"| `{each.name}` |" in page for each in record.parameters)


@pytest.mark.parametrize("record", EFFECTS, ids=lambda each: each.name)
def test_every_effect_has_equation_source_and_an_example_in_which_it_acts(record) -> None:
    comment = comment_of("effect", record.name)
    assert comment.equation
    assert comment.source
    found = re.search(r"off by ([\d.e+-]+) mrad", printed(effect_example(record)))
    assert found is not None
    assert float(found[1]) > 0.0
    page = effect_page(record)
    assert all(f"| `{each.name}` |" in page for each in record.parameters)


@pytest.mark.parametrize("record", EFFECTS, ids=lambda each: each.name)
def test_every_effect_shows_in_its_figure(record) -> None:
    over_time, own = effect_figure(record).axes
    for panel in (over_time, own):
        heights = [abs(y) for line in panel.lines for y in line.get_ydata() if y == y]
        assert max(heights) > 1e-6


def test_what_examples_import_is_in_the_reference() -> None:
    assert {"stiction", "stiction.plan", "stiction.robot", "stiction.mujoco"} <= set(documented())


def test_the_table_of_extras_is_that_of_the_package() -> None:
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))["project"]
    extras = {
        name: ", ".join(sorted(re.split(r"[>=<]", each)[0] for each in needed))
        for name, needed in project["optional-dependencies"].items()
    }
    page = (REPOSITORY / "docs" / "install.md").read_text("utf-8")
    told = dict(re.findall(r"^\| `(\w+)` \| .* \| ([^|]*) \|$", page, re.M))
    assert told == extras | {"dev": "see `pyproject.toml`"}


def test_links_lead_to_where_pages_stand_on_the_site() -> None:
    page = REPOSITORY / "docs" / "theory" / "lugre.md"
    place = Path("theory/lugre.md")
    text = "[a](../plan.md#x) [b](../../README.md) [c](https://example.org) [Tests](../../tests)"
    assert relinked(text, page, place) == (
        "[a](../plan.md#x) [b](../project/README.md) [c](https://example.org) Tests (`tests`)"
    )


LIKENESS = 0.5
"""Grey levels of 255 by which a picture may differ in the mean; the two laws most alike: 0.9."""


def grey(picture: Image.Image) -> np.ndarray:
    return np.asarray(picture.convert("L").resize((200, 100)), dtype=float)


@pytest.mark.slow
def test_pictures_in_the_repository_are_those_of_this_version(tmp_path: Path) -> None:
    for folder, make in (("laws", law_figures), ("pages", draw)):
        (tmp_path / folder).mkdir()
        for path in make(tmp_path / folder):
            kept = REPOSITORY / "docs" / "figures" / path.name
            with Image.open(path) as new, Image.open(kept) as old:
                assert np.abs(np.subtract(new.size, old.size)).max() <= 4, path.name
                apart = np.abs(grey(new) - grey(old)).mean()
            assert apart < LIKENESS, f"{path.name} is stale: python -m docs.site.pictures"


def test_a_dead_link_and_a_load_from_the_network_are_found(tmp_path: Path) -> None:
    (tmp_path / "searchindex.js").write_text("{}")
    (tmp_path / "a.html").write_text(
        '<a href="gone.html">x</a><a href="#nowhere">y</a><img src="https://example.org/p.png">'
    )
    said = [each for each in complaints(tmp_path) if each.startswith("a.html")]
    assert said == [
        "a.html: gone.html leads nowhere",
        "a.html: #nowhere: no such place on that page",
        "a.html: loads https://example.org/p.png from the network",
    ]


PAGE = (
    '<nav>menu</nav><article role="main"><h1>Lu<em>Gre</em><a class="headerlink">¶</a></h1>'
    "<p>one<br>two<img src='x.png'></p><script>var three;</script></article><p>foot</p>"
)


def test_the_search_has_the_words_of_a_page_without_its_menus() -> None:
    assert main_text(PAGE) == "Lu Gre one two"


def test_the_search_shows_excerpts_where_the_site_is_opened_from_a_disk(tmp_path: Path) -> None:
    program = chromium()
    if program is None or os.name == "nt":
        pytest.skip("no Chromium is installed that a pipe can drive")
    (tmp_path / "theory").mkdir()
    (tmp_path / "theory" / "lugre.html").write_text(PAGE, "utf-8")
    script = (REPOSITORY / "docs" / "site" / "static" / "offline-search.js").read_text("utf-8")
    search = tmp_path / "search.html"
    search.write_text(
        f'<!doctype html><html data-content_root="./"><head></head><script>{script}</script></html>'
    )
    write_excerpts(tmp_path)
    with opened(program, tmp_path / "profile") as browser:
        browser.open(search)
        found = browser.run("fetch('./theory/lugre.html').then(answer => answer.text())")
        assert found == '<div role="main">Lu Gre one two</div>'
        assert browser.complaints == []
