"""The complete Hsieh-Pan machine, hook included, with located events.

Sticking obeys `hsieh_pan_reference`. The hook lets go when |sigma| reaches the break-away
force while the body moves in the direction s of sigma, and F_b = F_break is latched. The
paper stops at sticking; the sliding law is ours:

    d|sigma|/dx = (T - |sigma|) / l,
    T = F_c + (F_b - F_c) exp(-|v / v_s|^delta) + F_v |v|,       v the body's speed,
    x_s = V^-1(sigma),  x_p and h at rest,  x_hook = x - x_p - x_s,  damper off.

The hook catches again when the body's velocity returns to zero, or when the hook would
move backwards, that is when the spring asks for more than the whole of the body's motion:
(T - |sigma|) / l > V'(x_s). The force is continuous; the spring stands on its virgin
curve with nothing remembered; hardening is reset, or kept by `after_slip="keep"`.

One case needs a rule of its own. At a speed where F_v |v| lifts T above the break-away
level, a hook that would move backwards cannot stick, because |sigma| >= F_break would let
it go again at once. There the hook stands still while it slides: d|sigma|/dx = V'(x_s)
until T is reached. It catches only below F_break.

The rate-dependent break-away force uses q' = (sigma - q) / tau in both modes:
F_break = F_c + (F_s - F_c) exp(-r / r_0), r = |sigma - q| / tau.

Each stretch between two events is one call of scipy's `solve_ivp`. A turning point of x_s
is an event too: there the ladder is moved, so that between events its force is a straight
move from a fixed state and the right-hand side is a function of the present alone.

V' is taken from the curve and V^-1 from the ladder's broken line, so x_hook carries the
ladder's discretisation error, `virgin_error_bound() / k_inf`, while it slips.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from .hsieh_pan_reference import HsiehPanParameters, Trajectory

STICK_TOLERANCE = {"rtol": 1e-10, "atol": [1e-14, 1e-11, 1e-14, 1e-14, 1e-11]}
SLIP_TOLERANCE = {"rtol": 1e-10, "atol": [1e-14, 1e-11, 1e-11, 1e-11]}
# A turning point nearer than this to the start of a stretch counts as passed already, s.
TURNING_TIME = 1e-12
# A hook that has just let go stands at F_break to this relative accuracy.
BREAKING = 1e-9
REST = 1e-300  # rad/s, any positive number below every real speed


def _event(function, direction):
    function.terminal = True
    function.direction = direction
    return function


class HookedMachine:
    """Body on the complete contact, or a contact moved at a prescribed velocity.

    Attributes
    ----------
    position, velocity, plastic, hardening, hook : float
        x, x', x_p, h, x_hook.
    spring_force, filtered_force : float
        sigma and q.
    mode : int
        0 sticking, +1 or -1 slipping.
    events : list of (time, kind, spring_force, velocity)
        kind is "break-away", "velocity zero" or "hook reversal".
    """

    def __init__(self, *, prescribed_motion=False, slip_method="DOP853", **parameters):
        self.parameters = HsiehPanParameters(**parameters)
        self.spring = self.parameters.spring()
        self.prescribed_motion = prescribed_motion
        self.slip_method = slip_method
        self.time = self.position = self.velocity = self.plastic = self.hardening = 0.0
        self.hook = self.filtered_force = self.latched_breakaway = 0.0
        self.spring_force = 0.0
        self.mode = 0
        self.events = []

    @property
    def friction(self):
        damper = self.parameters.damping * self.velocity if self.mode == 0 else 0.0
        return self.spring_force + damper

    @property
    def spring_extension(self):
        return self.position - self.plastic - self.hook

    def advance(self, end, effort):
        """Integrate to the time `end`; effort(t, x, v) is u + load in N m."""
        while self.time < end:
            if self.mode == 0 and self._must_break():
                self._break_away()
            elif self.mode and self._must_catch():
                self._catch("hook reversal")
            if self.mode == 0:
                self._stick(end, effort)
            else:
                self._slip(end, effort)

    def follow(self, end, velocity):
        """Move the body at a constant velocity until the time `end`."""
        self.velocity = velocity
        if self.mode and self.mode * velocity <= 0.0:
            self._catch("velocity zero")
        self.advance(end, None)

    def _acceleration(self, t, x, v, force, effort):
        if self.prescribed_motion:
            return 0.0
        return (effort(t, x, v) - force) / self.parameters.inertia

    def _filter_rate(self, sigma, q):
        return (sigma - q) / self.parameters.loading_rate_time

    def _overload(self, sigma, q):
        """|sigma| / F_break - 1."""
        return abs(sigma) / self.parameters.breakaway_now(sigma, q) - 1.0

    def _must_break(self):
        overload = self._overload(self.spring_force, self.filtered_force)
        return overload >= 0.0 and self.spring_force * self.velocity > 0.0

    def _must_catch(self):
        """Whether a jump of a prescribed velocity has left the hook wanting to go backwards."""
        overload = self._overload(self.spring_force, self.filtered_force)
        wanted, allowed = self._demand(self.velocity, abs(self.spring_force))
        return wanted > allowed and overload < -BREAKING

    def _demand(self, velocity, size):
        """(T - |sigma|) / l, and V', the most that the virgin curve allows."""
        p = self.parameters
        gap = p.sliding_force(velocity, self.latched_breakaway) - size
        return gap / p.slip_distance, p.virgin_slope(self.spring.virgin_inverse(size))

    def _break_away(self):
        sigma = self.spring_force
        self.latched_breakaway = self.parameters.breakaway_now(sigma, self.filtered_force)
        self.mode = 1 if sigma > 0.0 else -1
        self.events.append((self.time, "break-away", sigma, self.velocity))

    def _catch(self, kind):
        self.events.append((self.time, kind, self.spring_force, self.velocity))
        self.mode = 0
        self.spring.load_virgin(self.spring_force)
        self.hook = self.position - self.plastic - self.spring.displacement
        if self.parameters.after_slip == "reset":
            self.hardening = 0.0

    def _stick(self, end, effort):
        p, spring, hook, start = self.parameters, self.spring, self.hook, self.spring.displacement

        def rates(t, y):
            x, v, x_p, h, q = y.tolist()
            sigma = spring.force_after(x - hook - x_p - start)
            creep = p.plastic_rate(sigma, h)
            force = sigma + p.damping * v
            acceleration = self._acceleration(t, x, v, force, effort)
            return (v, acceleration, creep, abs(creep), self._filter_rate(sigma, q))

        y = np.array(
            [self.position, self.velocity, self.plastic, self.hardening, self.filtered_force]
        )
        first = rates(self.time, y)
        turning = first[0] - first[2]
        soon = turning * first[1] < 0.0 and abs(turning) < TURNING_TIME * abs(first[1])
        direction = math.copysign(1.0, first[1] if soon or turning == 0.0 else turning)

        def spring_turns(t, y):
            rate = rates(t, y)
            onward = direction * (rate[0] - rate[2])
            return onward if onward != 0.0 else REST  # a spring at rest has not turned

        def hook_lets_go(t, y):
            x, v, x_p, _, q = y.tolist()
            sigma = spring.force_after(x - hook - x_p - start)
            return min(self._overload(sigma, q), math.copysign(1.0, sigma) * v)

        events = [_event(spring_turns, -1)]
        if math.isfinite(p.breakaway):
            events.append(_event(hook_lets_go, 1))
        run = solve_ivp(rates, (self.time, end), y, "DOP853", events=events, **STICK_TOLERANCE)
        self._take_time(run, end)
        (self.position, self.velocity, self.plastic, self.hardening, self.filtered_force) = run.y[
            :, -1
        ].tolist()
        self.spring_force = spring.advance(self.spring_extension - start)
        if len(events) == 2 and run.t_events[1].size:
            self._break_away()

    def _slip(self, end, effort):
        s = self.mode

        def rates(t, y):
            x, v, sigma, q = y.tolist()
            slope = min(self._demand(v, s * sigma))
            return (
                v,
                self._acceleration(t, x, v, sigma, effort),
                slope * v,
                self._filter_rate(sigma, q),
            )

        def velocity_zero(t, y):
            return s * y[1]

        def hook_reverses(t, y):
            _, v, sigma, q = y.tolist()
            wanted, allowed = self._demand(v, s * sigma)
            return max(1.0 - wanted / allowed, self._overload(sigma, q))

        y = np.array([self.position, self.velocity, self.spring_force, self.filtered_force])
        run = solve_ivp(
            rates,
            (self.time, end),
            y,
            self.slip_method,
            events=[_event(velocity_zero, -1), _event(hook_reverses, -1)],
            **SLIP_TOLERANCE,
        )
        self._take_time(run, end)
        self.position, self.velocity, self.spring_force, self.filtered_force = run.y[:, -1].tolist()
        self.hook = self.position - self.plastic - self.spring.virgin_inverse(self.spring_force)
        if run.t_events[0].size:
            self.velocity = 0.0
            self._catch("velocity zero")
        elif run.t_events[1].size:
            self._catch("hook reversal")

    def _take_time(self, run, end):
        if not run.success:
            raise RuntimeError(f"integration stopped at t = {run.t[-1]}: {run.message}")
        self.time = end if run.status == 0 else float(run.t[-1])

    def record(self, trajectory):
        trajectory.append(
            time=self.time,
            position=self.position,
            velocity=self.velocity,
            friction=self.friction,
            spring_force=self.spring_force,
            plastic=self.plastic,
            hardening=self.hardening,
            spring=self.spring_extension,
            hook=self.hook,
            mode=self.mode,
        )


def simulate_with_events(effort, sample_time, *, load=0.0, machine=None, **parameters):
    """As `simulate_sticking`, with break-away and slip; returns (Trajectory, machine).

    `machine.events` lists every break-away and every catch with its located time.
    """
    effort = np.asarray(effort, dtype=float)
    total = effort + np.broadcast_to(load, effort.shape)
    machine = machine or HookedMachine(**parameters)
    start, out = machine.time, Trajectory()
    for k, u in enumerate(total.tolist()):
        machine.advance(start + (k + 1) * sample_time, lambda t, x, v, u=u: u)
        machine.record(out)
    return out.arrays(), machine


def follow_motion_with_events(velocity, sample_time, *, machine=None, **parameters):
    """Contact force of a body moved at sampled velocity; returns (Trajectory, machine)."""
    machine = machine or HookedMachine(prescribed_motion=True, **parameters)
    start, out = machine.time, Trajectory()
    for k, v in enumerate(np.asarray(velocity, dtype=float).tolist()):
        machine.follow(start + (k + 1) * sample_time, v)
        machine.record(out)
    return out.arrays(), machine


def pulled_mass(speed, *, spring_stiffness=20.0, duration=5.0, sample_time=0.01, **parameters):
    """The body pulled from rest through a spring whose far end moves at a constant speed.

    u = K (V t - x) stands in the right-hand side and is never held. Output is taken every
    `sample_time`; the events are located independently of it. Returns (Trajectory, machine).
    """
    machine = HookedMachine(**parameters)
    out = Trajectory()

    def pull(t, x, v):
        return spring_stiffness * (speed * t - x)

    for k in range(round(duration / sample_time)):
        machine.advance((k + 1) * sample_time, pull)
        machine.record(out)
    return out.arrays(), machine
