"""Figures as SVG that lives inside a page."""

from __future__ import annotations

import re
from html import escape
from io import StringIO
from typing import TYPE_CHECKING, Final

from markupsafe import Markup

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["inline", "text_of"]

_NOISE: Final = re.compile(r"<metadata>.*?</metadata>|<!--.*?-->", re.S)
_OPENING: Final = re.compile(r"<svg\b[^>]*>")
_BOX: Final = re.compile(r'viewBox="[^"]*"')
_NAMED: Final = re.compile(r'(\bid="|\bhref="#|url\(#)')
_DRAWN: Final = re.compile(r'\b(d|x|y)="([^"]*)"')
# Hundredths of a point are finer than any screen or printer.
_FINE: Final = re.compile(r"(\.\d\d)\d+")


def text_of(figure: Figure) -> str:
    """A figure as SVG text, the same text for the same figure."""
    import matplotlib

    target = StringIO()
    # Dates and random identifiers would make each text differ from the last.
    with matplotlib.rc_context({"svg.hashsalt": "stiction", "svg.fonttype": "path"}):
        figure.savefig(target, format="svg", metadata={"Date": None})
    return target.getvalue()


def inline(svg: str, prefix: str, label: str) -> Markup:
    """SVG text as an element of a page.

    Parameters
    ----------
    svg : str
        As matplotlib writes it.
    prefix : str
        Goes before every identifier: those of several figures in one page must differ.
    label : str
        What the figure shows, for those who cannot see it.

    Returns
    -------
    Markup
        Without declarations, addresses of namespaces, comments and needless decimals.
    """
    body = _NOISE.sub("", svg[svg.index("<svg") :]).replace("xlink:href=", "href=")
    box = _BOX.search(body)
    opening = f'<svg {box[0] if box else ""} role="img" aria-label="{escape(label)}">'
    # First the identifiers, then the opening: the label is text and stays as it is.
    body = _NAMED.sub(rf"\g<1>{prefix}-", body)
    body = _DRAWN.sub(_rounded, body)
    body = _OPENING.sub(lambda _: opening, body, count=1)
    return Markup(re.sub(r"\n\s*", "\n", body).strip())


def _rounded(drawn: re.Match[str]) -> str:
    return f'{drawn[1]}="{_FINE.sub(_kept, drawn[2])}"'


def _kept(decimals: re.Match[str]) -> str:
    return decimals[1]
