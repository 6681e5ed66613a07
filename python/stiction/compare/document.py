"""The pages of the documentation that show what the comparison found."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from .. import catalogue
from .._support.atomic_files import write_text
from ..errors import InputError
from .figures import law_figures, name_of
from .result import CONDITIONAL, YES, Comparison
from .text import as_markdown, notes

__all__ = ["SYMPTOMS", "figure_line", "fill", "property_block", "symptom_block", "write"]

SYMPTOMS: Final[tuple[tuple[str, tuple[str, ...]], ...]] = (
    ("It creeps under a held force, ever more slowly, and stops.", ("creep_that_stops",)),
    (
        "The first push leaves a permanent displacement, the next ones, to either side, do not.",
        ("isotropic_hardening",),
    ),
    (
        "Small motion to and fro makes loops; inner loops close and leave no trace.",
        ("reverse_points_recovered", "loops_wiped_out"),
    ),
    (
        "Loops have the same shape wherever they lie.",
        ("congruent_branches",),
    ),
    ("Before it slides it rings like a spring.", ("linear_near_reversal",)),
    ("It has to stay where it is under a load, for an hour.", ("holds_still",)),
    ("Vibration on top of a load must not make it drift.", ("no_ratcheting",)),
    (
        "Friction is computed along positions that an encoder measured.",
        ("survives_noise",),
    ),
    ("Pushed fast, it lets go earlier than pushed slowly.", ("breakaway_falls_with_rate",)),
    ("Friction follows a change of speed late.", ("frictional_lag",)),
    ("It sticks and slips at low speed: friction falls as speed rises.", ("stribeck",)),
    ("It must never put energy into the machine, whatever the parameters.", ("passive",)),
    (
        "Positioning to less than the pre-sliding distance, under load, for minutes.",
        ("reverse_points_recovered", "holds_still", "no_ratcheting"),
    ),
    (
        "The same, and it creeps.",
        ("creep_that_stops", "reverse_points_recovered", "holds_still", "no_ratcheting"),
    ),
    (
        "Both: loops before the slide, and stick-slip.",
        ("reverse_points_recovered", "stribeck"),
    ),
)
"""What a machine shows, and the properties that a law needs for it."""


def write(docs: Path, comparison: Comparison) -> list[Path]:
    """Refresh compare.md, which-law.md, the figures of the laws and their lines in the pages.

    Parameters
    ----------
    docs : Path
        The folder of the documentation.
    comparison : Comparison
        Of all laws.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    InputError
        A page without the marks that enclose what is written.
    """
    pages = {
        docs / "compare.md": {
            "properties": property_block(comparison),
            "conditions": _condition_block(comparison),
            "criteria": _criterion_block(comparison),
            "cost": _cost_block(comparison),
        },
        docs / "which-law.md": {"symptoms": symptom_block(comparison)},
    }
    for path, blocks in pages.items():
        text = path.read_text("utf-8")
        for name, block in blocks.items():
            text = fill(text, name, block, path)
        write_text(path, text)
    return [*pages, *law_figures(docs / "figures"), *_lines(docs)]


def fill(text: str, name: str, block: str, path: Path) -> str:
    """A page with what stands between two marks replaced."""
    opening, closing = f"<!-- {name} -->", f"<!-- end of {name} -->"
    if text.count(opening) != 1 or text.count(closing) != 1:
        raise InputError(f"{path}: the marks {opening} and {closing} must each stand there once")
    before, _, rest = text.partition(opening)
    after = rest.partition(closing)[2]
    return f"{before}{opening}\n\n{block}\n\n{closing}{after}"


def property_block(comparison: Comparison) -> str:
    """The table, without what differs from run to run."""
    return as_markdown(comparison, cost=False)


def symptom_block(comparison: Comparison) -> str:
    """Symptoms and the laws that show them."""
    lines = ["| what the machine does | laws | under conditions |", "|---|---|---|"]
    for symptom, needed in SYMPTOMS:
        sure, perhaps = [], []
        for row in comparison.rows:
            verdicts = {row.cells[name].verdict for name in needed}
            if verdicts == {YES}:
                sure.append(row.law)
            elif verdicts <= {YES, CONDITIONAL}:
                perhaps.append(row.law)
        lines.append(f"| {symptom} | {_named(sure)} | {_named(perhaps)} |")
    return "\n".join(lines)


def figure_line(law: str) -> str:
    """What shows the figure of a law in its page."""
    return (
        f"![Left: friction of {law} over displacement that turns round, with an inner loop. Right: "
        f"over speed that rises and falls, slowly and fast.](../figures/{name_of(law)})"
    )


def _condition_block(comparison: Comparison) -> str:
    return "\n".join(f"* `{law}`, {title}: {note}." for law, title, note in notes(comparison))


def _criterion_block(comparison: Comparison) -> str:
    return "\n".join(
        f"{index}. **{each.title}.** {each.question} {each.criterion}"
        for index, each in enumerate(comparison.properties, 1)
    )


def _cost_block(comparison: Comparison) -> str:
    lines = ["| law | times `coulomb` | ns a step |", "|---|---|---|"]
    lines += [
        f"| `{row.law}` | {row.cost:.1f} | {row.cost_ns:.0f} |"
        for row in sorted(comparison.rows, key=lambda row: row.cost)
    ]
    return "\n".join(lines)


def _lines(docs: Path) -> Iterator[Path]:
    """Put the figure of each law under the heading of its page, once."""
    for record in catalogue.laws():
        page = docs / "theory" / f"{record.name.replace('_', '-')}.md"
        if not page.exists():
            continue
        text = page.read_text("utf-8")
        bare = re.sub(
            rf"\n!\[[^\]]*\]\(\.\./figures/{re.escape(name_of(record.name))}\)\n", "", text
        )
        heading, _, rest = bare.partition("\n")
        write_text(page, f"{heading}\n\n{figure_line(record.name)}\n{rest}")
        yield page


def _named(laws: list[str]) -> str:
    return ", ".join(f"`{law}`" for law in laws) or "–"
