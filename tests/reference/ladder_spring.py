"""The nonlinear hysteresis spring as a ladder of elasto-slide elements.

The spring of the Hsieh-Pan model (Wear 242 (2000) 1-17, section 2.2.4) follows,
from any reverse point (x_r, F_r) in direction s,

    F = F_r + s G(s (x - x_r)),
    G(d) = k_inf d + (k_0 - k_inf) d_0 (1 - exp(-d / d_0)),

and, never having been reversed, the Masing virgin curve V(x) = sgn(x) G(2|x|)/2.
The exponential form of G is a reconstruction; the source prescribes only a positive,
non-increasing slope.

A parallel arrangement of elasto-slide elements (Prandtl 1928, Iwan 1966) has exactly
these branches, reverse-point memory and wipe-out without storing a single reverse
point. Element i is a spring k_i in series with a slider that gives way at extension
y_i, so that a move dx changes its extension e_i to

    e_i <- min(max(e_i + dx, -y_i), y_i),        F = k_inf x + sum_i k_i e_i.

From rest the ladder's force is the broken line k_inf x + sum_i k_i min(x, y_i). Choosing
k_i as the differences of consecutive chord slopes makes that line *interpolate* V at
every y_i. A reversed ladder yields at twice the travel: its branches are 2 V_N(d / 2),
the ladder's own version of G.

Displacements carry the unit of d_0 (rad or m), forces that of k_0 d_0 (N m or N).
"""

from __future__ import annotations

import numpy as np


def branch_force(distance, initial_stiffness, final_stiffness, decay_distance):
    """G(d): force gained over a distance d >= 0 from a reverse point."""
    d = np.asarray(distance, dtype=float)
    if np.any(d < 0.0):
        raise ValueError(f"G takes a distance from a reverse point, got {d.min()} < 0")
    excess = initial_stiffness - final_stiffness
    return final_stiffness * d - excess * decay_distance * np.expm1(-d / decay_distance)


def branch_slope(distance, initial_stiffness, final_stiffness, decay_distance):
    """G'(d) = k_inf + (k_0 - k_inf) exp(-d / d_0)."""
    excess = initial_stiffness - final_stiffness
    return final_stiffness + excess * np.exp(-np.asarray(distance, dtype=float) / decay_distance)


def virgin_force(displacement, initial_stiffness, final_stiffness, decay_distance):
    """V(x) = sgn(x) G(2|x|) / 2."""
    x = np.asarray(displacement, dtype=float)
    g = branch_force(2.0 * np.abs(x), initial_stiffness, final_stiffness, decay_distance)
    return np.sign(x) * g / 2.0


def branch_integral(distance, initial_stiffness, final_stiffness, decay_distance):
    """Integral of G from 0 to d, the work done along a branch started at zero force."""
    d = np.asarray(distance, dtype=float)
    excess = initial_stiffness - final_stiffness
    d_0 = decay_distance
    return final_stiffness * d**2 / 2.0 + excess * d_0 * (d + d_0 * np.expm1(-d / d_0))


def yield_grid(elements, decay_distance, reach=12.0):
    """Yield extensions y_1 < ... < y_N, fine near zero, the last at reach * d_0.

    In u = 1 - exp(-x / d_0) the chord error of V is the same for equal intervals.
    The knots are u_i ~ (i / N)^2: a little worse than equal intervals in the middle, but
    the first element yields at about d_0 / N^2, so that the smallest ripples still
    dissipate.
    """
    i = np.arange(1, elements + 1)
    u = (i / elements) ** 2 * -np.expm1(-reach)
    return -decay_distance * np.log1p(-u)


class LadderSpring:
    """N parallel elasto-slide elements and one pure spring.

    Parameters
    ----------
    initial_stiffness, final_stiffness, decay_distance : float
        k_0 > k_inf > 0 and d_0 > 0 of the curve G.
    elements : int
        Number N of elasto-slide elements, at least 128.

    Attributes
    ----------
    stiffness, yield_extension : ndarray, shape (N,)
        k_i and y_i.
    extension : ndarray, shape (N,)
        e_i, the memory. Only `advance`, `load_virgin` and `restore` change it.
    displacement : float
        Extension of the pure spring k_inf, equal to the spring's x.
    """

    def __init__(self, *, initial_stiffness, final_stiffness, decay_distance, elements=512):
        if not initial_stiffness > final_stiffness > 0.0:
            raise ValueError("the curve needs initial_stiffness > final_stiffness > 0")
        if elements < 128:
            raise ValueError(f"a ladder needs at least 128 elements, got {elements}")
        self.curve = (float(initial_stiffness), float(final_stiffness), float(decay_distance))
        self.final_stiffness = float(final_stiffness)
        self.yield_extension = yield_grid(elements, decay_distance)
        knots = np.concatenate(([0.0], self.yield_extension))
        self._virgin_knots = knots
        self._virgin_forces = virgin_force(knots, *self.curve)
        chords = np.diff(self._virgin_forces) / np.diff(knots)
        # Beyond the last knot only the pure spring is left.
        self.stiffness = chords - np.append(chords[1:], self.final_stiffness)
        # V is concave, so no k_i is negative; far out, chords agree with k_inf to round-off.
        self.stiffness = np.maximum(self.stiffness, 0.0)
        self.extension = np.zeros(elements)
        self.displacement = 0.0
        self._work = np.empty(elements)

    def _moved(self, dx, out):
        np.add(self.extension, dx, out=out)
        np.maximum(out, -self.yield_extension, out=out)
        np.minimum(out, self.yield_extension, out=out)
        return out

    def force(self):
        """Present force."""
        return self.final_stiffness * self.displacement + float(self.stiffness @ self.extension)

    def force_after(self, dx):
        """Force after one straight move dx from the present state; changes nothing."""
        moved = self._moved(dx, self._work)
        return self.final_stiffness * (self.displacement + dx) + float(self.stiffness @ moved)

    def slope_after(self, dx, direction):
        """dF/dx of a motion in `direction` (+1 or -1) after a move dx; changes nothing."""
        moved = self._moved(dx, self._work)
        free = direction * moved < self.yield_extension
        return self.final_stiffness + float(self.stiffness @ free)

    def advance(self, dx):
        """Make the move dx and return the force at its end."""
        self._moved(dx, self.extension)
        self.displacement += dx
        return self.force()

    def virgin(self, displacement):
        """The ladder's own virgin curve V_N, the broken line through V."""
        x = np.asarray(displacement, dtype=float)
        last = self._virgin_knots[-1]
        line = np.interp(np.abs(x), self._virgin_knots, self._virgin_forces)
        line = line + self.final_stiffness * np.maximum(np.abs(x) - last, 0.0)
        return np.sign(x) * line

    def virgin_inverse(self, force):
        """Displacement at which V_N has the given force."""
        f = abs(float(force))
        x = np.interp(f, self._virgin_forces, self._virgin_knots)
        x += max(f - self._virgin_forces[-1], 0.0) / self.final_stiffness
        return float(np.copysign(x, force))

    def load_virgin(self, force):
        """Forget everything and stand on the virgin curve at the given force."""
        self.displacement = self.virgin_inverse(force)
        y = self.yield_extension
        self.extension[:] = np.clip(self.displacement, -y, y)

    def move_to_force(self, force):
        """Move straight to a given force and return the displacement reached.

        On a straight move the force is a broken line in dx with a corner where each element
        yields; the corner just short of the force is found and the rest of the way is linear.
        """
        direction = 1.0 if force >= self.force() else -1.0
        room = np.sort(self.yield_extension - direction * self.extension)
        low, high = -1, room.size  # corners low and high bracket the force
        while high - low > 1:
            middle = (low + high) // 2
            if direction * (self.force_after(direction * room[middle]) - force) <= 0.0:
                low = middle
            else:
                high = middle
        start = direction * room[low] if low >= 0 else 0.0
        slope = self.slope_after(start, direction)
        self.advance(start + (force - self.force_after(start)) / slope)
        return self.displacement

    def save(self):
        """The memory, to be given back to `restore`."""
        return self.displacement, self.extension.copy()

    def restore(self, memory):
        """Return to a saved memory."""
        self.displacement = memory[0]
        self.extension[:] = memory[1]

    def virgin_error_bound(self):
        """Largest deficit V - V_N, exact: the chord gap is greatest where V' = chord slope.

        A branch 2 V_N(d / 2) lags G(d) by at most twice this; a force after any history is a
        sum of branches of alternating sign and errs by at most twice this for each reverse
        point remembered.
        """
        k_0, k_inf, d_0 = self.curve
        x, f = self._virgin_knots, self._virgin_forces
        slope = np.diff(f) / np.diff(x)
        ratio = np.maximum((slope - k_inf) / (k_0 - k_inf), np.exp(-2.0 * x[1:] / d_0))
        worst = np.clip(-d_0 / 2.0 * np.log(ratio), x[:-1], x[1:])
        gaps = virgin_force(worst, *self.curve) - (f[:-1] + slope * (worst - x[:-1]))
        beyond = (k_0 - k_inf) * d_0 / 2.0 * np.exp(-2.0 * x[-1] / d_0)
        return float(max(gaps.max(), beyond))
