"""Pictures of the pages, for a code host too: ``python -m docs.site.pictures`` draws them anew.

They are in the repository, unlike those of the gallery, and a test tells when they are stale.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

import stiction as st
from stiction import demo_session, drafting, plot
from stiction.compare.figures import small
from stiction.report.chart_figure import make_figure
from stiction.report.figures import candidates, cause

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw"]

FIGURES: Final = Path(__file__).parents[1] / "figures"
DRAFTED: Final = "02_ramps_select"
"""The recording of the demonstration from which the page on `init` drafts."""


def draw(folder: Path) -> list[Path]:
    """Draws all of them.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    list of Path
        The files.
    """
    session = demo_session.load()
    fitted = st.fit(session)
    found = st.diagnose(None, session, surrogates=8, seed=0)
    drawn = {
        "init-columns": _columns(),
        "tutorial-recordings": session.plot().figure,
        "tutorial-before-and-after": found.plot().figure,
        "fit-friction": fitted.plot().figure,
        "report-cause": make_figure(cause(found, 0)),
        "report-candidates": make_figure(candidates(found)),
    }
    return [small(picture, folder / f"{name}.png") for name, picture in drawn.items()]


def _columns() -> Figure:
    """The columns of a file, each with what was guessed of it."""
    with tempfile.TemporaryDirectory() as name:
        demo_session.copy(Path(name))
        file = Path(name) / "recordings" / f"{DRAFTED}.csv"
        draft = drafting.draft([file])
        table = np.genfromtxt(file, delimiter=",", names=True)
    columns = draft.found.columns
    picture, panels = plot.figure(len(columns) - 1, height=3.6, sharex=True)
    time, *others = columns
    for panel, column in zip(panels, others, strict=True):
        line = plot.thinned(table[time.column], table[column.column])
        panel.plot(*line, color=plot.SIMULATED, linewidth=0.9)
        title = f"{column.column} → {column.role} [{column.unit}]: {column.reason}"
        panel.set_title(title, fontsize=plot.SMALL, loc="left")
    panels[-1].set_xlabel(f"{time.column} → {time.role} [{time.unit}]", fontsize=plot.SMALL)
    return picture


if __name__ == "__main__":
    for each in draw(FIGURES):
        print(each, file=sys.stderr)
