"""Seconds a step of the simulator of `better-actuator-models`, in a Python of its own.

`peers.py` runs it there.
"""

from __future__ import annotations

import json
import math
import sys
import time
from pathlib import Path

import bam
from bam.model import load_model
from bam.simulate import Simulator

STEPS, DT = 2000, 5e-3


def main() -> None:
    """Print the seconds a step of some rollouts of one log."""
    found = sorted(Path(bam.__file__).parent.glob("params/**/m6.json"))
    simulator = Simulator(load_model(str(found[0])))
    entry = {"position": 0.0, "speed": 0.0, "torque_enable": True}
    goals = [{**entry, "goal_position": math.sin(2.0 * k * DT)} for k in range(STEPS)]
    log = {"dt": DT, "entries": goals, "kp": 8.0, "vin": 12.0, "mass": 0.5, "length": 0.1}
    log["arm_mass"] = 0.01
    seconds = []
    for _ in range(int(sys.argv[1])):
        start = time.perf_counter()
        simulator.rollout_log(log, simulate_control=True)
        seconds.append((time.perf_counter() - start) / STEPS)
    print(json.dumps({"model": found[0].parent.name, "seconds": seconds}))


if __name__ == "__main__":
    main()
