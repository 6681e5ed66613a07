"""``stiction paper``: every experiment of the paper, and how stick-slip ends, in numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final

from cyclopts import Parameter

from .answer import answer
from .given import Quiet
from .progress import progress

__all__ = ["paper"]

FAST: Final = 1.0
"""Above the critical speed of the illustrative rig on its spring, rad/s: the stick-slip is gone."""


def paper(
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("stiction-paper"),
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Run and draw every experiment of the paper on the illustrative rig, and stick-slip.

    Parameters
    ----------
    out
        Folder for the figures (SVG and PNG) and numbers.json.
    json
        Print JSON.
    """
    from ..paper import StickSlip, stick_slip
    from .paper_sections import (
        paper_command,
        render_json,
        render_text,
        write_figure,
        write_numbers,
    )

    with progress(quiet):
        sections = paper_command(out)
    slow = next(s.result for s in sections if isinstance(s.result, StickSlip))
    smooth = stick_slip(FAST, duration=2.0)
    sections.append(write_figure(out, "smooth-sliding", smooth, smooth.plot))
    write_numbers(out, sections)
    closing = (
        f"Pulled at {slow.speed:g} rad/s the rotor sticks and slips ({slow.breakaways} "
        f"break-aways); pulled at {smooth.speed:g} rad/s it slides smoothly after "
        f"{smooth.breakaways} break-away.\nFigures and numbers.json are in {out}."
    )
    answer(f"{render_text(sections)}\n\n{closing}", render_json(sections), as_json=json)
