"""The table as text and as Markdown."""

from __future__ import annotations

from collections.abc import Iterator

from .result import CONDITIONAL, NO, UNDEFINED, YES, Comparison

__all__ = ["as_markdown", "as_text", "headings", "notes"]

_SHORT = {YES: "yes", NO: "no", CONDITIONAL: "cond", UNDEFINED: "–"}
_COST = "cost"


def as_text(comparison: Comparison) -> str:
    """Numbered columns, what the numbers mean, and where conditional properties hold."""
    heads = headings(comparison)
    width = max(len(row.law) for row in comparison.rows)
    columns = "".join(f"{index:>5}" for index in range(1, len(heads) + 1))
    lines = [f"{index:>2} {title}" for index, title in enumerate(heads, 1)]
    lines += ["", f"{'':<{width}}{columns}", *_rows(comparison, width)]
    lines += [
        "",
        "cond = conditional, – = not defined for this law. Passive: random motion of "
        f"{comparison.steps} steps for each case and each of {comparison.draws} drawn sets of "
        "parameters.",
    ]
    told = list(notes(comparison))
    if told:
        lines += ["", *(f"{law}, {title}: {note}" for law, title, note in told)]
    return "\n".join(lines)


def headings(comparison: Comparison) -> list[str]:
    """Titles of the columns; the last one is the cost."""
    return [
        *(each.title for each in comparison.properties),
        "cost of a step over that of coulomb in the same run (ns)",
    ]


def notes(comparison: Comparison) -> Iterator[tuple[str, str, str]]:
    """Law, property and where it holds, for all that are conditional."""
    for row in comparison.rows:
        for each in comparison.properties:
            cell = row.cells[each.name]
            if cell.verdict == CONDITIONAL:
                yield row.law, each.title, cell.note


def as_markdown(comparison: Comparison, *, cost: bool = True) -> str:
    """The table for a page; without the cost it is the same in every run."""
    heads = headings(comparison)
    shown = len(heads) if cost else len(heads) - 1
    lines = [f"{index}. {title}" for index, title in enumerate(heads[:shown], 1)]
    lines += ["", "| law | " + " | ".join(str(k + 1) for k in range(shown)) + " |"]
    lines.append("|---" * (shown + 1) + "|")
    for row in comparison.rows:
        cells = [_SHORT[row.cells[each.name].verdict] for each in comparison.properties]
        if cost:
            cells.append(f"{row.cost:.1f} ({row.cost_ns:.0f})")
        lines.append(f"| `{row.law}` | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _rows(comparison: Comparison, width: int) -> Iterator[str]:
    for row in comparison.rows:
        cells = "".join(
            f"{_SHORT[row.cells[each.name].verdict]:>5}" for each in comparison.properties
        )
        yield f"{row.law:<{width}}{cells}{row.cost:>6.1f} ({row.cost_ns:.0f})"
