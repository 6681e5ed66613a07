"""Machines and inputs that the tests of the core share; every draw comes from a seed."""

from __future__ import annotations

import itertools
import math

import numpy as np

import stiction as st

# The illustrative rig of the reference, which rigs are drawn around and never equal.
ILLUSTRATIVE = {
    "initial_stiffness": 3000.0,
    "final_stiffness": 800.0,
    "decay_distance": 60.0 * math.pi / (180.0 * 3600.0),
    "hardening_coefficient": 1.6e-3,
    "hardening_exponent": 2.0,
    "creep_rate": 2.0,
    "damping": 0.45,
}
INERTIA = 0.0076
HOOK = {
    "breakaway": 0.5,
    "coulomb": 0.35,
    "stribeck_velocity": 0.05,
    "viscous": 0.05,
    "slip_distance": 1e-4,
}
RATED = {"loading_rate": 5.0, "loading_time": 0.1}

# One of every kind of contact: each law, each option, with and without a hook.
CONTACTS = {
    "coulomb": ("coulomb", {"coulomb": 0.35}),
    "stribeck": (
        "coulomb",
        {"coulomb": 0.35, "breakaway": 0.5, "stribeck_velocity": 0.05, "viscous": 0.05},
    ),
    "sticking": ("hsieh_pan", ILLUSTRATIVE),
    "elastic": ("hsieh_pan", ILLUSTRATIVE | {"hardening_coefficient": 0.0}),
    "hook": ("hsieh_pan", ILLUSTRATIVE | HOOK),
    "rated": ("hsieh_pan", ILLUSTRATIVE | HOOK | RATED),
    "same": ("hsieh_pan", ILLUSTRATIVE | HOOK | {"virgin_curve": "same"}),
    "spring damper": ("hsieh_pan", ILLUSTRATIVE | HOOK | {"damper": "spring"}),
    "kept": ("hsieh_pan", ILLUSTRATIVE | HOOK | {"after_slip": "keep"}),
}


def contact(kind):
    """A new model of one of CONTACTS."""
    law, keywords = CONTACTS[kind]
    return st.FrictionModel(law, **keywords)


def motor(kind, **keywords):
    """A motor on one of CONTACTS."""
    return st.Motor(**{"inertia": INERTIA, "friction": contact(kind)} | keywords)


def wandering_velocity(seed, n, *, dwell=6):
    """Speeds over three decades up to 0.3 rad/s, either sign, some held, some exactly 0."""
    rng = np.random.default_rng(seed)
    speed = 10.0 ** rng.uniform(-3.5, -0.5, n)
    velocity = np.repeat(speed * rng.choice([-1.0, 1.0], n), rng.integers(1, dwell, n))[:n]
    velocity[rng.random(n) < 0.05] = 0.0
    return velocity


def wandering_current(seed, n, greatest, *, dwell=40):
    """Held levels of either sign up to `greatest`, some of them 0."""
    rng = np.random.default_rng(seed)
    level = rng.uniform(-greatest, greatest, n) * (rng.random(n) > 0.1)
    return np.repeat(level, rng.integers(1, dwell, n))[:n]


def around(rng, centre, factor=3.0):
    """Log-uniform within a factor around a value."""
    return float(centre * factor ** rng.uniform(-1.0, 1.0))


def drawn_rig(seed, *, factor=3.0, hook=False):
    """(inertia, parameters, force scale): a rig drawn log-uniformly around the illustrative one.

    The decay distance and the coefficient of hardening are drawn so that the shapes of spring
    and creep stay in reach of the efforts: d_0 against force / k_0, c·F^n against F / k_0.
    """
    rng = np.random.default_rng(seed)
    stiffness = around(rng, ILLUSTRATIVE["initial_stiffness"], factor)
    force = around(rng, 0.3, factor)
    exponent = float(rng.uniform(1.4, 3.0))
    parameters = {
        "initial_stiffness": stiffness,
        "final_stiffness": stiffness * float(rng.uniform(0.1, 0.6)),
        "decay_distance": around(rng, 3.0 * force / stiffness, factor),
        "hardening_coefficient": around(rng, 1.5 * force / stiffness, factor) / force**exponent,
        "hardening_exponent": exponent,
        "creep_rate": around(rng, 2.0, factor),
    }
    inertia = around(rng, INERTIA, factor)
    # A damping ratio of about 0.05, as on the illustrative rig, within the factor.
    parameters["damping"] = around(rng, 0.1 * math.sqrt(stiffness * inertia), factor)
    if hook:
        parameters |= {
            "breakaway": force,
            "coulomb": force * float(rng.uniform(0.5, 0.9)),
            "stribeck_velocity": around(rng, 0.05, factor),
            "viscous": around(rng, 0.1 * force, factor),
            "slip_distance": around(rng, 0.5 * force / stiffness, factor),
        }
    return inertia, parameters, force


def same_state(one, other):
    """Whether two state dicts are equal to the bit."""
    return one.keys() == other.keys() and all(np.array_equal(one[k], other[k]) for k in one)


def pieces(n, seed, count=7):
    """Slices that cut range(n) at random places."""
    cuts = np.sort(np.random.default_rng(seed).choice(np.arange(1, n), count, replace=False))
    edges = [0, *cuts.tolist(), n]
    return [slice(a, b) for a, b in itertools.pairwise(edges)]


def for_oracle(parameters):
    """The oracle's names for the parameters of the rate-dependent break-away."""
    names = {"loading_rate": "loading_rate_scale", "loading_time": "loading_rate_time"}
    return {names.get(name, name): value for name, value in parameters.items()}
