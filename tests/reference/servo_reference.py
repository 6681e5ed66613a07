"""A servo that holds a pendulum, apart from the product: semi-implicit Euler at a tiny step.

    J q'' = tau - m g l sin(q) - F,  tau = k clip((V d - k q') / R, +-I)
    d = clip(P (goal - q), +-D)

Dry friction stops the arm where it can within a step, and what is left of it accelerates. Off, the
motor is open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

GRAVITY = 9.80665


@dataclass
class Servo:
    """A machine; SI units throughout."""

    constant: float = 0.4
    resistance: float = 3.5
    supply: float = 7.4
    proportional: float = 1.2
    duty_limit: float = 1.0
    current_limit: float = np.inf
    inertia: float = 0.002
    mass: float = 0.3
    length: float = 0.1
    coulomb: float = 0.02
    viscous: float = 0.004
    late: int = 0  # samples by which the goal arrives late
    fastest: float = np.inf  # rad/s, greatest speed of the goal in the servo, in every tiny step
    gear_loss: float = 0.0  # dry friction per torque that the arm's weight puts on the gears
    tremble: float = 0.0  # N m, of a torque that is drawn anew in every sample
    seed: int = 0
    tardy: float = 0.0  # share of a sample by which the goal arrives late
    cold: float = 0.0  # share of the dry friction that is lost as the machine warms up
    warming: float = 10.0  # s, in which it warms up

    def run(self, goal, dt, start=0.0, enabled=None, substeps=400, clock=0.0):
        """Position at the end of each sample whose goal is held; dt of each, or of all of them.

        `clock` is the time since the machine was switched on, s.
        """
        total = self.inertia + self.mass * self.length**2
        steps = np.broadcast_to(dt, len(goal))
        tardy = round(self.tardy * substeps)
        q, w = start, 0.0
        arrived = np.concatenate([np.zeros(self.late), goal])[: len(goal)]
        reached = np.empty(len(goal))
        wanted = arrived[0]
        shaken = self.tremble * np.random.default_rng(self.seed).standard_normal(len(goal))
        for k, target in enumerate(arrived):
            on = enabled is None or enabled[k]
            h = steps[k] / substeps
            dry = self.coulomb * (1.0 + self.cold * np.exp(-clock / self.warming))
            clock += steps[k]
            for place in range(substeps):
                asked = target if place >= tardy else arrived[max(k - 1, 0)]
                wanted += max(-self.fastest * h, min(self.fastest * h, asked - wanted))
                duty = max(-self.duty_limit, min(self.duty_limit, self.proportional * (wanted - q)))
                current = (self.supply * duty - self.constant * w) / self.resistance
                current = max(-self.current_limit, min(self.current_limit, current))
                torque = self.constant * current if on else 0.0
                weight = self.mass * GRAVITY * self.length * np.sin(q)
                torque += shaken[k] - weight - self.viscous * w
                free = w + h * torque / total
                slowed = h * (dry + self.gear_loss * abs(weight)) / total
                w = 0.0 if abs(free) <= slowed else free - np.copysign(slowed, free)
                q += h * w
            reached[k] = q
        return reached
