"""Figures in one restrained style.

Every function returns a :class:`matplotlib.figure.Figure` that belongs to the caller: no pyplot,
no global state. :func:`save` writes the same bytes for the same figure.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ._support import given
from ._support.arrays import FloatArray
from ._support.atomic_files import atomic_write
from ._support.best_effort import Failure, attempt
from .errors import InputError

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .trajectory import Trajectory

__all__ = [
    "ACCENT",
    "CYCLE",
    "FAINT",
    "INK",
    "MEASURED",
    "SIMULATED",
    "SMALL",
    "TEXT",
    "TITLE",
    "WIDTH",
    "figure",
    "legend",
    "overlay",
    "panel_for",
    "residual",
    "save",
    "save_or_say",
    "thinned",
    "tracking",
    "trajectory",
]

WIDTH = 7.2
"""Width of a figure, inches."""

RESOLUTION = 160
"""Dots an inch of a PNG."""

TITLE, TEXT, SMALL = 11.0, 9.5, 8.5
"""Font sizes: titles, labels and legends, ticks and annotations; points."""

INK, FAINT = "#222222", "#9aa0a6"
MEASURED, SIMULATED, ACCENT = "#6b7178", "#1463a5", "#c2410c"
CYCLE = (SIMULATED, ACCENT, "#3f7d4e", "#7b4fa3", "#a67c00")
"""Colours of lines in order; told apart also by people who do not see red and green alike."""

_BUCKETS = 1500
_FORMATS = {".svg", ".png"}


def figure(
    rows: int = 1,
    columns: int = 1,
    *,
    height: float = 3.6,
    width: float = WIDTH,
    title: str = "",
    sharex: bool = False,
    height_ratios: Sequence[float] | None = None,
    width_ratios: Sequence[float] | None = None,
) -> tuple[Figure, list[Axes]]:
    """An empty figure in the style of the package.

    Parameters
    ----------
    rows, columns : int
        Panels.
    height, width : float
        Inches.
    title : str
        Of the whole figure, at its upper left.
    sharex : bool
        Whether the panels of a column share their horizontal axis.
    height_ratios, width_ratios : sequence of float, optional
        Of the rows and the columns.

    Returns
    -------
    Figure, list of Axes
        Panels row by row.
    """
    # Imported here: colours and sizes are asked for by pages that draw without it.
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    layout = ConstrainedLayoutEngine(h_pad=0.06, w_pad=0.06)
    drawn = Figure(figsize=(width, height), dpi=RESOLUTION, layout=layout)
    grid = drawn.subplots(
        rows,
        columns,
        sharex="col" if sharex else False,
        squeeze=False,
        height_ratios=height_ratios,
        width_ratios=width_ratios,
    )
    panels: list[Axes] = list(grid.flat)
    for panel in panels:
        panel.spines[["top", "right"]].set_visible(False)
        panel.spines[["left", "bottom"]].set_color(FAINT)
        panel.tick_params(colors=INK, labelsize=SMALL, color=FAINT, length=3.0)
        panel.xaxis.label.set_fontsize(TEXT)
        panel.yaxis.label.set_fontsize(TEXT)
        panel.grid(True, color="#e6e8ea", linewidth=0.6)
        panel.set_axisbelow(True)
    if title:
        drawn.suptitle(title, x=0.012, ha="left", fontsize=TITLE, color=INK)
    return drawn, panels


def panel_for(ax: Axes | None) -> Axes:
    """The axes that a caller gave, or those of a new figure.

    Raises
    ------
    InputError
        Something else than axes.
    """
    if ax is None:
        return figure()[1][0]
    from matplotlib.axes import Axes

    return given.instance(ax, Axes, "plot: ax", "axes, as matplotlib's subplots returns them")


class Panels(tuple["Axes", ...]):
    """The axes that were drawn into, row by row; a notebook shows their figure."""

    __slots__ = ()

    @property
    def figure(self) -> Figure:
        """The figure of the first of them."""
        from matplotlib.figure import Figure

        return given.instance(self[0].get_figure(root=True), Figure, "plot", "axes of a figure")

    @property
    def axes(self) -> list[Axes]:
        """The axes, as a figure has them."""
        return list(self)

    def savefig(self, *args: Any, **kwargs: Any) -> None:
        """Write their figure, as ``matplotlib.figure.Figure.savefig`` does."""
        self.figure.savefig(*args, **kwargs)

    def _repr_png_(self) -> bytes:
        return _encoded(self.figure, ".png")


def panels_for(ax: Axes | Sequence[Axes] | None, names: Sequence[str]) -> list[Axes] | None:
    """The axes that a caller gave for these panels, the first ones where there are fewer.

    Parameters
    ----------
    ax : Axes or sequence of Axes, optional
    names : sequence of str
        What is drawn, a panel each.

    Returns
    -------
    list of Axes, or None
        None where no axes were given.

    Raises
    ------
    InputError
        Something else than axes, none, or more than there is to draw.
    """
    if ax is None:
        return None
    from matplotlib.axes import Axes

    if isinstance(ax, Axes):
        return [ax]
    remedy = "axes, or a sequence of them, as matplotlib's subplots returns them"
    found = [given.instance(each, Axes, "plot: ax", remedy) for each in _flat(ax, remedy)]
    if not 0 < len(found) <= len(names):
        raise InputError(
            f"plot: ax holds {len(found)} axes, and there are {len(names)} panels to draw "
            f"({', '.join(names)}); give that many or fewer"
        )
    return found


def _flat(ax: object, remedy: str) -> list[object]:
    return list(np.ravel(np.asarray(list(given.each_of(ax, "plot: ax", remedy)), dtype=object)))


def legend(panel: Axes, **keywords: Any) -> None:
    """A legend without a frame, in the style of the package."""
    panel.legend(**{"frameon": False, "fontsize": SMALL, "handlelength": 1.6, **keywords})


def thinned(
    x: npt.ArrayLike, y: npt.ArrayLike, buckets: int = _BUCKETS
) -> tuple[FloatArray, FloatArray]:
    """A long line by the least and greatest value of each stretch: same picture, fewer points.

    Parameters
    ----------
    x, y : array_like, shape (n,)
        x rising.
    buckets : int
        Stretches; lines of up to four times as many points stay as they are.

    Returns
    -------
    numpy.ndarray, numpy.ndarray
        Points in their order. A stretch without a finite value leaves a gap.
    """
    along, up = np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)
    if along.shape != up.shape or along.ndim != 1:
        raise InputError(f"a line needs as many x as y; given shapes {along.shape} and {up.shape}")
    length = len(up)
    if length <= 4 * buckets:
        return along, up
    size = -(-length // buckets)
    starts = np.arange(0, length, size)
    padded = np.full(len(starts) * size, np.nan)
    padded[:length] = up
    stretches = padded.reshape(-1, size)
    hollow = np.isnan(stretches)
    least = np.where(hollow, np.inf, stretches).argmin(axis=1)
    greatest = np.where(hollow, -np.inf, stretches).argmax(axis=1)
    ends = np.array([0, length - 1])
    kept = np.unique(np.concatenate([starts + least, starts + greatest, ends]))
    return along[kept], up[kept]


def trajectory(
    trajectory: Trajectory, ax: Axes | Sequence[Axes] | None = None, *, title: str = ""
) -> Panels:
    """Position, velocity and friction of a simulation over time, as far as it has them.

    Parameters
    ----------
    trajectory : Trajectory
    ax : matplotlib Axes, or a sequence of them, optional
        To draw into, one a column; those of a new figure without it.
    title : str
        Of a new figure.

    Returns
    -------
    Panels
        The axes, one a column.

    Raises
    ------
    InputError
        A trajectory without any column; something else than axes, or too many.
    """
    shown = [name for name in ("position", "velocity", "friction") if name in trajectory]
    shown = shown or list(trajectory)[:3]
    if not shown:
        raise InputError("the trajectory has no columns to draw; simulate with outputs")
    panels = panels_for(ax, shown)
    if panels is None:
        tall = 1.0 + 1.45 * len(shown)
        drawn, panels = figure(len(shown), height=tall, title=title, sharex=True)
        drawn.align_ylabels()
    time = trajectory.time
    for panel, name in zip(panels, shown, strict=False):
        panel.plot(*thinned(time, trajectory[name]), label=name, color=SIMULATED, linewidth=1.1)
        unit = trajectory.units.get(name, "")
        panel.set_ylabel(f"{name}\n({unit})" if unit else name)
        panel.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True)
        panel.yaxis.get_offset_text().set_fontsize(SMALL)
    panels[-1].set_xlabel("time (s)")
    return Panels(panels)


def overlay(
    time: npt.ArrayLike,
    measured: npt.ArrayLike,
    simulated: npt.ArrayLike,
    *,
    unit: str,
    title: str = "",
    quantity: str = "position",
) -> Figure:
    """Measured and simulated over time, and beneath them what is left: measured − simulated.

    Parameters
    ----------
    time, measured, simulated : array_like, shape (n,)
        s, and twice the same unit.
    unit : str
        Unit of the two.
    title : str
    quantity : str
        What was measured, for the label.

    Returns
    -------
    Figure
    """
    return _compared(time, measured, simulated, ("measured", "simulated"), unit, title, quantity)


def tracking(
    time: npt.ArrayLike,
    without: npt.ArrayLike,
    compensated: npt.ArrayLike,
    *,
    unit: str,
    title: str = "",
) -> Figure:
    """Tracking error of a loop over time, without a feed-forward and with it.

    Parameters
    ----------
    time, without, compensated : array_like, shape (n,)
        s, and twice the same unit.
    unit : str
        Unit of the two.
    title : str

    Returns
    -------
    Figure
    """
    names = ("without feed-forward", "with feed-forward")
    return _compared(time, without, compensated, names, unit, title, "tracking error")


def residual(
    time: npt.ArrayLike,
    measured_effort: npt.ArrayLike,
    model_effort: npt.ArrayLike,
    *,
    unit: str,
    title: str = "",
    quantity: str = "effort",
) -> Figure:
    """Effort that was applied and effort that the model needs for the measured motion.

    Parameters
    ----------
    time, measured_effort, model_effort : array_like, shape (n,)
        s, and twice the same unit.
    unit : str
        Unit of the two.
    title : str
    quantity : str
        For the label: effort, torque, force.

    Returns
    -------
    Figure
        Both efforts above, their difference (measured − model) beneath.
    """
    names = ("measured", "model along the measured motion")
    return _compared(time, measured_effort, model_effort, names, unit, title, quantity)


def save(fig: Figure | Panels | Axes, path: str | Path) -> Path:
    """Write a figure as SVG or PNG, by the name's ending; the same figure gives the same bytes.

    Parameters
    ----------
    fig : Figure, Panels or matplotlib Axes
        Of axes the figure they are in.
    path : str or Path
        Ending .svg or .png.

    Returns
    -------
    Path
        The path that was written.

    Raises
    ------
    InputError
        No path, another ending, a folder that is not there, a file that cannot be written.
    """
    path = given.path(path, "plot.save")
    if not path.parent.is_dir():
        raise InputError(f"{path}: there is no folder {path.parent}; make it first")
    if path.suffix not in _FORMATS:
        raise InputError(f"{path}: ending '{path.suffix}' is not known; use .svg or .png")
    data = _encoded(_figure_of(fig), path.suffix)
    with given.explain_write_errors(path), atomic_write(path) as file:
        file.write(data)
    return path


def save_or_say(what: str, make: Callable[[], Figure], *paths: Path) -> str:
    """Draw a figure and write it, or say why it cannot be drawn; one of an earlier run goes then.

    Parameters
    ----------
    what : str
        Subject of the sentence, such as ``"the figure of the free run"``.
    make : callable
        Draws it.
    *paths : Path
        Endings .svg or .png.

    Returns
    -------
    str
        A sentence, which is logged as a warning too; "" where it was drawn.

    Raises
    ------
    OSError
        A file cannot be written.
    """

    def drawn() -> list[bytes]:
        figure = make()
        return [_encoded(figure, path.suffix) for path in paths]

    made = attempt(what, drawn)
    if isinstance(made, Failure):
        for path in paths:
            path.unlink(missing_ok=True)
        return made.sentence
    for path, data in zip(paths, made, strict=True):
        with atomic_write(path) as file:
            file.write(data)
    return ""


def _figure_of(drawn: Figure | Panels | Axes) -> Figure:
    if isinstance(drawn, Panels):
        return drawn.figure
    from matplotlib.axes import Axes

    return Panels([drawn]).figure if isinstance(drawn, Axes) else drawn


def _encoded(fig: Figure, suffix: str) -> bytes:
    import matplotlib

    # Dates, versions and random identifiers would make each file differ from the last.
    metadata = {"Date": None} if suffix == ".svg" else {"Software": None}
    target = BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "stiction", "svg.fonttype": "path"}):
        fig.savefig(target, format=suffix[1:], dpi=RESOLUTION, metadata=metadata)
    return target.getvalue()


def _compared(
    time: npt.ArrayLike,
    measured: npt.ArrayLike,
    modelled: npt.ArrayLike,
    names: tuple[str, str],
    unit: str,
    title: str,
    quantity: str,
) -> Figure:
    seen, made = np.asarray(measured, dtype=np.float64), np.asarray(modelled, dtype=np.float64)
    if seen.shape != made.shape:
        raise InputError(
            f"{names[0]} and {names[1]} must be equally long; given {seen.shape} and {made.shape}"
        )
    drawn, (upper, lower) = figure(
        2, height=4.2, title=title, sharex=True, height_ratios=(2.0, 1.0)
    )
    upper.plot(*thinned(time, seen), color=MEASURED, linewidth=1.6, label=names[0])
    upper.plot(*thinned(time, made), color=SIMULATED, linewidth=1.0, label=names[1])
    upper.set_ylabel(f"{quantity} ({unit})")
    upper.margins(y=0.12)
    legend(upper, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.1)
    lower.axhline(0.0, color=FAINT, linewidth=0.8)
    lower.plot(*thinned(time, seen - made), color=ACCENT, linewidth=0.9)
    lower.set_ylabel(f"difference ({unit})")
    lower.set_xlabel("time (s)")
    for panel in (upper, lower):
        panel.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True)
        panel.yaxis.get_offset_text().set_fontsize(SMALL)
    drawn.align_ylabels()
    return drawn
