"""Figures of a walkthrough: the library draws without pyplot, so they are found by their names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sphinx_gallery.scrapers import figure_rst

__all__ = ["saved"]

_SHOWN = "__figures_shown__"


def saved(block: tuple[Any, ...], variables: dict[str, Any], settings: dict[str, Any]) -> str:
    """Saves the figures that a cell has given a name to since the last one.

    Parameters
    ----------
    block : tuple
    variables : dict
        What Sphinx-Gallery knows of the script: its globals, and where pictures go.
    settings : dict

    Returns
    -------
    str
        Markup that shows them.
    """
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stiction.plot import Panels

    names = variables["example_globals"]
    shown = names.setdefault(_SHOWN, set())
    held = (Axes, Panels)
    found = [value.figure if isinstance(value, held) else value for value in names.values()]
    new = {id(each): each for each in found if isinstance(each, Figure) and id(each) not in shown}
    paths = []
    for key, each in new.items():
        path = Path(next(variables["image_path_iterator"]))
        each.savefig(path, format="png", dpi=120, bbox_inches="tight")
        shown.add(key)
        paths.append(str(path))
    return str(figure_rst(paths, settings["src_dir"]))
