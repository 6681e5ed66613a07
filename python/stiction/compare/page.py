"""The table as a page: style and figures are in it, nothing is fetched."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import catalogue
from .._support.best_effort import Failure, attempt
from .figures import law_figure
from .result import Comparison

if TYPE_CHECKING:
    from markupsafe import Markup

    from ..catalogue import LawRecord

__all__ = ["page", "table"]


def page(comparison: Comparison) -> str:
    """The text of compare.html."""
    records = {record.name: record for record in catalogue.laws()}
    figures = {row.law: _figure(records[row.law]) for row in comparison.rows}
    return _rendered(comparison, figures, whole=True)


def table(comparison: Comparison) -> str:
    """The table alone, as an element."""
    return _rendered(comparison, {}, whole=False)


def _figure(record: LawRecord) -> Markup:
    """The figure of a law; where it cannot be drawn, why."""
    from markupsafe import Markup, escape

    from ..report.svg import inline, text_of

    def drawn() -> Markup:
        label = f"{record.name}: friction over displacement with an inner loop, and over speed."
        return inline(text_of(law_figure(record)), record.name, label)

    made = attempt(f"the figure of {record.name}", drawn)
    if isinstance(made, Failure):
        return Markup(f'<p class="banner" role="note">{escape(made.sentence)}</p>')
    return made


def _rendered(comparison: Comparison, figures: dict[str, Markup], *, whole: bool) -> str:
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=ChoiceLoader([PackageLoader("stiction.compare"), PackageLoader("stiction.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    template = environment.get_template("compare.html")
    rendered: str = template.render(comparison=comparison, figures=figures, whole=whole)
    return rendered.strip() + "\n"
