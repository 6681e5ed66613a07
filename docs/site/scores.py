"""``python -m docs.site.scores``: the tables of docs/diagnosis-scores.md, from scores.toml."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any, Final

from stiction.bench.rates import wilson

from .files import written

__all__ = ["with_tables"]

DOCS: Final = Path(__file__).parents[1]
PAGE: Final = DOCS / "diagnosis-scores.md"
PLACE: Final = re.compile(r"(<!-- scores: (.+?) -->\n)(?:\|.*\n)*")
"""Where a table stands, by its name, and what is there."""

Counts = dict[tuple[str, str, str], tuple[int, int]]


def with_tables(page: str, scores: dict[str, Any]) -> str:
    """The page with each table made anew.

    Parameters
    ----------
    page : str
        Markdown, with a comment ``<!-- scores: NAME -->`` before each table.
    scores : dict
        What scores.toml holds.

    Raises
    ------
    KeyError
        A table, or a row that one names, is not there.
    """
    counts: Counts = {
        (count["id"], group["sessions"], measure): (number, of)
        for count in scores["count"]
        for group in count["group"]
        for measure, number, of, *_ in group.get("rows", ())
    }
    tables = {table["name"]: table for table in scores["table"]}
    return PLACE.sub(lambda place: place[1] + _table(tables[place[2]], counts), page)


def _table(table: dict[str, Any], counts: Counts) -> str:
    rows = [table["columns"], ["---"] * len(table["columns"])]
    rows += [[_cell(cell, counts) for cell in row] for row in table["rows"]]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def _cell(cell: str | list[str], counts: Counts) -> str:
    """Words as they are; of rows their sum, with its 95 % interval, and a dash for none."""
    if isinstance(cell, str):
        return cell
    if not cell:
        return "–"
    found = [counts[tuple(row.split(" | "))] for row in cell]  # type: ignore[index]
    number, of = (sum(each) for each in zip(*found, strict=True))
    low, high = (100.0 * end for end in wilson(number, of))
    return f"{number}/{of} ({low:.0f}–{high:.0f} %)"


def main() -> None:
    """Writes the page where a table changed."""
    scores = tomllib.loads((DOCS / "scores.toml").read_text("utf-8"))
    written(PAGE, with_tables(PAGE.read_text("utf-8"), scores))


if __name__ == "__main__":
    main()
