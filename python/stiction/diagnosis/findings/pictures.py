"""What the figures of a diagnosis are drawn from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from ..._support.arrays import FloatArray
from ...errors import InputError
from ..adequacy.omnibus import Rest
from ..adequacy.view import View

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...plot import Panels
    from .result import Diagnosis

__all__ = ["ROLES", "Pictures", "Stretch", "Trace", "Tracking", "before_and_after"]

ROLES: Final = ("", "train", "select", "test")
"""What a row was used for, by its number; the first are left out: the warm-up, gaps, disturbances
from outside."""


@dataclass(frozen=True)
class Stretch:
    """A recording's rows that test, with what both models leave.

    Attributes
    ----------
    name : str
    time, measured, before, after : numpy.ndarray, shape (n,)
        s, measured effort (of a servo its position, rad or m), and residuals in effort; NaN between
        rows that do not belong together.
    """

    name: str
    time: FloatArray
    measured: FloatArray
    before: FloatArray
    after: FloatArray


@dataclass(frozen=True)
class Tracking:
    """A recording under its controller, measured and simulated by both models.

    Attributes
    ----------
    name : str
    time, measured, before, after : numpy.ndarray, shape (n,)
        s, and position less reference, rad or m; NaN in rows that are used otherwise.
    """

    name: str
    time: FloatArray
    measured: FloatArray
    before: FloatArray
    after: FloatArray

    @property
    def error_before(self) -> FloatArray:
        """Measured less simulated position, before."""
        return self.measured - self.before

    @property
    def error_after(self) -> FloatArray:
        """Measured less simulated position, after."""
        return self.measured - self.after


@dataclass(frozen=True)
class Trace:
    """A whole recording, what both models leave of it, and where they would take it.

    Attributes
    ----------
    name : str
    time : numpy.ndarray, shape (n,)
        s since its first row, rising.
    position, velocity : numpy.ndarray, shape (n,)
        rad or m, and per s.
    effort, inertial : numpy.ndarray, shape (n,)
        Measured effort, and what of it accelerates the inertia of the extended plant.
    before, after : numpy.ndarray, shape (n,)
        Residuals, in effort.
    role : numpy.ndarray of int, shape (n,)
        Places in ``ROLES``.
    simulated : tuple of numpy.ndarray, or None
        Position by the baseline and by the extended plant, shape (n,) each, started once and left
        alone; None where nothing can be simulated.
    loop : bool
        Whether that was under its controller; otherwise by the recorded input alone.
    contributions : Mapping of str to numpy.ndarray
        By effect: how much of the residual goes when it is added, shape (n,) each.
    step : float
        Positions that are nearer than this are not told apart, rad or m.
    """

    name: str
    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    effort: FloatArray
    inertial: FloatArray
    before: FloatArray
    after: FloatArray
    role: np.ndarray
    simulated: tuple[FloatArray, FloatArray] | None = None
    loop: bool = False
    contributions: Mapping[str, FloatArray] = field(default_factory=dict)
    step: float = 0.0

    @property
    def tests(self) -> np.ndarray:
        """Which rows test; shape (n,)."""
        return np.asarray(self.role == ROLES.index("test"))


@dataclass(frozen=True)
class Pictures:
    """What the figures show.

    Attributes
    ----------
    stretches : tuple of Stretch
        Held-out recordings, the one with the largest improvement first.
    before, after : Rest
        Residual in every coordinate, of the baseline and of the extended plant.
    causes : tuple of (View, View)
        Of each cause its own coordinate: what the model with the causes above it leaves, and what
        it leaves with this one too.
    effort_unit, position_unit : str
    floor : float
        rms that noise alone would leave, N·m or N.
    effort_name : str
        What an axis calls the effort: nobody measures that of a servo.
    tracking : Tracking or None
        The held-out recording with the largest improvement in closed loop; None where no loop was
        replayed.
    traces : tuple of Trace
        All recordings, in their order.
    """

    stretches: tuple[Stretch, ...]
    before: Rest
    after: Rest
    effort_unit: str
    position_unit: str
    floor: float
    causes: tuple[tuple[View, View], ...] = ()
    effort_name: str = "measured effort"
    tracking: Tracking | None = None
    traces: tuple[Trace, ...] = ()


def before_and_after(diagnosis: Diagnosis, ax: Axes | Sequence[Axes] | None = None) -> Panels:
    """The residual before and after, on a recording held out, and in its own coordinate.

    Parameters
    ----------
    diagnosis : Diagnosis
    ax : matplotlib Axes, or a sequence of them, optional
        To draw into, a panel each; those of a new figure without it.

    Raises
    ------
    InputError
        There are no pictures: nothing could be fitted. ``ax`` is something else than axes.
    """
    from ...plot import Panels, panels_for
    from ...report.chart_figure import draw_panels, make_figure
    from ...report.figures import headline

    if diagnosis.pictures is None:
        raise InputError(f"there is nothing to draw: {diagnosis.sentence}")
    chart = headline(diagnosis)
    given = panels_for(ax, [panel.title for panel in chart.panels])
    return Panels(make_figure(chart).axes if given is None else draw_panels(chart, given))
