"""What the figures of a diagnosis are drawn from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import InputError
from ..trajectory import FloatArray
from .omnibus import Rest
from .view import View

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from .result import Diagnosis

__all__ = ["Pictures", "Stretch", "Tracking", "before_and_after"]


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
    def left_before(self) -> FloatArray:
        """Measured less simulated position, before."""
        return self.measured - self.before

    @property
    def left(self) -> FloatArray:
        """Measured less simulated position, after."""
        return self.measured - self.after


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


def before_and_after(diagnosis: Diagnosis) -> Figure:
    """The residual before and after, on a recording held out, and in its own coordinate.

    Raises
    ------
    InputError
        There are no pictures: nothing could be fitted.
    """
    from ..report.chart_figure import make_figure
    from ..report.figures import headline

    if diagnosis.pictures is None:
        raise InputError(f"there is nothing to draw: {diagnosis.sentence}")
    return make_figure(headline(diagnosis))
