"""Seconds a step of the simulator of `better-actuator-models`, in a Python of its own.

`peers.py` runs it there: one log, and a hundred of them as one batch, each entry of which is a row
of all logs, as its own fit does it.
"""

from __future__ import annotations

import json
import math
import sys
import time
from pathlib import Path
from typing import Any

import bam
import numpy as np
from bam.logs import Logs
from bam.model import load_model
from bam.simulate import Simulator

STEPS, DT = 2000, 5e-3
LOGS = 100


def log(size: float) -> dict[str, Any]:
    """A pendulum on a servo that follows a sine of this size."""
    entry = {"position": 0.0, "speed": 0.0, "torque_enable": True}
    goals = [{**entry, "goal_position": size * math.sin(2.0 * k * DT)} for k in range(STEPS)]
    return {
        "dt": DT,
        "entries": goals,
        "kp": 8.0,
        "vin": 12.0,
        "mass": 0.5,
        "length": 0.1,
        "arm_mass": 0.01,
    }


def batch() -> dict[str, Any]:
    """Many logs at once."""
    logs = Logs.__new__(Logs)
    logs.logs = [log(size) for size in np.linspace(0.5, 1.5, LOGS)]
    made: dict[str, Any] = logs.make_batch()
    return made


def main() -> None:
    """Print the seconds a step of a log of some rollouts, of one log and of many."""
    found = sorted(Path(bam.__file__).parent.glob("params/**/m6.json"))
    simulator = Simulator(load_model(str(found[0])))
    given = {"one": (log(1.0), 1), "batched": (batch(), LOGS)}
    seconds: dict[str, list[float]] = {name: [] for name in given}
    for _ in range(int(sys.argv[1])):
        for name, (work, number) in given.items():
            start = time.perf_counter()
            simulator.rollout_log(work, simulate_control=True)
            seconds[name].append((time.perf_counter() - start) / (STEPS * number))
    print(json.dumps({"model": found[0].parent.name, "seconds": seconds}))


if __name__ == "__main__":
    main()
