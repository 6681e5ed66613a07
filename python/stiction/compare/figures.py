"""One small figure of any law: its pre-sliding loops, and friction over slow and fast speed."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from .. import catalogue
from .._support.arrays import FloatArray
from .._support.atomic_files import atomic_write
from ..plot import ACCENT, FAINT, MEASURED, SIMULATED, SMALL, figure, legend
from .subject import Subject, variants

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..catalogue import LawRecord

__all__ = ["law_figure", "law_figures", "name_of", "small", "walk"]

_WIDTH, _HEIGHT = 5.6, 2.25
"""Inches."""
_COLOURS: Final = 48
_FLAT: Final = 0.03
"""Friction that varies by less than this share is drawn from 0: it is flat and shall look so."""
_TURNS: Final = (2.4, -2.0, 1.0, -0.7, 1.0, 2.4)
"""Where the motion turns round, in pre-sliding distances: a loop, and one within it."""
_LEG: Final = 300
_LEG_S: Final = 0.1  # s; too short for most creep
_SPEEDS: Final = (0.0, 0.3)
"""Range of the cycles of speed, rad/s or m/s."""
_CYCLES: Final = ((10_000.0, MEASURED, "slow"), (60.0, ACCENT, "fast"))
"""Travel of a cycle in pre-sliding distances."""


def law_figure(record: LawRecord) -> Figure:
    """The figure of a law, whatever it is.

    Left the law at its defaults, right with typical values of all its terms where that differs.

    Parameters
    ----------
    record : LawRecord

    Returns
    -------
    Figure
    """
    cases = {subject.label: subject for subject in variants(record)}
    default = cases["defaults"]
    typical = cases.get("typical values", default)
    drawn, (loop, speed) = figure(1, 2, height=_HEIGHT, width=_WIDTH)
    _loop(loop, default)
    _cycles(speed, typical)
    return drawn


def law_figures(folder: Path) -> list[Path]:
    """Draw every law of the catalogue into a folder, as law-NAME.png.

    Returns
    -------
    list of Path
        The files.
    """
    return [small(law_figure(record), folder / name_of(record.name)) for record in catalogue.laws()]


def name_of(law: str) -> str:
    """File of the figure of a law."""
    return f"law-{law.replace('_', '-')}.png"


def small(drawn: Figure, path: Path) -> Path:
    """A PNG of few colours: the lines need no more, and a page with many figures stays light.

    Parameters
    ----------
    drawn : Figure
    path : Path

    Returns
    -------
    Path
        The file.
    """
    from PIL import Image

    target = BytesIO()
    drawn.savefig(target, format="png", metadata={"Software": None})
    with Image.open(target) as picture:
        few = picture.convert("RGB").quantize(_COLOURS, dither=Image.Dither.NONE)
        with atomic_write(path) as file:
            few.save(file, format="png", optimize=True)
    return path


def _loop(panel: Axes, subject: Subject) -> None:
    position, force = walk(subject)
    panel.axhline(0.0, color=FAINT, linewidth=0.6)
    panel.plot(1e6 * position, force, color=SIMULATED, linewidth=1.1)
    panel.set_xlabel("displacement (µrad or µm)", fontsize=SMALL)
    panel.set_ylabel("friction (N·m or N)", fontsize=SMALL)
    panel.set_title("turning round, defaults", fontsize=SMALL, loc="left")


def walk(subject: Subject) -> tuple[FloatArray, FloatArray]:
    """Displacement, rad or m, and friction through a loop and one within it; (n,) each."""
    at, moves = 0.0, []
    for turn in _TURNS:
        moves.append(np.full(_LEG, (turn - at) * subject.length / _LEG))
        at = turn
    moved = np.concatenate(moves)
    dt = _LEG_S / _LEG
    force = subject.model().simulate(moved / dt, dt)
    return np.concatenate([[0.0], np.cumsum(moved)]), np.concatenate([[0.0], force])


def _cycles(panel: Axes, subject: Subject) -> None:
    panel.set_title(f"speed up and down, {subject.label}", fontsize=SMALL, loc="left")
    panel.set_xlabel("speed (rad/s or m/s)", fontsize=SMALL)
    if not subject.scale.slides:
        panel.text(
            0.5, 0.5, "it never slides:\nno friction of speed", transform=panel.transAxes,
            ha="center", va="center", fontsize=SMALL, color=MEASURED,
        )  # fmt: skip
        panel.set_xlim(*_SPEEDS)
        panel.set_yticks([])
        return
    low, high = _SPEEDS
    samples = 4000
    # In the middle of the samples: the speed is never exactly 0.
    phase = 2.0 * np.pi * (np.arange(samples) + 0.5) / samples
    speed = low + 0.5 * (high - low) * (1.0 - np.cos(phase))
    for travel, colour, name in _CYCLES:
        dt = travel * subject.length / (0.5 * (low + high)) / samples
        law = subject.model()
        law.simulate(speed, dt)
        force = law.simulate(speed, dt)
        panel.plot(speed, force, color=colour, linewidth=1.1, label=name)
    _room(panel)
    legend(panel, loc="upper right", ncols=2, fontsize=SMALL)


def _room(panel: Axes) -> None:
    """Room for the legend above the curves."""
    low, high = panel.get_ylim()
    if high - low < _FLAT * abs(high):
        low = min(0.0, low)
    panel.set_ylim(low, high + 0.25 * (high - low))
