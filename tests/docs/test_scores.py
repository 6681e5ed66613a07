"""The page of scores shows its data, and the data are consistent."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from docs.site.scores import with_tables

from stiction.bench.rates import wilson

DOCS = Path(__file__).parents[2] / "docs"
SCORES = tomllib.loads((DOCS / "scores.toml").read_text("utf-8"))
MOST_LINES = 120


def test_tables_of_the_page_are_those_of_the_data() -> None:
    page = (DOCS / "diagnosis-scores.md").read_text("utf-8")
    assert with_tables(page, SCORES) == page, "python -m docs.site.scores"
    assert all(f"<!-- scores: {table['name']} -->" in page for table in SCORES["table"])
    assert page.count("\n") <= MOST_LINES


@pytest.mark.parametrize("count", SCORES["count"], ids=lambda count: count["id"])
def test_a_count_says_its_code_and_seeds_and_its_intervals_hold(count: dict) -> None:
    assert count["code"]
    assert count["seeds"]
    for group in count["group"]:
        rows = group.get("rows", [])
        assert len({row[0] for row in rows}) == len(rows)
        for measure, number, of, low, high in rows:
            ends = [100.0 * end for end in wilson(number, of)]
            assert [low, high] == pytest.approx(ends, abs=0.06), measure
