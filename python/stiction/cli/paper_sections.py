"""The experiments of ``stiction paper``: their numbers and figures, and both in words."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .._support.atomic_files import write_text
from .._support.progress import phase
from ..paper import (
    ILLUSTRATIVE_RIG,
    Result,
    ball_screw,
    bearing_loops,
    dahl_on_static_1,
    experiment_1,
    experiment_2,
    experiment_3,
    hardening_cycles,
    local_variation,
    loop_areas,
    metal_contact,
    nanometre_loops,
    nested_loops,
    static_test,
    stick_slip,
)
from ..paper.figures import static_comparison
from ..plot import save_or_say
from .answer import folder, json_of, protect_writes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = [
    "Section",
    "paper_command",
    "render_json",
    "render_text",
    "write_figure",
    "write_numbers",
]

_logger = logging.getLogger(__name__)

NOTE = (
    'The rig is illustrative: its numbers are not the authors\'. "prototype" is an independent '
    "prototype of the same equations on the same rig."
)

# Slow ramps need no finer samples: finer ones move no position by 1e-4 arc-seconds.
_RAMP_STEP = 2.5e-4


@dataclass(frozen=True)
class Section:
    """One experiment of the command's answer: its numbers, and where its figures are.

    Attributes
    ----------
    name : str
        Of the figures' files, without ending.
    result : Result
        Title, source and numbers.
    figures : tuple of Path
        SVG and PNG; none where they could not be drawn.
    failure : str
        Why they could not.
    """

    name: str
    result: Result
    figures: tuple[Path, ...]
    failure: str = ""


def paper_command(out: Path) -> list[Section]:
    """Run and draw every experiment on the illustrative rig.

    Writes an SVG and a PNG of each, and ``numbers.json``, into `out`, which is made where it
    does not exist.

    Parameters
    ----------
    out : Path

    Returns
    -------
    list of Section
        In the order of the paper.

    Raises
    ------
    InputError
        `out` cannot be made a folder.
    """
    out = folder(Path(out))
    made: list[tuple[Section, Callable[[], Figure]]] = []

    def add(name: str, result: Result, figure: Callable[[], Figure] | None = None) -> None:
        phase(_logger, "running the experiments, %s is done", name)
        made.append((Section(name, result, _paths(out, name)), figure or result.plot))

    add("experiment-1", experiment_1())
    add("experiment-2", experiment_2())
    add("experiment-3", experiment_3())
    forced = static_test(1)
    add("static-test-1", forced)
    add("static-test-2", static_test(2))
    add("static-test-3", static_test(3))
    ramped = static_test(1, driven="ramp", dt=_RAMP_STEP)
    stepped = static_test(1, driven="staircase")
    add("static-test-1-steps", stepped, lambda: static_comparison([forced, ramped, stepped]))
    add("dahl-on-static-test-1", dahl_on_static_1())
    add("metal-contact", metal_contact())
    add("hardening-cycles", hardening_cycles())
    add("nested-loops", nested_loops())
    add("nanometre-loops", nanometre_loops())
    add("bearing-loops", bearing_loops())
    add("ball-screw", ball_screw())
    add("loop-areas", loop_areas())
    add("local-variation", local_variation())
    add("stick-slip", stick_slip())
    # The numbers first: no figure can cost them.
    write_numbers(out, [section for section, _ in made])
    sections = [write_figure(out, section.name, section.result, make) for section, make in made]
    if any(section.failure for section in sections):
        write_numbers(out, sections)
    return sections


def write_numbers(out: Path, sections: Sequence[Section]) -> None:
    """Write numbers.json into a folder."""
    text = json_of(render_json(sections)) + "\n"
    with protect_writes(out):
        write_text(out / "numbers.json", text)


def render_text(sections: Iterable[Section]) -> str:
    """The numbers of every experiment as text, with the prototype's beside them."""
    blocks = [NOTE]
    for section in sections:
        names = ", ".join(str(path) for path in section.figures)
        blocks.append(f"{section.result!r}\n  figure: {section.failure or names}")
    return "\n\n".join(blocks)


def render_json(sections: Sequence[Section]) -> dict[str, Any]:
    """The numbers of every experiment as plain dicts and lists; figures by file name."""
    return {
        "note": NOTE,
        "rig": dict(ILLUSTRATIVE_RIG),
        "experiments": [
            {
                "name": section.name,
                **section.result.to_dict(),
                "figures": [path.name for path in section.figures],
                **({"not_drawn": section.failure} if section.failure else {}),
            }
            for section in sections
        ],
    }


def _paths(out: Path, name: str) -> tuple[Path, ...]:
    return tuple(out / f"{name}{ending}" for ending in (".svg", ".png"))


def write_figure(out: Path, name: str, result: Result, make: Callable[[], Figure]) -> Section:
    """Write a figure of a result as SVG and PNG, or say why it cannot be drawn."""
    phase(_logger, "drawing %s", name)
    paths = _paths(out, name)
    with protect_writes(out):
        failure = save_or_say(f"the figure {name}", make, *paths)
    return Section(name, result, () if failure else paths, failure)
