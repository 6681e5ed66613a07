"""Motors that nobody drives: none may come to more energy than it had.

``python -m tests.faults.undriven --number 20000 --seed 1`` runs so many, each with a law of the
catalogue and one to three effects anywhere in their bounds, and prints those that gain.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections import Counter
from dataclasses import dataclass

import numpy as np
from tests.fuzz.draw import EFFECTS, LAWS, SERVO, Draw

import stiction as st

SAMPLES = 400
TOLERANCE = 0.02
"""Share of energy that steps may seem to give: a ring of a coarse step is off by that."""
ROUND_OFF = 1e-12
NOTHING = 1e-30
"""Energy, in J, that is none: a shaft at rest swings so far in the last bit of its position."""
MOST_EFFECTS = 3
WORDS = {"st": st, "inf": math.inf, "nan": math.nan}


@dataclass(frozen=True)
class Case:
    """A motor, how it starts, and in which steps it goes.

    Attributes
    ----------
    name : str
        Seed and number, which draw it again.
    motor : str
        What makes it, as a program writes it.
    effects : dict of str to dict of str to float
    position, velocity : float
    dt : float
    temperature : float or None
    """

    name: str
    motor: str
    effects: dict[str, dict[str, float]]
    position: float
    velocity: float
    dt: float
    temperature: float | None

    def potential(self, settings: dict[str, float], travelled: float) -> float:
        """The most that what acts beside the contact may give over such a way."""
        given = 2.0 * abs(settings["gravity_amplitude"]) + abs(settings["weight"]) * travelled
        for name, values in self.effects.items():
            if name == "torque_bias":
                given += abs(values["bias"]) * travelled
            elif name == "gravity_unbalance":
                given += 2.0 * math.hypot(values["cosine"], values["sine"])
            elif name == "cogging":
                given += 2.0 * math.hypot(values["cosine"], values["sine"]) / values["order"]
                given += 2.0 * math.hypot(values["cosine_2"], values["sine_2"]) / values["order_2"]
        return given

    def inertia_share(self) -> float:
        """Of the whole inertia, what moves with the motor and not with a mass behind it."""
        behind = [v["inertia_share"] for v in self.effects.values() if "inertia_share" in v]
        return 1.0 - min(sum(behind), 1.0)


def drawn(seed: int, number: int) -> Case:
    """A case of a seed."""
    name = f"{seed}.{number}"
    draw = Draw(f"undriven/{name}", wild=0.0)
    law = sorted(LAWS)[number % len(LAWS)]
    friction = draw.law(law) if draw.chance(0.7) else f"st.FrictionModel({law!r})"
    effects: dict[str, dict[str, float]] = {}
    servo = draw.chance(0.05)
    for effect in draw.random.sample(sorted(EFFECTS), draw.random.randint(1, MOST_EFFECTS)):
        specs = EFFECTS[effect].parameters
        stated = {p.name: float(draw.within(p)) for p in specs if draw.chance(0.8)}
        effects[effect] = {p.name: stated.get(p.name, p.default or 0.0) for p in specs}
    given = [draw.size(-4.0, 0.5), f"friction={friction}", f"effects={effects}"]
    if draw.chance(0.1):
        given.append(f"gravity_amplitude={draw.signed(-2.0, 0.5)}")
    if draw.chance(0.1):
        given.append(f"weight={draw.signed(-2.0, 0.5)}")
    if draw.chance(0.15):
        given.append("integrator='reference'")
    if servo:
        values = {name: float(draw.size(-1.0, 1.0)) for name in SERVO if draw.chance(0.7)}
        given.append(f"servo={values}")
    return Case(
        name,
        f"st.Motor({', '.join(given)})",
        effects,
        position=float(draw.signed(-3.0, 1.0)),
        velocity=float(draw.signed(-2.0, 2.0)),
        dt=10.0 ** draw.random.uniform(-5.0, -2.3),
        temperature=draw.random.uniform(-40.0, 150.0) if draw.chance(0.5) else None,
    )


def gain(case: Case) -> float | None:
    """Share of its energy that a motor gains, 0 or less where it does not.

    Returns
    -------
    float or None
        None where there is no such motor, where the law gives energy by its parameters and says
        so, or where the run is refused.
    """
    try:
        motor = eval(case.motor, dict(WORDS))
        motor.reset(case.position, case.velocity)
    except st.InputError:
        return None
    if not motor.friction.passive:
        return None
    try:
        run = motor.simulate(
            np.zeros(SAMPLES),
            case.dt,
            temperature=case.temperature,
            enabled=np.zeros(SAMPLES),
            outputs=["position", "velocity"],
        )
    except st.InputError as error:
        return math.inf if "ran away" in str(error) else None
    if not run.success:
        return math.inf
    settings = motor.settings()
    travelled = float(np.max(np.abs(run.position - case.position)))
    before = 0.5 * settings["inertia"] * case.velocity**2 + case.potential(settings, travelled)
    share = case.inertia_share()
    after = 0.5 * settings["inertia"] * share * float(np.max(np.abs(run.velocity))) ** 2
    # What the last bit of a position is of a spring, too.
    spring = motor.friction.parameters.get("initial_stiffness", 0.0)
    least = before * ROUND_OFF + NOTHING + 2.0 * spring * math.ulp(case.position) ** 2
    return (after - before - least) / max(before, sys.float_info.min)


def count(
    number: int, seed: int, seconds: float = math.inf
) -> tuple[int, list[tuple[Case, float]]]:
    """How many were run, and those that gained more than a step may."""
    gained, ran = [], 0
    until = time.monotonic() + seconds
    for k in range(number):
        if time.monotonic() > until:
            break
        case = drawn(seed, k)
        more = gain(case)
        if more is None:
            continue
        ran += 1
        if more > TOLERANCE:
            gained.append((case, more))
    return ran, gained


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.faults.undriven", description=__doc__)
    parser.add_argument("--number", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=math.inf, help="end after so long")
    parser.add_argument("--case", type=int, help="one number of the seed again")
    args = parser.parse_args()
    if args.case is not None:
        case = drawn(args.seed, args.case)
        print(case, gain(case))
        return 0
    ran, gained = count(args.number, args.seed, args.seconds)
    names: Counter[str] = Counter()
    for case, more in gained:
        names.update(list(case.effects))
        print(f"{case.name}: by {more:.3g}: {case}")
    print(f"{len(gained)} of {ran} gain energy (seed {args.seed})")
    print(", ".join(f"{name} {times}" for name, times in names.most_common()))
    return 1 if gained else 0


if __name__ == "__main__":
    sys.exit(main())
