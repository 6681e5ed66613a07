"""Contacts of the reference plant, many lanes side by side.

A lane is one machine in one recording; arrays end in the axis of lanes. A contact is moved by
`advance(dx)` and then holds in `force` what it answers at level 1 (N m, positive against
positive motion). A level L scales forces at fixed displacement: F = L force + damping v.

`settle(momentum, effort, level)` returns L force, the mean over the step. A dry contact needs the
momentum of the body per step (J v / h, N m) and the other efforts for it, to find out whether
and when within the step the body comes to rest.
"""

from __future__ import annotations

import numpy as np


class LadderContact:
    """Elasto-slide elements in parallel: element i carries k_i e_i, |e_i| <= y_i, e_i += dx."""

    def __init__(self, *, stiffness, slip_distance, viscous):
        self.stiffness = np.ascontiguousarray(stiffness, dtype=float)  # N m/rad, (elements, lanes)
        self.slip_distance = np.ascontiguousarray(slip_distance, dtype=float)  # rad
        self.viscous = np.asarray(viscous, dtype=float)  # N m s/rad
        self.damping = self.viscous
        self.limit = (self.stiffness * self.slip_distance).sum(axis=0)
        self.extension = np.zeros_like(self.stiffness)
        self.force = np.zeros(self.stiffness.shape[1])
        self._below = -self.slip_distance
        self._work = np.empty_like(self.stiffness)

    @classmethod
    def of_lanes(cls, plants):
        """One lane for each dictionary of parameters."""
        return cls(
            stiffness=np.stack([p["stiffness"] for p in plants], axis=-1),
            slip_distance=np.stack([p["slip_distance"] for p in plants], axis=-1),
            viscous=[p["viscous"] for p in plants],
        )

    def advance(self, dx):
        e = self.extension
        np.add(e, dx, out=e)
        np.minimum(e, self.slip_distance, out=e)
        np.maximum(e, self._below, out=e)
        np.multiply(e, self.stiffness, out=self._work)
        np.add.reduce(self._work, axis=0, out=self.force)

    def settle(self, momentum, effort, level):
        return level * self.force

    def viscous_share(self, share):
        """Damping added by a share of viscous friction."""
        return self.viscous * share

    def stored_energy(self):
        """J, for each lane."""
        return 0.5 * (self.stiffness * self.extension**2).sum(axis=0)


class DryContact:
    """Coulomb friction with a true stick: at rest it holds whatever is asked, up to L F_c."""

    def __init__(self, *, coulomb, viscous):
        self.limit = np.asarray(coulomb, dtype=float)  # N m
        self.viscous = np.asarray(viscous, dtype=float)
        self.damping = self.viscous
        self.force = np.zeros_like(self.limit)

    @classmethod
    def of_lanes(cls, plants):
        return cls(coulomb=[p["coulomb"] for p in plants], viscous=[p["viscous"] for p in plants])

    def advance(self, dx):
        """Nothing moves: there is no displacement in this contact."""

    def settle(self, momentum, effort, level):
        bound = level * self.limit
        side = np.sign(momentum)
        held = np.minimum(np.maximum(effort, -bound), bound)  # once the body rests
        away = bound - side * effort  # what slows it down
        size = side * momentum
        stops = (size > 0.0) & (size < away)
        if stops.any():
            # Sliding until it stops, then at rest or off in the other direction.
            part = np.where(stops, size / np.where(stops, away, 1.0), 0.0)
            mean = part * side * bound + (1.0 - part) * held
            stays = stops & (np.abs(effort) <= bound)
            mean = np.where(stays, momentum + effort, mean)
            held = np.where(stops, mean, held)
        held = np.where((side != 0.0) & ~stops, side * bound, held)
        np.divide(held, level, out=self.force)
        return held

    def viscous_share(self, share):
        return self.viscous * share

    def stored_energy(self):
        return np.zeros_like(self.limit)


def branch_curve(distance, k_0, k_inf, d_0):
    """G(d), the force gained over a distance d from a reverse point, N m."""
    return k_inf * distance - (k_0 - k_inf) * d_0 * np.expm1(-distance / d_0)


def spring_ladder(k_0, k_inf, d_0, reach, elements):
    """Slip distances and stiffnesses whose virgin line meets G(2x)/2 at every slip distance.

    The slip distances are the nodes reach (i/n)^1.5, finer near a reversal; the last one is the
    reach, beyond which only the pure spring k_inf is left. Returns two arrays of n numbers.
    """
    y = reach * (np.arange(elements + 1) / elements) ** 1.5
    slope = np.diff(branch_curve(2.0 * y, k_0, k_inf, d_0) / 2.0) / np.diff(y)
    return y[1:], slope - np.append(slope[1:], k_inf)


class SeriesContact:
    """Plastic module and ladder spring in series on a hook (Hsieh and Pan 2000).

    Sticking: sigma = S(x_s), x_s = x - x_p - x_hook, h' = |x_p'| = alpha (c |sigma|^n - h)
    where positive, damper C_s. The hook lets go at |sigma| = F_c and slides there, with
    viscous friction F_v in place of the damper; x_p and h rest. On reversal it catches: the
    spring stands on its virgin curve at F_c, nothing is remembered, h is 0.
    """

    def __init__(self, plants, step):
        def row(name):
            return np.array([p[name] for p in plants])

        self.step = step
        self.limit = row("coulomb")
        self.viscous = row("viscous")
        self.stick_damping = row("damping")
        self.hardening_scale, self.exponent = row("hardening_coefficient"), row("exponent")
        self.creep_rate = row("creep_rate")
        self.final_stiffness = row("final_stiffness")
        self.reach = row("reach")
        ladders = [
            spring_ladder(
                p["initial_stiffness"],
                p["final_stiffness"],
                p["decay_distance"],
                p["reach"],
                p["elements"],
            )
            for p in plants
        ]
        self.slip_distance = np.stack([y for y, _ in ladders], axis=-1)
        self.stiffness = np.stack([k for _, k in ladders], axis=-1)
        self._below = -self.slip_distance
        self.extension = np.zeros_like(self.stiffness)
        self._work = np.empty_like(self.stiffness)
        lanes = self.limit.size
        self.spring, self.force = np.zeros(lanes), np.zeros(lanes)
        self.plastic, self.hardening = np.zeros(lanes), np.zeros(lanes)
        self.mode = np.zeros(lanes)  # 0 sticking, +1 or -1 sliding
        self.damping = self.stick_damping.copy()
        self._leaving = np.empty(0, dtype=int)

    def advance(self, dx):
        if self._leaving.size:
            self.damping[self._leaving] = self.viscous[self._leaving]
            self._leaving = self._leaving[:0]
        way = self.mode * dx
        caught = (self.mode != 0.0) & (way <= 0.0)
        if caught.any():
            self.mode[caught] = 0.0
            self.hardening[caught] = 0.0
            self.damping[caught] = self.stick_damping[caught]
        sticking = self.mode == 0.0
        size = np.abs(self.force)
        creep = self.hardening_scale * size**self.exponent
        np.subtract(creep, self.hardening, out=creep)
        np.maximum(creep, 0.0, out=creep)
        creep *= self.creep_rate * self.step * sticking
        self.hardening += creep
        np.copysign(creep, self.force, out=creep)
        self.plastic += creep
        move = (dx - creep) * sticking
        self._move(move)
        away = sticking & (np.abs(self.force) >= self.limit) & (self.force * dx > 0.0)
        if away.any():
            lanes = np.flatnonzero(away)
            self._let_go(lanes, size[lanes])

    def _move(self, dx):
        e = self.extension
        self.spring += dx
        np.add(e, dx, out=e)
        np.minimum(e, self.slip_distance, out=e)
        np.maximum(e, self._below, out=e)
        np.multiply(e, self.stiffness, out=self._work)
        np.add.reduce(self._work, axis=0, out=self.force)
        self.force += self.final_stiffness * self.spring

    def _let_go(self, lanes, before):
        side = np.sign(self.force[lanes])
        # Moves run from the middle of a step to the next, velocities from end to end: a hook
        # that lets go at this part of the move leaves that much of the damper to this step.
        gained = np.maximum(np.abs(self.force[lanes]) - before, 1e-300)
        part = np.clip((self.limit[lanes] - before) / gained, 0.0, 1.0)
        left = (part - 0.5) * (self.stick_damping[lanes] - self.viscous[lanes])
        self.damping[lanes] = self.viscous[lanes] + left
        self._leaving = lanes
        self.mode[lanes] = side
        self.force[lanes] = side * self.limit[lanes]
        self.spring[lanes] = side * self.reach[lanes]
        self.extension[:, lanes] = side * self.slip_distance[:, lanes]

    def settle(self, momentum, effort, level):
        return level * self.force

    def viscous_share(self, share):
        """The sticking contact has its damper alone, which no effect touches."""
        return self.viscous * share * (self.mode != 0.0)

    def stored_energy(self):
        ladder = (self.stiffness * self.extension**2).sum(axis=0)
        return 0.5 * (ladder + self.final_stiffness * self.spring**2)


def contact_of(base, plants, step):
    """The contact of one base for lanes with these parameters; `step` in seconds."""
    if base == "maxwell_slip":
        return LadderContact.of_lanes(plants)
    if base == "hsieh_pan":
        return SeriesContact(plants, step)
    if base == "coulomb":
        return DryContact.of_lanes(plants)
    raise ValueError(f"base is maxwell_slip, hsieh_pan or coulomb, not {base!r}")
