"""What `step` costs from Python above an empty method and the core's own step, in one run."""

from __future__ import annotations

import timeit

import numpy as np

from stiction import FrictionModel, _native

CALLS = 200_000
ROUNDS = 15


def best(call: object) -> float:
    """Nanoseconds a call, the best of some rounds: the least disturbed one."""
    timer = timeit.Timer("call()", globals={"call": call})
    return 1e9 * min(timer.repeat(ROUNDS, CALLS)) / CALLS


def main() -> None:
    """Print the cost of each and the difference."""
    velocity, dt = 1e-9, 1e-4
    empty = _native.Nothing().step
    nothing = best(lambda: empty(velocity, dt))
    print(f"empty method with two floats {nothing:.1f} ns")
    for law in ("coulomb", "hsieh_pan"):
        model = FrictionModel(law, breakaway=0.5)
        step = model.step
        whole = best(lambda step=step: step(velocity, dt))
        held = np.full(100_000, velocity)
        chunk = timeit.Timer(lambda model=model, held=held: model.simulate(held, dt))
        own = 1e9 * min(chunk.repeat(ROUNDS, 1)) / len(held)
        print(
            f"{law:<10} step {whole:6.1f} ns = empty {nothing:.1f} + core {own:.1f} "
            f"+ binding {whole - nothing - own:.1f} ns"
        )


if __name__ == "__main__":
    main()
