"""The generalized Maxwell-slip model by Runge-Kutta on each element's deflection, mode by mode.

Al-Bender, Lampaert, Swevers (2005): an element sticks, dz/dt = v, until its force k z is its share
alpha of s(v); it slips, d(k z)/dt = sgn(v) C (alpha - |k z|/s(v)), until the velocity changes its
sign. Ours: a slipping element gains no force faster than its spring. The ends of sticking are
events of the integrator.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from tests.reference.golden import Golden
from tests.reference.laws.lugre import level

ELEMENTS = 8
GOLDEN = Golden(
    reach=1.5e-3,
    speed=0.3,
    share=1e-8,
    parameters={
        "coulomb": 0.35,
        "breakaway": 0.5,
        "stribeck_velocity": 0.05,
        "stribeck_exponent": 2.0,
        "initial_stiffness": 3000.0,
        "yield_shape": 0.2,
        "attraction": 20.0,
        "viscous": 0.05,
    },
)


def shares(yield_shape):
    """alpha of equally stiff elements: equal parts of the fall of slope of the first loading."""
    kappa = yield_shape

    def slope(y):
        if kappa == 0.0:
            return np.exp(-y)
        return max(1.0 - kappa * y, 0.0) ** (1.0 / kappa - 1.0)

    end = 1.0 / kappa if kappa > 0.0 else 1e3
    part = (np.arange(ELEMENTS) + 0.5) / ELEMENTS
    yields = np.array([brentq(lambda y, u=u: slope(y) - u, 0.0, end, xtol=1e-15) for u in 1 - part])
    return yields / yields.sum()


def slipping(z, v, *, stiffness, share, attraction, bounded=True, **p):
    """dz/dt of a slipping element."""
    drawn = attraction * (share - np.sign(v) * stiffness * z / level(v, **p)) / stiffness
    return np.sign(v) * (min(drawn, abs(v)) if bounded else drawn)


def _held(z, slips, v, dt, *, rtol=1e-11, **element):
    """Deflection and mode of one element after dt at a held velocity other than 0."""
    s, k, t = np.sign(v), element["stiffness"], 0.0
    most = element["share"] * level(v, **element) / k
    if slips != s:
        free = max(most - s * z, 0.0) / abs(v)
        if free > dt:
            return z + v * dt, 0.0
        z, t = z + v * free, free
    if t >= dt:
        return z, s

    # The rate has a kink where the spring and the attraction are as fast as each other.
    def kink(_, y):
        drawn = slipping(y[0], v, bounded=False, **element)
        return s * drawn - abs(v)

    kink.terminal = True
    if kink(t, [z]) > 0.0:
        straight = solve_ivp(lambda _, y: [v], (t, dt), [z], "DOP853", events=kink, rtol=rtol)
        z, t = straight.y[0, -1], straight.t[-1]
        if straight.status == 0:
            return z, s
    done = solve_ivp(
        lambda _, y: [slipping(y[0], v, bounded=False, **element)],
        (t, dt),
        [z],
        "DOP853",
        rtol=rtol,
        atol=1e-17,
    )
    return done.y[0, -1], s


def along(velocity, dt, *, yield_shape=0.0, initial_stiffness, viscous=0.0, **p):
    """Friction at the end of each sample."""
    k = initial_stiffness / ELEMENTS
    each = [{"stiffness": k, "share": share, **p} for share in shares(yield_shape)]
    z, mode, friction = np.zeros(ELEMENTS), np.zeros(ELEMENTS), []
    for v in velocity:
        if v != 0.0:
            for i, element in enumerate(each):
                z[i], mode[i] = _held(z[i], mode[i], v, dt, **element)
        friction.append(k * z.sum() + viscous * v)
    return np.array(friction)


def pulled_body(speed, spring, times, *, inertia, yield_shape=0.0, initial_stiffness, viscous, **p):
    """Position of a body at the end of a spring whose other end moves on, from rest.

    Modes are carried along: each end of sticking and each reversal is an event.
    """
    k = initial_stiffness / ELEMENTS
    share = shares(yield_shape)
    x, v, z, mode = 0.0, 0.0, np.zeros(ELEMENTS), np.zeros(ELEMENTS)
    t, rows = times[0], [0.0]

    def rates(t, y, mode):
        x, v, z = y[0], y[1], y[2:]
        resisted = k * z.sum() + viscous * v
        drawn = p["attraction"] * (share - mode * k * z / level(v, **p)) / k
        slip = mode * np.minimum(drawn, abs(v))
        return np.concatenate(
            ([v, (spring * (speed * t - x) - resisted) / inertia], np.where(mode == 0.0, v, slip))
        )

    while t < times[-1]:

        def ends(t, y, mode=mode):
            stuck = mode == 0.0
            room = share * level(y[1], **p) - k * np.sign(y[1]) * y[2:]
            return room[stuck].min() if stuck.any() else 1.0

        def turns(t, y, mode=mode):
            return y[1] if mode.any() else 1.0

        ends.terminal = turns.terminal = True
        ends.direction = -1.0
        done = solve_ivp(
            lambda t, y, mode=mode: rates(t, y, mode),
            (t, times[-1]),
            np.concatenate(([x, v], z)),
            "LSODA",
            times[times > t],
            rtol=1e-9,
            atol=1e-13,
            events=(ends, turns),
            max_step=0.02,
        )
        rows.extend(done.y[0] if len(done.t) else [])
        if done.status != 1:
            break
        which = 0 if done.t_events[0].size else 1
        t, y = done.t_events[which][0], done.y_events[which][0]
        x, v, z = y[0], y[1], y[2:].copy()
        mode = mode.copy()
        if which == 1:
            mode[:] = 0.0
            v = 0.0
        else:
            room = share * level(v, **p) - k * np.sign(v) * z
            mode[(mode == 0.0) & (room <= 1e-9 * share)] = np.sign(v)
    return np.array(rows)
