"""The figure of an effect: what a plant that lacks it leaves, over the coordinate of the effect.

The machine has the effect at its typical values and is moved by the experiment that the catalogue
names for it; the plant is the same without it. Nothing here knows a single effect: what is needed
comes from its record.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

import stiction as st
from stiction import plot
from stiction.catalogue import EffectRecord
from stiction.diagnosis.adequacy.coordinates import looks
from stiction.diagnosis.data.evidence import Evidence
from stiction.diagnosis.findings.own import own_view
from stiction.fitting.rows import Nuisances
from stiction.plan import plan
from stiction.plot import ACCENT, FAINT, SIMULATED, SMALL

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["effect_figure", "machine", "recorded"]

DT: Final = 1e-3
STROKE: Final = 6.0
"""Range of the motion, rad."""
WINDOW: Final = 2e-3
"""Displacement within which the contact rests, rad: of the order of its pre-sliding."""
REPEATED: Final = "cycle"
"""The experiment that is repeated through a session, for what changes over it,"""
CYCLES: Final = 8
"""and how often."""
CORNER: Final = 2.0 * np.pi * 10.0
"""Of the loop that follows references, rad/s: so slow that what is late does not swing it."""
MOST: Final = 3.0
"""Input that the loop may ask for, N·m."""
DECADE: Final = 10.0
"""Least span of a coordinate that is drawn over its logarithm."""
APART_S: Final = 40.0
"""From one of these to the next."""
DRIVEN: Final = {
    "motion": {"kind": "rotary"},
    "drive": {"input": "torque_nm"},
    "body": {"inertia": 0.0076},
    "friction": {
        "law": "maxwell_slip",
        "coulomb": 0.2,
        "initial_stiffness": 200.0,
        "viscous": 0.01,
    },
}
SERVO: Final = {
    **DRIVEN,
    "drive": {
        "kind": "servo",
        "proportional": 1.2,
        "supply_v": 7.4,
        "resistance_ohm": 3.5,
        "torque_constant": 0.4,
    },
    "friction": {"law": "coulomb", "coulomb": 0.05, "viscous": 0.01},
}
CHANNELS: Final = {"load": 0.4, "temperature": 15.0}
"""Amplitude of a slow swing of a channel that an effect needs, N·m and degC."""
ABOUT: Final = {"load": 0.0, "temperature": 35.0}


def machine(record: EffectRecord) -> tuple[st.Plant, st.Plant]:
    """A plant without an effect, and the same with its typical values."""
    base = SERVO if record.impossible("rotary", servo=False) else DRIVEN
    values = {each.name: each.typical for each in record.parameters}
    entry = {"name": record.name, **values}
    return st.Plant.from_dict(base), st.Plant.from_dict({**base, "effects": [entry]})


def recorded(record: EffectRecord) -> list[st.Recording]:
    """What the machine with the effect does in the experiment that shows it.

    A controller follows references; inputs go to the drive as they are.
    """
    without, with_it = machine(record)
    over_the_session = record.plan == REPEATED
    number = CYCLES if over_the_session else 2
    made = plan(without, position=STROKE, rate=1.0 / DT, only=(record.plan,))
    motor = with_it.motor()
    recordings, path = [], 0.0
    for k in range(number):
        signal = made.signals[k % 2]
        start = k * APART_S if over_the_session else k * (signal.duration + 1.0)
        time = DT * np.arange(len(signal.values))
        swing = np.sin(2.0 * np.pi * (start + time) / 17.0)
        channels = {
            name: ABOUT[name] + CHANNELS[name] * swing
            for name in record.channels
            if name in CHANNELS
        }
        motor.reset(0.0, 0.0, time=start, path=path)
        driven = signal.values
        if signal.kind == "reference" and not without.servo:
            driven = followed(without, motor, signal.values, channels)
            motor.reset(0.0, 0.0, time=start, path=path)
        held = {name: values[:-1] for name, values in channels.items()}
        run = motor.simulate(driven[:-1], DT, outputs=["measured"], **held)
        position = np.concatenate([[0.0], run.measured])
        path += float(np.abs(np.diff(position)).sum())
        recordings.append(
            st.Recording(
                time, driven, position, role=("train", "select")[k % 2], start_s=start, **channels
            )
        )
    return recordings


def effect_figure(record: EffectRecord) -> Figure:
    """Left the effort that the plant leaves over time, right the same over the effect's coordinate.

    Parameters
    ----------
    record : EffectRecord
        Any of the catalogue.

    Returns
    -------
    Figure
    """
    without, with_it = machine(record)
    recordings = recorded(record)
    evidence = Evidence(without, recordings)
    left = evidence.residual(without, Nuisances())
    starts = [each.start_s for each in recordings]
    seen = looks(evidence, without, starts, WINDOW)
    nothing = np.zeros((len(left), 2))
    view = own_view(evidence, seen, with_it.effects[0], left, nothing, 1.0)

    from matplotlib.ticker import NullFormatter

    drawn, (over_time, own) = plot.figure(1, 2, height=2.4, width=7.2)
    for panel in (over_time, own):
        panel.axhline(0.0, color=FAINT, linewidth=0.6)
        panel.ticklabel_format(axis="y", scilimits=(-2, 3), useMathText=True)
        panel.yaxis.get_offset_text().set_fontsize(SMALL)
    shares = left / evidence.weights
    begun = 0
    for rows, look in zip(evidence.shown, seen, strict=True):
        shown = np.full(len(rows.mask), np.nan)  # rows that do not count leave a gap
        shown[rows.mask] = shares[begun : begun + int(rows.mask.sum())]
        begun += int(rows.mask.sum())
        over_time.plot(look.time, shown, color=ACCENT, linewidth=0.8)
        if record.plan != REPEATED:
            break  # one recording shows it; only what changes over the session needs them all
    over_time.set_xlabel("time (s)", fontsize=SMALL)
    over_time.set_ylabel("effort not explained (N·m)", fontsize=SMALL)
    coordinate = view.coordinate
    own.plot(view.at, view.mean, color=SIMULATED, linewidth=1.2, marker=".", markersize=4)
    if coordinate.logarithmic and 0.0 < DECADE * np.min(view.at) < np.max(view.at):
        own.set_xscale("log")
        own.xaxis.set_minor_formatter(NullFormatter())
    units = {"x": "rad", "f": "N·m", "e": "effort"}
    own.set_xlabel(coordinate.axis.format(**units), fontsize=SMALL)
    upright = (
        coordinate.upright.format(**units)
        .replace("residual over the size of the effort, %", "share of the effort")
        .replace(", %", ", share")
    )
    along = "its mean along the motion (N·m)" if coordinate.odd else "its mean (N·m)"
    own.set_ylabel(upright or along, fontsize=SMALL)
    return drawn


def followed(
    plant: st.Plant, motor: st.Motor, path: np.ndarray, channels: dict[str, np.ndarray]
) -> np.ndarray:
    """Input with which a loop follows a path: that of the plant, and what its error asks for."""
    stiff, damp = plant.inertia * CORNER**2, 1.4 * plant.inertia * CORNER
    ahead = needed(plant, path)
    speed = np.gradient(path, DT)
    x = v = 0.0
    driven = np.empty(len(path))
    for k in range(len(path)):
        effort = ahead[k] + stiff * (path[k] - x) + damp * (speed[k] - v)
        driven[k] = np.clip(effort / plant.gain, -MOST, MOST)
        held = {name: values[k] for name, values in channels.items()}
        x, v = motor.step(driven[k], DT, **held)
    return driven


def needed(plant: st.Plant, path: np.ndarray) -> np.ndarray:
    """Effort that following a path takes, N·m; shape (n,)."""
    motor = plant.follower()
    motor.reset(float(path[0]), 0.0)
    still = np.zeros(len(path) - 1)
    _, ambient, friction, _ = motor.follow(st.Motion(path, still, DT), strict=False)
    bend = np.diff(path, 2, prepend=path[0], append=path[-1]) / DT**2
    taken = plant.inertia * bend
    taken[1:] += friction - ambient
    return np.asarray(taken)
