"""Held inputs by `simulate_segments` and by the largest fixed step, in one run."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from stiction import FrictionModel, Motor

INERTIA = 0.0076
STEP = 1.0e-4
"""s; the fast integrator divides what is longer (1.03e-4 here): no fixed step is larger."""
CYCLES = 20
PULSES = 600
TOLERANCE = 0.1 * np.pi / 648000
LAWS: dict[str, dict[str, float]] = {
    "hsieh_pan": {"breakaway": 0.5},
    "maxwell_slip": {"viscous": 0.3},
    "lugre": {},
    "coulomb": {"coulomb": 0.1, "breakaway": 0.15, "viscous": 0.01},
    "rate_and_state": {},
}


def pulses(number: int, rest: float) -> tuple[np.ndarray, np.ndarray]:
    """Durations and inputs of pulses of 20 ms with rests between them."""
    sizes = np.array([0.15, 0.2, -0.15, -0.2])
    durations = np.tile([0.02, rest], number)
    currents = np.zeros(2 * number)
    currents[::2] = sizes[np.arange(number) % 4]
    return durations, currents


def seconds(work: Callable[[], object]) -> float:
    """The best of three."""
    best = np.inf
    for _ in range(3):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best


def fixed(motor: Motor, durations: np.ndarray, currents: np.ndarray, step: float) -> np.ndarray:
    """Positions at the ends of segments, by samples; the last row of each is kept."""
    rows = []
    for duration, current in zip(durations, currents, strict=True):
        samples = np.full(round(duration / step), current)
        rows.append(motor.simulate(samples, step, outputs=("position",)).position[-1])
    return np.array(rows)


def main() -> None:
    """Print a row for each law."""
    print("law · evaluations a cycle · 86 s rests: ratio · 60 s of pulses: ratio · errors in 0.1″")
    for law, parameters in LAWS.items():
        rests, trains = pulses(CYCLES, 85.98), pulses(PULSES, 0.08)

        def motor(kind: str = "fast", law: str = law, own: dict[str, float] = parameters) -> Motor:
            return Motor(INERTIA, friction=FrictionModel(law, **own), integrator=kind)

        run = motor().simulate_segments(*rests)
        ratios = [
            seconds(lambda work=work, motor=motor: fixed(motor(), *work, STEP))
            / seconds(lambda work=work, motor=motor: motor().simulate_segments(*work))
            for work in (rests, trains)
        ]
        truth = fixed(motor("reference"), *trains, 2e-5)
        errors = [
            np.abs(rows - truth).max() / TOLERANCE
            for rows in (
                motor().simulate_segments(*trains).position,
                fixed(motor(), *trains, STEP),
            )
        ]
        print(
            f"{law:<16}{run.statistics['evaluations'] / CYCLES:8.0f}{ratios[0]:10.0f}"
            f"{ratios[1]:8.1f}   adaptive {errors[0]:.2f}, fixed {errors[1]:.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
