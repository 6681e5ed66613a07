"""Golden files: what the oracle of each law says of one motion, written down.

`python -m tests.reference.golden [LAW...]` makes them anew. The core is not asked.
"""

import importlib
import json
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np

FOLDER = Path(__file__).parents[1] / "golden"
SAMPLES = 300
REST = slice(150, 160)


@dataclass(frozen=True)
class Golden:
    """What one golden file is made with.

    Attributes
    ----------
    reach : float
        Size of the motion in rad or m: some three times what the law needs to reach its level.
    speed : float
        Greatest speed in rad/s or m/s.
    share : float
        Agreement that the core owes, as a share of the range of friction.
    parameters, options : dict
        Of the law; what is left out has its default.
    """

    reach: float
    speed: float
    share: float
    parameters: dict[str, float] = field(default_factory=dict)
    options: dict[str, str] = field(default_factory=dict)


def motion(reach: float, speed: float) -> tuple[np.ndarray, float]:
    """Velocity held over each sample, and the sample: loops within loops, a rest, a long way."""
    time = np.linspace(0.0, 1.0, SAMPLES + 1)
    position = 0.6 * np.sin(2.0 * np.pi * time) + 0.4 * np.sin(2.0 * np.pi * 3.7 * time + 1.0)
    steps = reach * np.diff(position)
    steps[REST] = 0.0
    dt = np.abs(steps).max() / speed
    return steps / dt, dt


def make(law: str) -> dict:
    """The content of the golden file of a law, from its oracle."""
    oracle = importlib.import_module(f"tests.reference.laws.{law}")
    golden: Golden = oracle.GOLDEN
    velocity, dt = motion(golden.reach, golden.speed)
    friction = oracle.along(velocity, dt, **golden.parameters, **golden.options)
    return {"law": law, **asdict(golden), "dt_s": dt, "friction": [float(f) for f in friction]}


def main(names: list[str]) -> None:
    """Write the files of these laws, or of all that have an oracle."""
    FOLDER.mkdir(exist_ok=True)
    every = sorted(
        p.stem for p in (Path(__file__).parent / "laws").glob("*.py") if p.stem[0] != "_"
    )
    for law in names or every:
        text = json.dumps(make(law), indent=0)
        (FOLDER / f"{law}.json").write_text(text + "\n", "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
