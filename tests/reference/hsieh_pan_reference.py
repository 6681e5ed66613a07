"""The Hsieh-Pan machine while its hook sticks, by a fixed-step Runge-Kutta method.

A body of inertia J is held by a plastic module and a nonlinear spring in series and
a damper beside them (Hsieh and Pan, Wear 242 (2000) 1-17, Fig. 9b):

    J x'' = u + load - F,             F = C_s x' + sigma,
    x = x_hook + x_p + x_s,           sigma = S(x_s, history),
    h'   = alpha (f(|sigma|) - h)     where that is positive, else 0,
    x_p' = sgn(sigma) h',             f(s) = c s^n.

sigma is the force through the series, not the applied effort. The spring S is the ladder
of `ladder_spring`. The plastic equations stand in the paper in words; their form here is
a reconstruction, as is the exponential curve of the spring.

The hook that lets go is in `hook_reference`, which shares the parameters of this module.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from .ladder_spring import LadderSpring, branch_slope

ARC_SECOND = math.pi / (180.0 * 3600.0)  # rad


@dataclass(frozen=True, kw_only=True)
class HsiehPanParameters:
    """Parameters of the machine, rotary units in the comments.

    The defaults down to `damping` are the illustrative rig: plausible numbers for a direct-drive
    torque motor, not those of the paper's authors.
    """

    inertia: float = 0.0076  # J, kg m^2
    initial_stiffness: float = 3000.0  # k_0, N m/rad
    final_stiffness: float = 800.0  # k_inf, N m/rad
    decay_distance: float = 60.0 * ARC_SECOND  # d_0, rad
    hardening_coefficient: float = 1.6e-3  # c, rad/(N m)^n
    hardening_exponent: float = 2.0  # n
    creep_rate: float = 2.0  # alpha, 1/s
    damping: float = 0.45  # C_s, N m s/rad
    breakaway: float = math.inf  # F_s, N m; inf never slips
    coulomb: float = math.nan  # F_c, N m; default .7 F_s
    stribeck_velocity: float = 0.01  # v_s, rad/s
    stribeck_exponent: float = 2.0  # delta
    viscous: float = 0.0  # F_v, N m s/rad, while slipping
    slip_distance: float = 1e-4  # l, rad
    loading_rate_scale: float = math.inf  # r_0, N m/s; inf: constant break-away
    loading_rate_time: float = 0.1  # tau, s
    after_slip: str = "reset"  # hardening when the hook sticks again: "reset" or "keep"
    elements: int = 512  # of the ladder

    def __post_init__(self):
        if self.hardening_exponent <= 1.0:
            raise ValueError("f'(0) = 0 asks for hardening_exponent > 1")
        if self.after_slip not in ("reset", "keep"):
            raise ValueError(f"after_slip is 'reset' or 'keep', not {self.after_slip!r}")
        if math.isnan(self.coulomb):
            object.__setattr__(self, "coulomb", 0.7 * self.breakaway)

    def spring(self):
        """A virgin ladder with this curve."""
        return LadderSpring(
            initial_stiffness=self.initial_stiffness,
            final_stiffness=self.final_stiffness,
            decay_distance=self.decay_distance,
            elements=self.elements,
        )

    def possible_hardening(self, force):
        """f(s) = c s^n, the maximum possible work hardening of a force of size s, rad."""
        return self.hardening_coefficient * abs(force) ** self.hardening_exponent

    def plastic_rate(self, force, hardening):
        """x_p', rad/s; h' is its absolute value."""
        excess = self.possible_hardening(force) - hardening
        return math.copysign(self.creep_rate * excess, force) if excess > 0.0 else 0.0

    def virgin_slope(self, spring_extension):
        """V'(x_s) = G'(2 |x_s|), N m/rad."""
        return float(
            branch_slope(
                2.0 * abs(spring_extension),
                self.initial_stiffness,
                self.final_stiffness,
                self.decay_distance,
            )
        )

    def breakaway_now(self, force, filtered_force):
        """F_break = F_c + (F_s - F_c) exp(-r / r_0), r = |sigma - q| / tau."""
        if math.isinf(self.loading_rate_scale) or math.isinf(self.breakaway):
            return self.breakaway
        rate = abs(force - filtered_force) / self.loading_rate_time
        gap = self.breakaway - self.coulomb
        return self.coulomb + gap * math.exp(-rate / self.loading_rate_scale)

    def sliding_force(self, velocity, latched_breakaway):
        """T(v) = F_c + (F_b - F_c) exp(-|v / v_s|^delta) + F_v |v|."""
        speed = abs(velocity)
        fall = math.exp(-((speed / self.stribeck_velocity) ** self.stribeck_exponent))
        gap = latched_breakaway - self.coulomb
        return self.coulomb + gap * fall + self.viscous * speed


@dataclass
class Trajectory:
    """One value per input sample, each taken at the end of that sample.

    time s; position, plastic (x_p), spring (x_s), hardening (h), hook rad; velocity rad/s;
    friction (F) and spring_force (sigma) N m; mode 0 sticking, +1 or -1 slipping.
    """

    time: list = field(default_factory=list)
    position: list = field(default_factory=list)
    velocity: list = field(default_factory=list)
    friction: list = field(default_factory=list)
    spring_force: list = field(default_factory=list)
    plastic: list = field(default_factory=list)
    hardening: list = field(default_factory=list)
    spring: list = field(default_factory=list)
    hook: list = field(default_factory=list)
    mode: list = field(default_factory=list)

    def append(self, **values):
        for name, value in values.items():
            getattr(self, name).append(value)

    def arrays(self):
        """The same with every list made an array."""
        return Trajectory(**{name: np.asarray(value) for name, value in vars(self).items()})


class StickingMachine:
    """Body on the Hsieh-Pan contact with the hook stuck at zero; classical RK4.

    The stages evaluate the ladder read-only from its state at the start of the step; the
    ladder is moved once, when the step is accepted.
    """

    def __init__(self, **parameters):
        self.parameters = HsiehPanParameters(**parameters)
        self.spring = self.parameters.spring()
        self.time = 0.0
        self.position = self.velocity = self.plastic = self.hardening = 0.0

    @property
    def spring_force(self):
        return self.spring.force()

    @property
    def friction(self):
        return self.parameters.damping * self.velocity + self.spring.force()

    def _rates(self, effort, x, v, x_p, h):
        p = self.parameters
        sigma = self.spring.force_after(x - x_p - self.spring.displacement)
        creep = p.plastic_rate(sigma, h)
        return v, (effort - p.damping * v - sigma) / p.inertia, creep, abs(creep)

    def _accept(self, position, velocity, plastic, hardening, step):
        self.position, self.velocity = position, velocity
        self.plastic, self.hardening = plastic, hardening
        self.spring.advance(position - plastic - self.spring.displacement)
        self.time += step

    def advance(self, effort, step):
        """One step of length `step` (s) under the constant total effort u + load (N m)."""
        state = (self.position, self.velocity, self.plastic, self.hardening)
        self._accept(*_runge_kutta(lambda *y: self._rates(effort, *y), state, step), step)

    def follow(self, velocity, step):
        """One step with the body moved at a given constant velocity (rad/s)."""

        def rates(x, v, x_p, h):
            _, _, creep, hardening_rate = self._rates(0.0, x, v, x_p, h)
            return v, 0.0, creep, hardening_rate

        state = (self.position, velocity, self.plastic, self.hardening)
        self._accept(*_runge_kutta(rates, state, step), step)

    def record(self, trajectory):
        trajectory.append(
            time=self.time,
            position=self.position,
            velocity=self.velocity,
            friction=self.friction,
            spring_force=self.spring_force,
            plastic=self.plastic,
            hardening=self.hardening,
            spring=self.spring.displacement,
            hook=0.0,
            mode=0,
        )


def _runge_kutta(rates, y, step):
    k1 = rates(*y)
    k2 = rates(*(a + step / 2.0 * b for a, b in zip(y, k1, strict=True)))
    k3 = rates(*(a + step / 2.0 * b for a, b in zip(y, k2, strict=True)))
    k4 = rates(*(a + step * b for a, b in zip(y, k3, strict=True)))
    return tuple(
        a + step / 6.0 * (p + 2.0 * q + 2.0 * r + s)
        for a, p, q, r, s in zip(y, k1, k2, k3, k4, strict=True)
    )


def simulate_sticking(effort, sample_time, *, load=0.0, step=5e-5, machine=None, **parameters):
    """Drive a sticking machine with sampled effort.

    Parameters
    ----------
    effort : array_like, shape (n,)
        u in N m; row k holds from k * sample_time to (k + 1) * sample_time.
    sample_time : float
        s. Each sample is divided into equal steps no longer than `step`.
    load : float or array_like, shape (n,)
        External effort along +x, N m.
    machine : StickingMachine, optional
        Continued from its present state; otherwise a virgin one is built from `parameters`.

    Returns
    -------
    Trajectory
        Row k is the state at (k + 1) * sample_time.
    """
    effort = np.asarray(effort, dtype=float)
    total = effort + np.broadcast_to(load, effort.shape)
    machine = machine or StickingMachine(**parameters)
    substeps = max(1, math.ceil(sample_time / step - 1e-9))
    out = Trajectory()
    for u in total:
        for _ in range(substeps):
            machine.advance(float(u), sample_time / substeps)
        machine.record(out)
    return out.arrays()


def follow_motion(velocity, sample_time, *, step=5e-5, machine=None, **parameters):
    """Friction of a body moved at sampled velocity, held over each sample; row k as above."""
    machine = machine or StickingMachine(**parameters)
    substeps = max(1, math.ceil(sample_time / step - 1e-9))
    out = Trajectory()
    for v in np.asarray(velocity, dtype=float):
        for _ in range(substeps):
            machine.follow(float(v), sample_time / substeps)
        machine.record(out)
    return out.arrays()
