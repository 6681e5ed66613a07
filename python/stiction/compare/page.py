"""The table as a page: style and figures are in it, nothing is fetched."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import catalogue
from .figures import law_figure
from .result import Comparison

if TYPE_CHECKING:
    from markupsafe import Markup

__all__ = ["page", "table"]


def page(comparison: Comparison) -> str:
    """The text of compare.html."""
    from ..report.svg import inline, text_of

    records = {record.name: record for record in catalogue.laws()}
    figures = {
        row.law: inline(
            text_of(law_figure(records[row.law])),
            row.law,
            f"{row.law}: friction over displacement with an inner loop, and over speed.",
        )
        for row in comparison.rows
    }
    return _rendered(comparison, figures, whole=True)


def table(comparison: Comparison) -> str:
    """The table alone, as an element."""
    return _rendered(comparison, {}, whole=False)


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
