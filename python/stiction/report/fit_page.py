"""The page of a fit: what it says, how parameters hang together, a recording beside the plant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import resources
from typing import TYPE_CHECKING, Final

import numpy as np
from markupsafe import Markup, escape

from .._support.best_effort import Failure, attempt
from .._support.numbers import digits
from ..plant.begins import begin_of
from ..recording.names import names_of
from ..residual.effort import effort_residual, free_run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..fitting.result import FitResult
    from ..recording import Recording

__all__ = ["fit_page"]

STRONG: Final = 0.9
"""Correlation from which on two parameters are known better together than each by itself."""
MOST_PAIRS: Final = 10
"""Pairs of parameters that are told, the strongest first."""


def fit_page(result: FitResult, recordings: Sequence[Recording], title: str) -> str:
    """A page that needs no network: parameters with intervals, correlations, and figures.

    They show the first recording that tests, the first of all where none has that role: the effort
    along the measured motion, and the position of a simulation that starts once (free run); of a
    servo, simulated from its goal, the position alone.
    """
    style = resources.files("stiction.report").joinpath("templates/style.css").read_text("utf-8")
    index, shown = next(
        ((k, each) for k, each in enumerate(recordings) if each.role == "test"),
        (0, recordings[0]),
    )
    name = names_of(recordings)[index]
    table = _or_why("the table", lambda: Markup(result._repr_html_()))
    pairs = _or_why("the correlations", lambda: _correlations(result))
    figures = "".join(_figure(*each) for each in _figures(result, shown, name))
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        f"<title>{escape(title)}</title><style>{style}</style></head><body>"
        f"<h1>{escape(title)}</h1>"
        f'<div class="scroll">{table}</div>'
        f"<h2>Correlations</h2>{pairs}{figures}"
        "</body></html>\n"
    )


def _or_why(what: str, make: Callable[[], Markup]) -> Markup:
    """A part of the page; where it cannot be made, why."""
    made = attempt(f"{what} of the fit", make)
    if isinstance(made, Failure):
        return Markup(f'<p class="banner" role="note">{escape(made.sentence)}</p>')
    return made


def _correlations(result: FitResult) -> Markup:
    """The pairs of parameters whose estimates hang together most."""
    names = list(result.parameters)
    rows, columns = np.triu_indices(len(names), 1)
    values = np.asarray(result.correlations)[rows, columns]
    order = [k for k in np.argsort(-np.abs(values)) if np.isfinite(values[k])][:MOST_PAIRS]
    if not order:
        return Markup("<p>There are no two parameters whose correlation is known.</p>")
    strong = int(np.sum(np.abs(values) >= STRONG))
    told = (
        f"{strong} of {len(values)} pairs hang together strongly (0.9 or more): there the data "
        "tell a combination better than either value."
        if strong
        else "No two parameters hang together strongly (0.9 or more)."
    )
    cell = Markup(
        '<tr><th scope="row"><code>{}</code></th><td data-label="with"><code>{}</code></td>'
        '<td class="number" data-label="correlation">{}</td></tr>'
    )
    body = Markup("").join(
        cell.format(names[rows[k]], names[columns[k]], digits(float(values[k]), 2)) for k in order
    )
    return Markup(
        "<p>{}</p><table><thead><tr><th scope='col'>parameter</th><th scope='col'>with</th>"
        "<th scope='col'>correlation</th></tr></thead><tbody>{}</tbody></table>"
    ).format(told, body)


_Drawn = tuple[str, str, Callable[[], "Figure"]]
"""Name of a figure, what it shows, and how it is drawn."""


def _figures(result: FitResult, recording: Recording, name: str) -> list[_Drawn]:
    plant = result.plant

    def run() -> Figure:
        begin = {} if plant.servo else begin_of(result.begins.get(name))
        return free_run(plant, recording, **begin).plot()

    def along() -> Figure:
        begin = begin_of(result.begins.get(name))
        return effort_residual(plant.under(recording.settings), recording, **begin).plot()

    if plant.servo:
        what = "measured and simulated position, from the goal alone"
        return [("figure", f"{name}: {what}", run)]
    what = "measured effort, what the fitted plant needs, and what is left"
    found: list[_Drawn] = [("figure", f"{name}: {what}", along)]
    if not plant.prescribed_motion and recording.input is not None:
        what = "measured and simulated position, by the recorded input alone (free run)"
        found.append(("free run", f"{name}: {what}", run))
    return found


def _figure(what: str, label: str, make: Callable[[], Figure]) -> str:
    from .svg import inline, text_of

    prefix = f"fit-{what.replace(' ', '-')}"
    picture = _or_why(f"the {what}", lambda: inline(text_of(make()), prefix, label))
    return f"<figure>{picture}<figcaption>{escape(label)}.</figcaption></figure>"
