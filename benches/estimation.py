"""How often the intervals of ``stiction.paper.estimate`` hold the truth, and how far off it is.

python benches/estimation.py [SEEDS]

The recordings are made once by the oracle in ``tests/reference``; every seed adds noise of 0.4
arc-seconds rms and rounds to 0.8.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.reference.estimation_reference import TRUTH, motions, readings, torques

from stiction.paper.estimate import NAMES, Recorded, estimate
from stiction.paper.graphical import branch_curve


def main(seeds: int) -> None:
    """Estimate once a seed; print coverage and deviations."""
    inputs, truth = torques(), motions()
    held = dict.fromkeys(NAMES, 0)
    off: dict[str, list[float]] = {name: [] for name in NAMES}
    curve_off, curve_held = [], []
    for seed in range(seeds):
        rng = np.random.default_rng(seed)
        found = estimate(
            *(Recorded(dt, torque, readings(truth[name], rng))
              for name, (dt, torque) in inputs.items())
        )  # fmt: skip
        for name in NAMES:
            low, high = found.parameters[name].ci95
            held[name] += low <= TRUTH[name] <= high
            off[name].append(found.parameters[name].value / TRUTH[name] - 1.0)
        true_curve = branch_curve(found.distance, *(TRUTH[name] for name in NAMES[:3]))
        curve_off.append(np.max(np.abs(found.branch / true_curve - 1.0)))
        curve_held.append(
            np.mean((found.branch_low <= true_curve) & (true_curve <= found.branch_high))
        )
        print(f"\r{seed + 1} of {seeds}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    print(f"{'':<24}{'in interval':>12}{'mean off':>10}{'sd':>10}{'worst':>10}")
    for name in NAMES:
        share = np.array(off[name])
        print(f"{name:<24}{held[name] / seeds:>12.2f}{share.mean():>10.2%}{share.std():>10.2%}"
              f"{np.abs(share).max():>10.2%}")  # fmt: skip
    print(f"{'G over 2-40 arcsec':<24}{np.mean(curve_held):>12.2f}{'':>20}{max(curve_off):>10.2%}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 50)
