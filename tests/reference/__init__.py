"""Slow, obvious oracles in NumPy and SciPy, written apart from the Rust core.

Nothing here is fast and nothing here is shared with the product: the nonlinear
spring is a ladder of elasto-slide elements instead of a list of reverse points,
the hook is integrated with located events instead of inside a fixed step, and
Coulomb friction is solved piece by piece. Where the product and an oracle agree,
they agree for different reasons.

Sign and units as everywhere: J x'' = u + load - F, F positive when it resists
positive motion; SI units, radians for rotary machines.
"""
