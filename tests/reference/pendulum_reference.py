"""A pendulum on a drive, read by an encoder whose errors go with the angle.

Semi-implicit Euler at a step of its own; it shares no code with the product.
"""

import numpy as np

import stiction as st

INERTIA, WEIGHT, DRY, VISCOUS = 0.18, 3.5, 0.15, 0.01
STEP, EVERY = 1e-4, 50


def swung(seed, *, error=0.0, ripple=0.0, parked=None, role=None, seconds=16.0):
    """A pendulum that is pumped up and braked by a torque of 0.5 to 0.9 N m, read every 5 ms.

    Parameters
    ----------
    seed : int
    error : float
        Amplitude of the encoder's error, twelve times a turn, rad.
    ripple : float
        Amplitude of a torque, twelve times a turn, N m.
    parked : float, optional
        The drive holds this torque, a little more at first, and the pendulum is let go near where
        its weight balances it, N m.
    """
    rng = np.random.default_rng(seed)
    order = 12.0
    x, v, u = rng.uniform(-0.1, 0.1), 0.0, 0.9
    if parked is not None:
        x, u = np.arcsin(parked / WEIGHT) + 0.25, parked
    number = int(seconds / STEP)
    time, position, torque = [], [], []
    for k in range(number):
        if k % EVERY == 0:
            time.append(k * STEP)
            position.append(x + error * np.sin(order * x + 0.4))
            energy = 0.5 * INERTIA * v * v - WEIGHT * np.cos(x)
            pumped = np.sin(2.0 * np.pi * k * STEP / 7.0 + seed) * WEIGHT < 0.9 * WEIGHT - energy
            level = 0.7 + 0.2 * np.sin(11.0 * k * STEP)
            if parked is None and abs(v) > 0.1:
                u = level * np.sign(v if pumped else -v)
            elif parked is not None:
                u = parked + (0.02 if k * STEP < 0.3 else 0.0)
            torque.append(u)
        pull = u - WEIGHT * np.sin(x) - VISCOUS * v + ripple * np.sin(order * x + 0.4)
        free = v + STEP * pull / INERTIA
        # Dry friction takes what speed there is, and no more.
        v = np.sign(free) * max(abs(free) - STEP * DRY / INERTIA, 0.0)
        x += STEP * v
    return st.Recording(np.array(time), np.array(torque), np.array(position), role=role)
