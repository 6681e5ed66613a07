"""Experiments that were published for LuGre and repeated for its successors, on a body of 1 kg.

A contact with F_s = 1.5 N and F_c = 1 N; Canudas de Wit and others (1995).
"""

import numpy as np

import stiction as st

BREAKAWAY, COULOMB = 1.5, 1.0
PULLING_SPRING, PULLING_SPEED = 2.0, 0.1


def broken_away(friction, rate, integrator="fast"):
    """Greatest friction while the force rises at this rate."""
    dt = min(1e-4, 1e-3 / rate)
    motor = st.Motor(inertia=1.0, friction=friction, integrator=integrator)
    samples = int((2.0 / rate + 0.1) / dt)
    run = motor.simulate(rate * (np.arange(samples) + 0.5) * dt, dt)
    slid = np.argmax(np.abs(run.position) > 3e-4)
    return run.friction[: slid + 1].max()


def lags(friction):
    """Friction while speed rises less that while it falls, at 1, 10 and 25 rad/s.

    Motion in one direction at 0.1 to 3 mm/s, as in their figure.
    """
    samples = 4000
    phase = 2.0 * np.pi * np.arange(3 * samples) / samples
    speed = 1.55e-3 - 1.45e-3 * np.cos(phase)
    for omega in (1.0, 10.0, 25.0):
        force = friction.copy().simulate(speed, 2.0 * np.pi / omega / samples)[2 * samples :]
        yield force[: samples // 2] - force[samples // 2 :][::-1]


def pulled(friction, integrator, end, dt):
    """Positions of the body at the end of a spring whose other end moves on."""
    motor = st.Motor(inertia=1.0, friction=friction, integrator=integrator)
    x, v, positions = 0.0, 0.0, []
    for n in range(round(end / dt)):
        # The middle of the sample, where body and spring's end will be then.
        middle = PULLING_SPEED * (n + 0.5) * dt
        x, v = motor.step(PULLING_SPRING * (middle - x - 0.5 * v * dt), dt)
        positions.append(x)
    return np.array(positions)


def period_of_two_phases(viscous):
    """Stick-slip of a body that breaks away at F_s and slides at F_c + viscous·v."""
    k, c, speed = PULLING_SPRING, viscous, PULLING_SPEED
    # Slide: x'' + c x' + k x = k (speed t) + F_s - F_c from rest.
    t = np.linspace(0.0, 6.0, 600_001)
    damp, omega = c / 2.0, np.sqrt(k - c**2 / 4.0)
    # Particular solution speed t + b, homogeneous part from x(0) = x'(0) = 0.
    b = (BREAKAWAY - COULOMB - c * speed) / k
    wave = b * np.cos(omega * t) + (speed + damp * b) / omega * np.sin(omega * t)
    x = speed * t + b - np.exp(-damp * t) * wave
    stop = np.argmax(np.gradient(x, t)[100:] <= 0.0) + 100
    left = BREAKAWAY + k * (speed * t[stop] - x[stop])
    return t[stop] + (BREAKAWAY - left) / (k * speed)
