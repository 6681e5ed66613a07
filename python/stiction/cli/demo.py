"""``stiction demo``: what the package can do, run and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..paper import StickSlip, stick_slip
from .answer import answer
from .paper import Section, paper_command, render_json, render_text
from .paper import write_figure as write

__all__ = ["demo"]

FAST = 1.0
"""Above the critical speed of the demo's rig, rad/s: the stick-slip is gone."""


def demo(
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("stiction-demo"),
    json: Annotated[bool, Parameter(negative="")] = False,
) -> None:
    """Run the paper's experiments and a stick-slip run, with figures.

    Parameters
    ----------
    out
        Folder for the figures and numbers.json.
    json
        Print JSON.
    """
    sections = paper_command(out)
    slow = next(s.result for s in sections if isinstance(s.result, StickSlip))
    smooth = stick_slip(FAST, duration=2.0)
    sections.append(Section("smooth-sliding", smooth, write(out, "smooth-sliding", smooth.plot())))
    closing = (
        f"Pulled at {slow.speed:g} rad/s the rotor sticks and slips ({slow.breakaways} "
        f"break-aways); pulled at {smooth.speed:g} rad/s it slides smoothly after "
        f"{smooth.breakaways} break-away.\nFigures and numbers.json are in {out}."
    )
    answer(f"{render_text(sections)}\n\n{closing}", render_json(sections), as_json=json)
