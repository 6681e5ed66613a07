"""The session that ships with the package: `python -m tests.reference.make_demo_session`.

Writes recordings, session.toml, plant.toml and two texts into python/stiction/demo_session. They
are not made by the product: the demo would prove little if the library diagnosed itself.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from .session_reference import make_session

FOLDER = Path(__file__).parents[2] / "python" / "stiction" / "demo_session"
SECONDS = 99.0  # of all recordings
HIDDEN, SIZE, SHAPE = "stribeck", 0.015, {"velocity": 0.5}
# Of 40 seeds one whose machine is of middle size and whose report leaves little to be read with
# care: a first report should be a clear one.
SEED = 37
# A torque command is told to 10 µN·m: some 3e-5 of the friction, far below its noise.
TORQUE_DIGITS = 5

KINDS = {
    "tracking": "under a controller: two turns and more, with quick motion on top",
    "ramps": "under a controller: constant speeds over three decades, both ways",
    "dwell": "rests, each ended by a torque ramp past break-away",
    "pulses": "torque pulses, from below break-away to three times the friction",
    "presliding": "torque loops below break-away: large ones, nested ones, and holds",
    "sines": "under a controller: sines of several frequencies and amplitudes",
}

PLANT = """\
# The machine as its owner knows it. What is not stated here (inertia, friction) is fitted from
# the recordings; a number that is written down is where the fit starts, and
# {{ value = 0.006, fixed = true }} keeps it.

[motion]
kind = "rotary"

[drive]
# The column that drives the machine, and N·m per unit of that column.
input = "torque_nm"
gain = 1.0

[friction]
# Naming a law is enough; `stiction laws` lists them.
law = "maxwell_slip"

[sensor]
# An encoder of 18 bits.
counts_per_rev = {counts}
"""

SESSION_HEAD = """\
# Recordings of one machine. Paths are relative to this file.

plant = "plant.toml"

# Columns by role. time_s and torque_nm say by their names what they are; an encoder's counts have
# to be named.
[columns]
position = {{ name = "position_counts", unit = "count" }}

# Each experiment was made three times, with other speeds, levels and pauses each time:
# role = "train" is fitted, "select" decides which effects are added, and "test" measures, once
# and at the end, what they gain. start_s is when a recording began on the session's clock.
#
{kinds}
"""

README = """\
A session for trying stiction out
=================================

Recordings of a motor with friction: {count} files, {seconds:.0f} s, 1000 rows a second.

    time_s           s
    torque_nm        commanded torque, N·m
    position_counts  encoder, {counts} counts per turn

The motor is simulated, not measured. It was simulated by a program of its own
(tests/reference/make_demo_session.py of stiction's repository), which shares no code with the
library. The torque that acts differs from the commanded one by noise, whose standard deviation is
{noise:.0f} % of the friction.

One physical effect is hidden in the recordings: plant.toml does not know of it. Try to find it,

    stiction diagnose session.toml

and then compare with what-is-hidden.txt.

    session.toml    which recordings there are, and what their columns mean
    plant.toml      what is known of the machine
    recordings/     the files, named by experiment and by what they are for

These files may be used as stiction itself may: under the MIT licence or the Apache License 2.0,
at your choice.
"""

SOLUTION = """\
{name}, with excess {excess:.4f} and velocity {velocity:.3f} rad/s

Friction is higher at rest than in fast motion, by {percent:.1f} %, and falls as speed rises: at
speed v it is multiplied by

    1 + {excess:.4f} exp(-(v / {velocity:.3f} rad/s)^2).

The rms of what that adds to friction over the session is {size:.2f} % of the Coulomb friction. The
rest of the machine:

    inertia            {inertia:.6f} kg·m²
    Coulomb friction   {coulomb:.4f} N·m
    viscous friction   {viscous:.5f} N·m·s/rad
    contact            {elements} springs in parallel, each of which slips at a force of its own

A friction law describes such a contact approximately, as it does a real one.
"""


def make():
    """The session, simulated."""
    return make_session(SEED, base="maxwell_slip", hidden=[(HIDDEN, SIZE, SHAPE)], seconds=SECONDS)


def tables(session):
    """Columns of each recording, by file name, as they are stored: counts as whole numbers."""
    count = 2.0 * np.pi / session.spec.counts_per_rev
    return {
        f"recordings/{k:02d}_{recording.name}.npz": {
            "time_s": np.round(recording.time_s, 3),
            "torque_nm": np.round(recording.torque_nm, TORQUE_DIGITS),
            "position_counts": np.rint(recording.position_rad / count).astype(np.int32),
        }
        for k, recording in enumerate(session.recordings, 1)
    }


def texts(session):
    """The text files, by name."""
    spec, plant, (effect,) = session.spec, session.plant, session.effects
    width = max(len(kind) for kind in KINDS)
    listing = [
        f'[[recordings]]\nfile = "{file}"\nrole = "{r.role}"\nkind = "{r.kind}"\n'
        f"start_s = {r.start_s:.3f}\n"
        for file, r in zip(tables(session), session.recordings, strict=True)
    ]
    kinds = "\n".join(f"#   {kind:<{width}}  {told}" for kind, told in KINDS.items())
    return {
        "session.toml": "\n".join([SESSION_HEAD.format(kinds=kinds), *listing]),
        "plant.toml": PLANT.format(counts=spec.counts_per_rev),
        "README.txt": README.format(
            count=len(session.recordings),
            seconds=SECONDS,
            counts=spec.counts_per_rev,
            noise=100.0 * spec.noise,
        ),
        "what-is-hidden.txt": SOLUTION.format(
            name=effect.name,
            excess=effect.amplitude,
            percent=100.0 * effect.amplitude,
            velocity=effect.shape["velocity"],
            size=100.0 * effect.reached,
            elements=plant["stiffness"].size,
            **{name: plant[name] for name in ("inertia", "coulomb", "viscous")},
        ),
    }


def write(folder=FOLDER):
    """Write the session into a folder."""
    session = make()
    (folder / "recordings").mkdir(parents=True, exist_ok=True)
    for file, columns in tables(session).items():
        np.savez_compressed(folder / file, **columns)
    for file, text in texts(session).items():
        (folder / file).write_text(text, encoding="utf-8", newline="\n")
    return folder


if __name__ == "__main__":
    sys.stdout.write(f"wrote {write()}\n")
