"""A driven body that sticks and slips, integrated from event to event.

    J x'' = drive(input) + cogging(x) - shaft - F,    J2 x2'' = shaft - D2 x2'

Dry contact: F = s (level(s) + fall(|v|)) + D v + Q |v| v while it slips towards s, and whatever
holds the body where it sticks. Slipping ends where the speed is 0, sticking where what drives
exceeds the level: both moments are found inside a step, by false position, and the next step begins
there. A bristle contact has no such events: z' = v - |v| z / deflection(v), F = K z + C z' + D v.

Between two samples the input is constant. Steps are those of Runge and Kutta, fourth order.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

__all__ = ["Controller", "Effects", "Machine", "Motion", "simulate"]

STICKS = 0
"""Neither of the directions +1 and -1."""
NEAR = 1e-12
"""s: an event this near to the end of a step is at its end."""
MOST_EVENTS = 40
"""In one step: beyond it, the body chatters about a point at which it rests."""
STEEPEST = 1.2
"""Step times the rate at which a bristle turns over; Runge-Kutta is stable below 2.8."""


@dataclass(frozen=True)
class Effects:
    """What may be hidden, each in a form of its own; neutral as they stand.

    Attributes
    ----------
    fall, fall_speed : float
        Stribeck: share of the dry level, speed; a Lorentz curve.
    quadratic : float
        Effort per squared speed.
    waves : tuple of (float, float, float)
        Efforts over position: amplitude, periods a rad (or a m), phase.
    asymmetry : float
        The dry level is (1 + asymmetry) times as high one way, (1 - asymmetry) the other.
    bias : float
        Constant effort.
    delay, lag : float
        s: of the input.
    dead : float
        Inputs up to it do nothing.
    largest : float
        Effort that the drive cannot exceed.
    shaft_share, shaft_stiffness, shaft_damping : float
        Part of the inertia on the far end of a shaft.
    gap : float
        Play of that shaft.
    """

    fall: float = 0.0
    fall_speed: float = 1.0
    quadratic: float = 0.0
    waves: tuple[tuple[float, float, float], ...] = ()
    asymmetry: float = 0.0
    bias: float = 0.0
    delay: float = 0.0
    lag: float = 0.0
    dead: float = 0.0
    largest: float = math.inf
    shaft_share: float = 0.0
    shaft_stiffness: float = 0.0
    shaft_damping: float = 0.0
    gap: float = 0.0


@dataclass(frozen=True)
class Machine:
    """Numbers of one machine, SI; rotary unless somebody reads them otherwise.

    `bristle` is the deflection, rad, at which a bristle contact slips; 0 is a dry contact. A drive
    of voltage has gain k/R and a `counter` k²/R that brakes.
    """

    inertia: float
    coulomb: float
    viscous: float
    gain: float = 1.0
    counter: float = 0.0
    bristle: float = 0.0
    weight: float = 0.0
    effects: Effects = field(default_factory=Effects)


class Motion(NamedTuple):
    """At each sample: position, velocity, and the effort that is hidden (of what no base has)."""

    position: list[float]
    velocity: list[float]
    hidden: list[float]


Controller = Callable[[int, float], float]
"""Input for sample k, from the true position there."""


class _Body:
    """Equations of motion of a machine, for the state that its parts need.

    The state is [x, v], then [z] of a bristle, [effort] of a lagging drive, [x2, v2] of a shaft.
    """

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        effects = machine.effects
        self.bristle = 2 if machine.bristle else 0
        self.lagging = 2 + bool(self.bristle) if effects.lag else 0
        self.shaft = 2 + bool(self.bristle) + bool(self.lagging) if effects.shaft_share else 0
        self.inertia = machine.inertia * (1.0 - effects.shaft_share)
        self.far_inertia = machine.inertia * effects.shaft_share
        self.side = STICKS
        self.commanded = 0.0

    def start(self, position: float) -> list[float]:
        state = [position, 0.0]
        state += [0.0] if self.bristle else []
        state += [0.0] if self.lagging else []
        return state + ([position, 0.0] if self.shaft else [])

    def effort_of(self, value: float) -> float:
        """Effort that the drive makes of an input, without its lag."""
        effects = self.machine.effects
        asked = value * self.machine.gain
        asked = math.copysign(max(abs(asked) - effects.dead, 0.0), asked)
        return max(-effects.largest, min(effects.largest, asked))

    def effort(self, state: list[float]) -> float:
        """All that acts on the body but its contact."""
        machine, effects = self.machine, self.machine.effects
        x, v = state[0], state[1]
        total = state[self.lagging] if self.lagging else self.commanded
        total += effects.bias - machine.counter * v
        if machine.weight:
            total -= machine.weight * math.sin(x)
        for amplitude, periods, phase in effects.waves:
            total += amplitude * math.sin(periods * x + phase)
        if self.shaft:
            total -= self.twist(state)
        return total

    def twist(self, state: list[float]) -> float:
        """Effort of the shaft on the far end; where it has play none of it is in touch inside."""
        effects = self.machine.effects
        bent = state[0] - state[self.shaft]
        half = 0.5 * effects.gap
        if abs(bent) <= half and half:
            return 0.0
        bent -= math.copysign(half, bent)
        spring = effects.shaft_stiffness * bent
        damped = spring + effects.shaft_damping * (state[1] - state[self.shaft + 1])
        # Faces that part do not pull.
        return damped if not half or damped * bent > 0.0 else 0.0

    def level(self, side: int, speed: float) -> float:
        """Dry friction towards a side."""
        effects = self.machine.effects
        dry = self.machine.coulomb
        falls = effects.fall / (1.0 + (speed / effects.fall_speed) ** 2) if effects.fall else 0.0
        return dry * (1.0 + side * effects.asymmetry + falls)

    def friction(self, state: list[float]) -> float:
        machine = self.machine
        v = state[1]
        smooth = machine.viscous * v + machine.effects.quadratic * abs(v) * v
        if not self.bristle:
            return self.side * self.level(self.side, abs(v)) + smooth
        z = state[self.bristle]
        stiffness = machine.coulomb / machine.bristle
        turned = v - stiffness * abs(v) * z / self.level(1 if v > 0.0 else -1, abs(v))
        damping = 0.4 * math.sqrt(stiffness * machine.inertia)
        return stiffness * z + damping * turned / (1.0 + (v / 0.1) ** 2) + smooth

    def rates(self, state: list[float]) -> list[float]:
        machine, effects = self.machine, self.machine.effects
        v = state[1]
        if self.side == STICKS and not self.bristle:
            rates = [0.0, 0.0]
        else:
            rates = [v, (self.effort(state) - self.friction(state)) / self.inertia]
        if self.bristle:
            stiffness = machine.coulomb / machine.bristle
            level = self.level(1 if v > 0.0 else -1, abs(v))
            rates.append(v - stiffness * abs(v) * state[self.bristle] / level)
        if self.lagging:
            rates.append((self.commanded - state[self.lagging]) / effects.lag)
        if self.shaft:
            far = self.twist(state) - 0.02 * machine.viscous * state[self.shaft + 1]
            rates += [state[self.shaft + 1], far / self.far_inertia]
        return rates

    def margin(self, state: list[float]) -> float:
        """Above 0 while the mode that the contact is in goes on."""
        if self.bristle:
            return 1.0
        if self.side != STICKS:
            return self.side * state[1]
        driven = self.effort(state)
        return self.level(1 if driven > 0.0 else -1, 0.0) - abs(driven)

    def switch(self, state: list[float]) -> None:
        """Into the mode that follows an event."""
        if self.side != STICKS:
            state[1] = 0.0
        driven = self.effort(state)
        side = 1 if driven > 0.0 else -1
        self.side = side if abs(driven) > self.level(side, 0.0) else STICKS


def _stepped(body: _Body, state: list[float], h: float) -> list[float]:
    """Runge and Kutta, fourth order."""
    a = body.rates(state)
    b = body.rates([x + 0.5 * h * r for x, r in zip(state, a, strict=True)])
    c = body.rates([x + 0.5 * h * r for x, r in zip(state, b, strict=True)])
    d = body.rates([x + h * r for x, r in zip(state, c, strict=True)])
    return [
        x + h / 6.0 * (p + 2.0 * (q + r) + s)
        for x, p, q, r, s in zip(state, a, b, c, d, strict=True)
    ]


def _advanced(body: _Body, state: list[float], h: float) -> list[float]:
    """The state a step later, through every event on the way."""
    if body.margin(state) < 0.0 or (body.side == STICKS and not body.bristle):
        body.switch(state)
    for _ in range(MOST_EVENTS):
        later = _stepped(body, state, h)
        if body.margin(later) >= 0.0:
            return later
        # False position, of the kind of Illinois: the end that stays counts half.
        low, high, at = 0.0, h, h
        below, above = max(body.margin(state), 0.0), body.margin(later)
        for _ in range(60):
            at = high - above * (high - low) / (above - below) if above < below else low
            if not low < at < high:
                at = 0.5 * (low + high)
            later = _stepped(body, state, at)
            now = body.margin(later)
            if high - low < NEAR or abs(now) < 1e-14:
                break
            if now < 0.0:
                high, above, below = at, now, 0.5 * below
            else:
                low, below, above = at, now, 0.5 * above
        was = body.side
        body.switch(later)
        if was == STICKS and body.side == STICKS:
            # It broke away by what rounding leaves.
            driven = body.effort(later)
            body.side = 1 if driven > 0.0 else -1
        state, h = later, h - at
        if h <= NEAR:
            return state
    body.side = STICKS
    state[1] = 0.0
    return state


def simulate(
    machine: Machine,
    controller: Controller,
    samples: int,
    dt: float,
    *,
    start: float = 0.0,
    finest: float = 5e-4,
) -> Motion:
    """The motion at each sample; the input that the controller gives there holds to the next one.

    Parameters
    ----------
    machine : Machine
    controller : callable
    samples : int
    dt : float
        s, between two samples.
    start : float
        Position, at rest.
    finest : float
        s: longest step.
    """
    body = _Body(machine)
    state = body.start(start)
    effects = machine.effects
    rings = effects.shaft_share > 0.0
    if rings:
        near = body.inertia * body.far_inertia / machine.inertia
        finest = min(finest, 0.25 / math.sqrt(effects.shaft_stiffness / near))
    whole, part = divmod(effects.delay / dt, 1.0)
    held = [0.0] * (int(whole) + 2)
    position, velocity, hidden = [], [], []
    for k in range(samples):
        position.append(state[0])
        velocity.append(state[1])
        held.append(controller(k, state[0]))
        del held[0]
        pieces = [(dt, held[-1 - int(whole)])]
        if part:
            pieces = [(part * dt, held[-2 - int(whole)]), ((1.0 - part) * dt, pieces[0][1])]
        missing = 0.0
        for length, value in pieces:
            body.commanded = body.effort_of(value)
            steps = max(1, math.ceil(length / finest))
            if body.bristle:
                # It turns over as fast as the body may be by the end of this.
                gained = length * (abs(body.commanded) + machine.coulomb) / body.inertia
                turning = (abs(state[1]) + gained) / machine.bristle
                steps = max(steps, math.ceil(length * turning / STEEPEST))
            for _ in range(steps):
                state = _advanced(body, state, length / steps)
            missing += length / dt * _hidden(body, state, held[-1])
        hidden.append(missing)
    return Motion(position, velocity, hidden)


def _hidden(body: _Body, state: list[float], asked: float) -> float:
    """Effort that acts and that the machine without effects would not have."""
    machine, effects = body.machine, body.machine.effects
    v = state[1]
    acting = state[body.lagging] if body.lagging else body.commanded
    missing = acting - machine.gain * asked + effects.bias
    missing += sum(a * math.sin(n * state[0] + p) for a, n, p in effects.waves)
    missing -= effects.quadratic * abs(v) * v
    side = (v > 0.0) - (v < 0.0)
    missing -= side * (body.level(side, abs(v)) - machine.coulomb) if side else 0.0
    if body.shaft:
        far = body.twist(state)
        # What is missed is that the far end moves otherwise than the near one.
        rates = body.rates(state)
        missing -= far - body.far_inertia * rates[1]
    return missing
