"""Friction of plants and laws as curves: over speed, over displacement, over the loading rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from . import plot
from ._support import given
from ._support.keys import choice
from .catalogue import laws as catalogue
from .errors import InputError
from .plant import Plant

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .compare.subject import Subject

__all__ = ["KINDS", "draw", "plot_laws"]

KINDS: Final = ("speed", "hysteresis", "breakaway")
_RATES: Final = np.geomspace(0.1, 100.0, 7)
"""Loading rates, levels of the friction a second."""


def plot_laws(
    laws: Sequence[str | Plant], ax: Axes | None = None, *, kind: str = "hysteresis"
) -> Axes:
    """Friction laws side by side, each at its default numbers, or plants with numbers of their own.

    Parameters
    ----------
    laws : sequence of str or Plant
        Names of the catalogue, which are drawn as rotary contacts, and plants.
    ax : matplotlib Axes, optional
        To draw into, one of a new figure without it.
    kind : {"hysteresis", "speed", "breakaway"}
        As for ``Plant.plot_friction``.

    Returns
    -------
    matplotlib Axes

    Raises
    ------
    InputError
        No laws, an unknown law or kind, plants that turn and plants that do not.

    Examples
    --------
    >>> from stiction.friction_plot import plot_laws
    >>> axes = plot_laws(["lugre", "dahl_with_memory"], kind="hysteresis")
    >>> [line.get_label() for line in axes.lines]
    ['lugre', 'dahl_with_memory']
    """
    if isinstance(laws, str):
        raise InputError(f"plot_laws: laws = '{laws}' is a word; give a sequence, as ['{laws}']")
    plants = [_plant(each) for each in given.each_of(laws, "plot_laws: laws", "names of laws")]
    if not plants:
        raise InputError("plot_laws: there are no laws; give names, as stiction.laws() lists them")
    if len({plant.motion for plant in plants}) > 1:
        raise InputError("plot_laws: some plants turn and some do not; draw them apart")
    for plant in plants:
        ax = draw(plant, ax, kind, "")
    return plot.panel_for(ax)


def _plant(law: str | Plant) -> Plant:
    if isinstance(law, Plant):
        return law
    name = catalogue()[given.word(law, "plot_laws: law")].name
    return Plant.from_dict({"drive": {"kind": "prescribed_motion"}, "friction": {"law": name}})


def draw(plant: Plant, ax: Axes | None, kind: str, label: str) -> Axes:
    """See ``Plant.plot_friction``."""
    choice(kind, KINDS, "plot_friction: kind")
    label = given.word(label, "plot_friction: label")
    panel = plot.panel_for(ax)
    told = label or " + ".join((plant.friction.law, *(e.name for e in plant.effects)))
    effort, place = plant.effort_unit, plant.position_unit
    if kind == "speed":
        speeds = plant.curve_speeds()
        panel.plot(speeds, plant.friction_curve(speeds), label=told, linewidth=1.2)
        panel.set_xlabel(f"speed ({place}/s)")
    elif kind == "hysteresis":
        from .compare.figures import walk

        panel.plot(*walk(_subject(plant)), label=told, linewidth=1.2)
        panel.set_xlabel(f"displacement ({place})")
    else:
        from .compare.properties.sliding import greatest_friction

        subject = _subject(plant)
        if not subject.scale.slides:
            raise InputError(
                f"plot_friction: {plant.friction.law} with these numbers never slides, so that it "
                "has no break-away; state its breakaway, or draw kind = 'hysteresis'"
            )
        peaks = [greatest_friction(subject, float(rate)) for rate in _RATES]
        panel.plot(_RATES * subject.scale.level, peaks, label=told, linewidth=1.2, marker=".")
        panel.set_xscale("log")
        panel.set_xlabel(f"loading rate ({effort}/s)")
    name = "greatest friction" if kind == "breakaway" else "friction"
    panel.set_ylabel(f"{name} ({effort})")
    plot.legend(panel)
    return panel


def _subject(plant: Plant) -> Subject:
    """The contact of a plant as the experiments of a comparison take it."""
    from .compare.subject import Subject

    # A contact has no inertia, and nothing has to drive it.
    still = replace(plant, drive={"kind": "prescribed_motion"}, body={})
    model = still.friction_model()
    keywords: dict[str, Any] = {
        name: value for name, value in model.parameters.items() if "." not in name
    }
    if model.effects:
        keywords["effects"] = model.effects
    return Subject(model.law, "", {**keywords, **model.options})
