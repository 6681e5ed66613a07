"""How far a contact yields before it slides."""

from __future__ import annotations

from typing import Final

import numpy as np

from .stated import Friction

__all__ = ["presliding"]

LOADED: Final = 0.95
"""Share of the sliding friction at which a first loading counts as having come to a slide."""
LOADING_S: Final = 0.05
"""Time that such a loading takes: too short to creep, too long for viscous friction to matter."""
FASTEST: Final = 1e5
"""rad/s or m/s: what yields over more than any machine has takes longer."""
LOADING_STEPS: Final = 500
LONGEST_LOADING: Final = 20.0
"""In units of sliding friction over initial stiffness."""


def presliding(friction: Friction, sliding: float) -> float:
    """Displacement in which a contact that was never moved comes to a slide; rad or m.

    Parameters
    ----------
    friction : Friction
        Of a law that yields (``Friction.springy``).
    sliding : float
        Level of the sliding friction, N·m or N.
    """
    model = friction.model()
    step = LONGEST_LOADING * sliding / model.parameters["initial_stiffness"] / LOADING_STEPS
    duration = max(LOADING_S / LOADING_STEPS, step / FASTEST)
    force = model.simulate(np.full(LOADING_STEPS, step / duration), duration)
    loaded = np.flatnonzero(force >= LOADED * min(sliding, float(np.max(force))))
    return step * float(loaded[0] + 1)
