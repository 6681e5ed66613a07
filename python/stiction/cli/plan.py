"""``stiction plan``: signals to record with."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .answer import answer, folder, print_on_failure, protect_writes
from .given import Quiet, Whole
from .progress import progress

__all__ = ["plan"]


def plan(
    plant: Path,
    *,
    position: float | None = None,
    speed: float | None = None,
    effort: float | None = None,
    rate: float | None = None,
    only: tuple[str, ...] = (),
    seed: Whole = 0,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Write input and reference signals with which to record a machine, a figure of each.

    A session.toml, plant.toml or robot.toml that is there is not overwritten. Of a robot the
    limits are those of its URDF, and the options narrow them for all joints.

    Parameters
    ----------
    plant
        Plant file; what it leaves out takes the catalogue's defaults. Or a robot file.
    position
        Greatest distance from where the machine stands, rad or m; of a robot from the middle of
        the positions of each joint.
    speed
        Greatest speed, rad/s or m/s.
    effort
        Greatest effort of the drive, N·m or N.
    rate
        Samples a second; 1000 without it, 100 of a robot.
    only
        Experiment to plan; may be given several times, all without it.
    seed
        Of everything random.
    out
        Folder for the signals, ./<plant>-plan/ without it.
    json
        Print JSON.
    """
    from .._support.given import vacant
    from ..plan import plan as run
    from ..plan.result import FILLED_IN
    from ..plant import Plant
    from ..robot.robot import describes_robot
    from .robot import plan_arm

    where = Path(f"{plant.stem}-plan") if out is None else out
    if describes_robot(plant):
        asked = {"position": position, "speed": speed, "effort": effort, "only": only, "seed": seed}
        if rate is not None:
            asked["rate"] = rate
        plan_arm(plant, where, asked, as_json=json, quiet=quiet)
        return
    # Better said before the work than after it.
    vacant(where, FILLED_IN, "another folder with --out")
    with progress(quiet):
        made = run(
            Plant.load(plant),
            position=position,
            speed=speed,
            effort=effort,
            rate=1000.0 if rate is None else rate,
            only=only,
            seed=seed,
        )
        where = folder(where)
        text = f"{made!r}\n\nsignals: {where / 'signals'}\nfill in: {where / 'session.toml'}"
        with print_on_failure(text, made.to_dict(), as_json=json), protect_writes(where):
            made.save(where)
    answer(text, made.to_dict(), as_json=json)
