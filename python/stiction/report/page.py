"""The page: its sections in order, and the template around them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from markupsafe import Markup, escape

from .._support.best_effort import Failure, attempt
from .explorer import explorer
from .sections import BUILDERS, Builder, name_of

if TYPE_CHECKING:
    from jinja2 import Environment

    from ..diagnosis.findings.result import Diagnosis
    from .drawings import Drawings

__all__ = ["render"]


@dataclass(frozen=True)
class _Rendered:
    """A section as an element of the page; ``kind`` is the class of the first one."""

    name: str
    title: str
    body: Markup
    kind: str = ""


def render(diagnosis: Diagnosis, drawings: Drawings, remarks: Sequence[str] = ()) -> str:
    """The text of report.html.

    Parameters
    ----------
    diagnosis : Diagnosis
    drawings : dict of str to Drawing
    remarks : sequence of str
        What could not be made, where no section says so.

    Returns
    -------
    str
        A whole page: style, figures and scripts are in it, and it asks for nothing else.
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
    found = [_section(builder, diagnosis, drawings, environment) for builder in BUILDERS]
    sections = [section for section in found if section is not None]
    # The section that would show a figure may not be there itself.
    unsaid = [
        each.failure
        for each in drawings.values()
        if each.failure and not any(escape(each.failure) in section.body for section in sections)
    ]
    walked = attempt("the panels that zoom", partial(explorer, diagnosis))
    if isinstance(walked, Failure):
        remarks, walked = [*remarks, walked.sentence], None
    page: str = environment.get_template("page.html").render(
        diagnosis=diagnosis,
        drawings=drawings,
        sections=sections,
        remarks=[*remarks, *unsaid],
        explorer=walked,
    )
    return page


def _section(
    builder: Builder, diagnosis: Diagnosis, drawings: Drawings, environment: Environment
) -> _Rendered | None:
    """A section; where it fails, its name and why, with the verdict where that is lost."""
    name = name_of(builder)
    made = attempt(
        f"the section {name}", partial(_built, builder, diagnosis, drawings, environment)
    )
    if not isinstance(made, Failure):
        return made
    first = builder is BUILDERS[0]
    verdict = f'<p class="sentence">{escape(diagnosis.sentence)}</p>\n' if first else ""
    body = Markup(f'{verdict}<p class="banner" role="note">{escape(made.sentence)}</p>')
    return _Rendered(name, name.capitalize(), body)


def _built(
    builder: Builder, diagnosis: Diagnosis, drawings: Drawings, environment: Environment
) -> _Rendered | None:
    section = builder(diagnosis, drawings)
    if section is None:
        return None
    body = environment.get_template(f"{section.name}.html").render(content=section.content)
    kind = str(section.content.get("verdict", ""))
    return _Rendered(section.name, section.title, Markup(label_cells(body)), kind)


def label_cells(page: str) -> str:
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
    words = re.split(r"(?<=[._])", path)
    return Markup("<wbr>").join(escape(word) for word in words)
