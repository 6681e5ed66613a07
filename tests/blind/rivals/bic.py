"""Forward selection by the Bayesian information criterion (Schwarz, Ann. Statist. 6 (1978))."""

from __future__ import annotations

import math

from .library import forward


def names(lib):
    """Adds the effect that lowers the criterion most, while it lowers it."""
    return forward(lib, _lowest)


def _lowest(lib, own):
    total = float(lib.residual @ lib.residual)

    def change(name):
        power, entry, _ = own[name]
        left = max(1.0 - power / total, 1e-12)
        # Shapes that a grid chose are counted as what they are: parameters.
        return lib.rows * math.log(left) + entry.parameters * math.log(lib.rows)

    best = min(own, key=change)
    return best if change(best) < 0.0 else None
