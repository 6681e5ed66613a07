"""Which coordinate shows a cause best, and what a dependence on each usually points to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from ..diagnosis.omnibus import Rest, View

__all__ = ["HINTS", "fitting_view"]

HINTS: Final = {
    "velocity": "friction that differs by direction or with speed",
    "speed": "another shape of friction over speed",
    "position": "a pull that depends on place: unbalance, cogging, a cable, a spring",
    "position along the motion": "friction that is higher in some places than in others",
    "acceleration": "inertia, or a part that moves by itself",
    "effort": "the drive: gain, saturation, dead zone",
    "rate of the effort": "a delay or lag between input and effort",
    "distance since the reversal": "friction just after a turn: pre-sliding, backlash",
    "time since the reversal": "friction that builds up or relaxes: creep, dwell, lag",
    "session time": "an offset that drifts during the session",
    "session time along the motion": "friction that drifts during the session: warm-up, wear",
}
"""What a residual that depends on a coordinate usually comes from."""

# First match wins: words of an effect's coordinate, and the views that show it, best first.
_SHOWN_IN: Final = (
    ("rate of the", ("rate of the effort",)),
    ("clock", ("session time along the motion", "session time")),
    ("path", ("session time along the motion", "session time")),
    ("not odd", ("position",)),
    ("position", ("position along the motion", "position")),
    ("dwell", ("time since the reversal", "distance since the reversal")),
    ("reversal", ("distance since the reversal", "time since the reversal")),
    ("relax", ("time since the reversal",)),
    ("acceleration", ("acceleration",)),
    ("sign of speed", ("velocity", "speed")),
    ("speed", ("speed", "velocity")),
    ("input", ("effort",)),
    ("effort", ("effort",)),
    ("everywhere", ("velocity", "position", "session time")),
)


def fitting_view(coordinate: str, rest: Rest) -> View:
    """The view that shows a cause best.

    Parameters
    ----------
    coordinate : str
        As the catalogue has it for the effect.
    rest : Rest
        Of the baseline.

    Returns
    -------
    View
        The first of those that fit the coordinate in which something shows; the first that fits
        where it shows in none, and the one with the largest share where none fits.
    """
    names = next((views for words, views in _SHOWN_IN if words in coordinate), ())
    by_name = {view.coordinate.name: view for view in rest.views}
    own = [by_name[name] for name in names if name in by_name]
    flagged = [view for view in own if view.flagged()]
    return next(iter(flagged or own), rest.views[0])
