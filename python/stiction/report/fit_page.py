"""The page of a fit: what it says, and a recording beside the fitted plant."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from importlib import resources
from typing import TYPE_CHECKING

from markupsafe import Markup, escape

from ..best_effort import Failure, attempt
from ..recording.names import names_of
from ..residual import effort_residual, free_run

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..fitting.result import FitResult
    from ..recording import Recording

__all__ = ["fit_page"]


def fit_page(result: FitResult, recordings: Sequence[Recording], title: str) -> str:
    """A page that needs no network: sentences, parameters with intervals, and one figure.

    The figure shows the first recording that tests, of a servo simulated from its goal, of other
    machines by the effort along the measured motion; the first of all where none has that role.
    """
    style = resources.files("stiction.report").joinpath("templates/style.css").read_text("utf-8")
    index, shown = next(
        ((k, each) for k, each in enumerate(recordings) if each.role == "test"),
        (0, recordings[0]),
    )
    servo = result.plant.servo
    what = (
        "measured and simulated position, from the goal alone"
        if servo
        else "measured effort, what the fitted plant needs, and what is left"
    )
    label = f"{names_of(recordings)[index]}: {what}"
    table = _or_why("the table", lambda: Markup(result._repr_html_()))
    picture = _or_why("the figure", lambda: _picture(result, shown, label))
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{style}</style></head><body>"
        f"<h1>{escape(title)}</h1>"
        f'<div class="scroll">{table}</div>'
        f"<figure>{picture}<figcaption>{escape(label)}.</figcaption></figure>"
        "</body></html>\n"
    )


def _or_why(what: str, make: Callable[[], Markup]) -> Markup:
    """A part of the page; where it cannot be made, why."""
    made = attempt(f"{what} of the fit", make)
    if isinstance(made, Failure):
        return Markup(f'<p class="banner" role="note">{escape(made.sentence)}</p>')
    return made


def _picture(result: FitResult, recording: Recording, label: str) -> Markup:
    from .svg import inline, text_of

    return inline(text_of(_drawn(result, recording)), "fit", label)


def _drawn(result: FitResult, recording: Recording) -> Figure:
    plant = result.plant
    if plant.servo:
        return free_run(plant, recording).plot()
    return effort_residual(plant.under(recording.settings), recording).plot()
