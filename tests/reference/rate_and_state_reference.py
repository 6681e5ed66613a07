"""Rate-and-state friction by a general solver, in the friction coefficients of rock mechanics.

    F = N a asinh(V / (2 V_0) exp((mu_0 + b ln(V_0 theta / D_c)) / a)) + F_v V,
    d theta / dt = 1 - |V| theta / D_c                                  ageing, Dieterich 1979
    d theta / dt = -(|V| theta / D_c) ln(|V| theta / D_c)               slip, Ruina 1983

theta in seconds, carried as psi = ln theta; regularised as in Rice, Lapusta and Ranjith, J. Mech.
Phys. Solids 49 (2001), which is mu_0 + a ln(V / V_0) + b ln(V_0 theta / D_c) where that is
positive. Nothing is solved in closed form here. A body is carried by the asinh above, its own
velocity following from it: so nothing is steep.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

AGEING, SLIP = "ageing", "slip"
TIGHT = {"method": "LSODA", "rtol": 1e-11, "atol": 1e-12}


@dataclass(frozen=True, kw_only=True)
class RateAndState:
    """mu_0, a and b are coefficients; speed in m/s or rad/s, distance in m or rad, normal in N."""

    mu_0: float = 0.6
    a: float = 0.01
    b: float = 0.015
    speed: float = 1e-6
    distance: float = 1e-5
    normal: float = 1.0
    viscous: float = 0.0
    evolution: str = AGEING

    def psi_at(self, speed: float) -> float:
        """ln theta of a contact that slides steadily."""
        return math.log(self.distance / speed)

    def exponent(self, psi):
        """What the velocity is divided by, in logarithms."""
        return (self.mu_0 + self.b * (psi - math.log(self.distance / self.speed))) / self.a

    def dry(self, velocity, psi):
        """Friction without its viscous part; the logarithm of Dieterich where asinh is one."""
        z = abs(velocity) / (2.0 * self.speed)
        if z == 0.0:
            return 0.0
        large = math.log(z) + self.exponent(psi)
        value = large + math.log(2.0) if large > 30.0 else math.asinh(math.exp(large))
        return self.normal * self.a * math.copysign(value, velocity)

    def force(self, velocity, psi):
        return self.dry(velocity, psi) + self.viscous * velocity

    def steady(self, velocity):
        """Friction after a long slide at this velocity."""
        return self.force(velocity, self.psi_at(abs(velocity)))

    def rate(self, speed, psi):
        """d psi / dt."""
        if speed == 0.0:
            return math.exp(-psi) if self.evolution == AGEING else 0.0
        passed = speed / self.distance
        if self.evolution == AGEING:
            return math.exp(-psi) - passed
        return -passed * (math.log(passed) + psi)

    def velocity(self, z, psi):
        """Velocity whose dry friction is N a z."""
        size = 0.5 * (
            math.exp(abs(z) - self.exponent(psi)) - math.exp(-abs(z) - self.exponent(psi))
        )
        return 2.0 * self.speed * math.copysign(size, z)


def along(law: RateAndState, velocity, dt, *, psi=None):
    """Friction at the end of each sample of held velocity, and psi there.

    The contact has slid steadily at the reference speed unless psi says otherwise. A sample of
    velocity 0 has no friction of its own here: asinh(0) is 0.
    """
    psi = law.psi_at(law.speed) if psi is None else psi
    forces, states = [], []
    for v in velocity:
        speed = abs(float(v))
        run = solve_ivp(lambda _, y, u=speed: [law.rate(u, y[0])], (0.0, dt), [psi], **TIGHT)
        psi = float(run.y[0, -1])
        forces.append(law.force(float(v), psi))
        states.append(psi)
    return np.array(forces), np.array(states)


def carried(law: RateAndState, effort, sample_time, *, inertia, psi=None, spring=0.0):
    """A body at rest at first: position, velocity, friction and psi at the end of each sample.

    `effort` is held over each sample; `spring` pulls the body back to 0, N/m or N m/rad. The
    variable is z of `RateAndState.velocity`, so that dz/dt = (dV/dt + V d(exponent)/dt) / (dV/dz).
    """
    psi = law.psi_at(law.speed) if psi is None else psi
    state = [0.0, 0.0, psi]
    rows = []
    for u in np.asarray(effort, dtype=float).tolist():

        def rates(_, y, u=u):
            x, z, own = y
            v = law.velocity(z, own)
            slowing = (u - spring * x - law.normal * law.a * z - law.viscous * v) / inertia
            changing = law.rate(abs(v), own)
            steep = law.speed * (math.exp(z - law.exponent(own)) + math.exp(-z - law.exponent(own)))
            return v, (slowing + v * law.b / law.a * changing) / steep, changing

        run = solve_ivp(
            rates, (0.0, sample_time), state, "Radau", rtol=1e-8, atol=[1e-13, 1e-9, 1e-10]
        )
        if not run.success:
            raise RuntimeError(run.message)
        state = run.y[:, -1].tolist()
        x, z, own = state
        v = law.velocity(z, own)
        rows.append((x, v, law.normal * law.a * z + law.viscous * v, own))
    return dict(zip(("position", "velocity", "friction", "psi"), np.array(rows).T, strict=True))


def critical_stiffness(law: RateAndState) -> float:
    """Spring above which slow steady sliding is stable (Ruina 1983), N/m or N m/rad."""
    return law.normal * (law.b - law.a) / law.distance


def pulled(law: RateAndState, stiffness, speed, duration, *, kick=0.02, points=400):
    """A massless slider on a spring whose end moves at `speed`: time and ln(V/speed).

    It slides steadily at first, but for a state that is off by `kick` in ln theta. Without mass the
    spring's force is the friction: V follows from it.
    """
    psi = law.psi_at(speed) + kick
    force = law.steady(speed)

    def velocity(y):
        return law.velocity(y[0] / (law.normal * law.a), y[1])

    def rates(_, y):
        v = velocity(y)
        return stiffness * (speed - v), law.rate(abs(v), y[1])

    def runs_away(_, y):
        return math.log(max(velocity(y), 1e-300) / speed) - 5.0

    runs_away.terminal = True
    run = solve_ivp(
        rates,
        (0.0, duration),
        [force, psi],
        "Radau",
        t_eval=np.linspace(0.0, duration, points),
        events=runs_away,
        rtol=1e-9,
        atol=1e-12,
    )
    return run.t, np.array([math.log(velocity(y) / speed) for y in run.y.T])
