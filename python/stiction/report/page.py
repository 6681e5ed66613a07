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
    return page


def _breakable(path: str) -> Markup:
    """A path of a parameter that may break behind its dots and underscores."""
    from markupsafe import Markup, escape

    words = re.split(r"(?<=[._])", path)
    return Markup("<wbr>").join(escape(word) for word in words)
