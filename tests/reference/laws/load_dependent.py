"""Friction of servo gears, in the words of the published models M1 to M6 (Duclusaud et al. 2025).

Efforts of the gear stand as there: `motor` from one side, `external` from the other, both positive
along +x. A body is carried on from one zero of its velocity to the next by solve_ivp.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from tests.reference.golden import Golden

GOLDEN = Golden(
    reach=0.01,
    speed=0.3,
    share=1e-12,
    parameters={
        "coulomb": 0.35,
        "breakaway": 0.5,
        "drive": 0.2,
        "back_drive": 0.3,
        "drive_stribeck": 0.05,
        "back_drive_stribeck": 0.1,
        "drive_quadratic": 0.02,
        "back_drive_quadratic": 0.03,
        "stribeck_velocity": 0.05,
        "stribeck_exponent": 1.5,
        "viscous": 0.05,
    },
)


@dataclass(frozen=True)
class Gear:
    """Parameters by their published names; model M6, the others where some are 0."""

    friction_base: float = 0.0
    friction_stribeck: float = 0.0
    load_friction_motor: float = 0.0
    load_friction_external: float = 0.0
    load_friction_motor_stribeck: float = 0.0
    load_friction_external_stribeck: float = 0.0
    load_friction_motor_quad: float = 0.0
    load_friction_external_quad: float = 0.0
    dtheta_stribeck: float = 0.1
    alpha: float = 2.0
    friction_viscous: float = 0.0

    def dry(self, motor, external, speed):
        """The greatest dry friction at these efforts and this speed."""

        def transmitted(of_motor, of_external):
            return max(s * (of_external * external - of_motor * motor) for s in (1.0, -1.0))

        still = self.friction_stribeck + transmitted(
            self.load_friction_motor_stribeck, self.load_friction_external_stribeck
        )
        if motor * external < 0.0:
            # Only what comes through from the weaker side counts, squared.
            size, coefficient = min(
                (abs(external), self.load_friction_external_quad),
                (abs(motor), self.load_friction_motor_quad),
                key=lambda side: side[0],
            )
            still += coefficient * size**2
        gone = 1.0 - np.exp(-((abs(speed) / self.dtheta_stribeck) ** self.alpha))
        base = self.friction_base + transmitted(
            self.load_friction_motor, self.load_friction_external
        )
        return base + still - gone * still

    @property
    def parameters(self):
        """The same gear by the names of the core."""
        return {
            "coulomb": self.friction_base,
            "breakaway": self.friction_base + self.friction_stribeck,
            "drive": self.load_friction_motor,
            "back_drive": self.load_friction_external,
            "drive_stribeck": self.load_friction_motor_stribeck,
            "back_drive_stribeck": self.load_friction_external_stribeck,
            "drive_quadratic": self.load_friction_external_quad,
            "back_drive_quadratic": self.load_friction_motor_quad,
            "stribeck_velocity": self.dtheta_stribeck,
            "stribeck_exponent": self.alpha,
            "viscous": self.friction_viscous,
        }


def gear(**parameters):
    """A gear from the names of the core."""
    return Gear(
        friction_base=parameters["coulomb"],
        friction_stribeck=parameters["breakaway"] - parameters["coulomb"],
        load_friction_motor=parameters["drive"],
        load_friction_external=parameters["back_drive"],
        load_friction_motor_stribeck=parameters["drive_stribeck"],
        load_friction_external_stribeck=parameters["back_drive_stribeck"],
        load_friction_motor_quad=parameters["back_drive_quadratic"],
        load_friction_external_quad=parameters["drive_quadratic"],
        dtheta_stribeck=parameters["stribeck_velocity"],
        alpha=parameters["stribeck_exponent"],
        friction_viscous=parameters["viscous"],
    )


def along(velocity, dt, *, motor=0.0, external=0.0, **parameters):
    """Friction at the end of each sample; where it rests, what it holds of both efforts."""
    law = gear(**parameters)
    shape = np.shape(velocity)
    friction = []
    for v, m, e in zip(
        velocity, np.broadcast_to(motor, shape), np.broadcast_to(external, shape), strict=True
    ):
        greatest = law.dry(m, e, v)
        held = float(np.clip(m + e, -greatest, greatest))
        friction.append(np.sign(v) * greatest + law.friction_viscous * v if v else held)
    return np.array(friction)


def carried(law, motor, dt, *, inertia, gravity=0.0, load=0.0):
    """Position and velocity of a pendulum at the end of each sample of held motor effort."""
    position, velocity, rows = 0.0, 0.0, []
    for m in motor:
        left = dt
        while left > 0.0:
            external = load - gravity * np.sin(position)
            if velocity == 0.0 and abs(m + external) <= law.dry(m, external, 0.0):
                break
            side = np.sign(velocity if velocity else m + external)

            def rate(_, y, m=m, side=side):
                external = load - gravity * np.sin(y[0])
                friction = side * law.dry(m, external, y[1]) + law.friction_viscous * y[1]
                return (y[1], (m + external - friction) / inertia)

            def stops(t, y, side=side):
                # Positive at the start of a slide from rest, which is no stop.
                return side * y[1] if t > 0.0 else 1.0

            stops.terminal, stops.direction = True, -1.0
            run = solve_ivp(
                rate, (0.0, left), (position, velocity), events=stops, rtol=1e-11, atol=1e-14
            )
            position, velocity = run.y[:, -1]
            if run.status == 1:
                velocity = 0.0
            left -= run.t[-1]
        rows.append((position, velocity))
    return np.array(rows).T
