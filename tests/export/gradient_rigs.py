"""Machines and inputs on which gradients are checked against differences."""

import numpy as np

import stiction as st

DT = 5e-4
RIGS = {
    "coulomb": {"coulomb": 0.3, "breakaway": 0.4, "viscous": 0.02},
    "lugre": {
        "viscous": 0.02,
        "coulomb": 0.3,
        "breakaway": 0.4,
        "initial_stiffness": 60.0,
        "damping": 0.2,
    },
    "hsieh_pan": {
        "viscous": 0.02,
        "initial_stiffness": 60.0,
        "final_stiffness": 20.0,
        "breakaway": 0.4,
    },
}
PATHS = ("friction.coulomb", "friction.breakaway", "friction.viscous", "friction.initial_stiffness",
         "body.inertia", "drive.gain", "effects.cogging.cosine")  # fmt: skip


def machine(law):
    return st.Plant.from_dict(
        {
            "drive": {"input": "current_a", "gain": 0.5},
            "body": {"inertia": 0.01},
            "friction": {"law": law, **RIGS[law]},
            "effects": [{"name": "cogging", "cosine": 0.05, "order": 5.0}],
        }
    )


def values(law):
    own = machine(law).motor().parameters
    return {path: own[path] for path in PATHS if path in own and np.isfinite(own[path])}


def current(n=120):
    time = DT * np.arange(n)
    return 1.6 * np.sin(90.0 * time) + 0.4 * np.cos(31.0 * time)
