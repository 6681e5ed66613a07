"""The page: its sections in order, and the template around them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from .sections import BUILDERS

if TYPE_CHECKING:
    from markupsafe import Markup

    from ..diagnosis.result import Diagnosis
    from .drawings import Drawings

__all__ = ["render"]


def render(diagnosis: Diagnosis, drawings: Drawings) -> str:
    """The text of report.html.

    Parameters
    ----------
    diagnosis : Diagnosis
    drawings : dict of str to Drawing

    Returns
    -------
    str
        A whole page: style and figures are in it, and it has no script.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("stiction.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["breakable"] = _breakable
    built = (builder(diagnosis, drawings) for builder in BUILDERS)
    sections = [section for section in built if section is not None]
    page: str = environment.get_template("page.html").render(
        diagnosis=diagnosis, drawings=drawings, sections=sections
    )
    return labelled(page)


def labelled(page: str) -> str:
    """A page whose cells carry the words of their column, for a phone stacks them."""

    def table(found: re.Match[str]) -> str:
        text = found.group(0)
        heads = [_TAG.sub("", head) for head in _HEAD.findall(text)][1:]

        def row(match: re.Match[str]) -> str:
            names = iter(heads)
            return _CELL.sub(lambda _: f'<td data-label="{next(names, "")}"', match.group(0))

        return _ROW.sub(row, text)

    return _TABLE.sub(table, page)


_TABLE = re.compile(r"<table.*?</table>", re.DOTALL)
_ROW = re.compile(r"<tr.*?</tr>", re.DOTALL)
_HEAD = re.compile(r'<th scope="col">(.*?)</th>', re.DOTALL)
_CELL = re.compile(r"<td(?=[ >])")
_TAG = re.compile(r"<[^>]*>")


def _breakable(path: str) -> Markup:
    """A path of a parameter that may break behind its dots and underscores."""
    from markupsafe import Markup, escape

    words = re.split(r"(?<=[._])", path)
    return Markup("<wbr>").join(escape(word) for word in words)
