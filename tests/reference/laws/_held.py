"""What oracles that integrate share: states carried through samples of a held velocity."""

import numpy as np
from scipy.integrate import solve_ivp


def carried(rate, start, velocity, dt, *, rtol=1e-11, atol=1e-13, longest=np.inf):
    """States at the end of each sample: dy/dt = rate(y, v) with v held over dt.

    Shape (samples, states). A sample without motion is integrated like any other.
    """
    y, rows = np.asarray(start, dtype=float), []
    for v in velocity:
        done = solve_ivp(
            lambda _, y, v=v: rate(y, v),
            (0.0, dt),
            y,
            method="DOP853",
            rtol=rtol,
            atol=atol,
            max_step=longest,
        )
        y = done.y[:, -1]
        rows.append(y)
    return np.array(rows)
