"""What a draft assumes, in three lines."""

from __future__ import annotations

from .._support.units import bare_name
from .._support.wording import plural
from ..plant import Plant
from ..session import Session
from .draft import Draft
from .text import GAIN_UNIT

__all__ = ["assumptions"]


def assumptions(draft: Draft, session: Session, plant: Plant) -> tuple[str, str, str]:
    """Columns and units; gain, law and inertia; sampling and encoder.

    Parameters
    ----------
    draft : Draft
    session : Session
        Of its recordings.
    plant : Plant
        That it drafts.

    Returns
    -------
    tuple of str
        One line each.
    """
    return _columns(draft), _plant(draft, plant), _sampling(session, plant)


def _columns(draft: Draft) -> str:
    told = []
    for role, one in draft.found.by_role.items():
        scale = "" if one.scale == 1.0 else f", times {one.scale:g}"
        unit = one.unit or "1"
        if role == "input" and draft.found.input_unknown:
            joint_state = unit in ("Nm", "N")
            why = (
                "JointState defines it so, drivers may write current"
                if joint_state
                else "nothing tells what it is measured in"
            )
            unit = f"{unit} is a guess: {why}"
        name = bare_name(one.column) if one.unit else one.column
        told.append(f"{role} = {' '.join(name.split())} [{unit}{scale}]")
    joint = f"; joint {draft.joints[0]} of {len(draft.joints)} (--joint)" if draft.joints else ""
    return f"columns: {', '.join(told)}{joint} (--columns states others)"


def _plant(draft: Draft, plant: Plant) -> str:
    unit = GAIN_UNIT.get(draft.found.drive or "")
    si = plant.si_effort_unit
    if plant.prescribed_motion:
        drive = "it is moved, and its effort is measured"
    elif unit is None:
        drive = f"the input is in {si} already"
    elif draft.gain is None:
        drive = (
            f"gain unknown, so every effort, friction and inertia is in {unit} and not in {si} "
            f"until --gain states the {si}/{unit}"
        )
    else:
        drive = f"gain {draft.gain:g} {si}/{unit}, as stated"
    mass = "inertia" if plant.motion == "rotary" else "mass"
    mass = f"no {mass} beyond the sensor" if plant.prescribed_motion else f"{mass} fitted"
    return f"plant: {plant.motion}; {drive}; law {draft.law} (--law names another); {mass}"


def _sampling(session: Session, plant: Plant) -> str:
    steps = sorted({float(f"{1e3 * each.dt:.3g}") for each in session})
    every = f"{steps[0]:g} ms" if len(steps) == 1 else f"{steps[0]:g} to {steps[-1]:g} ms"
    lasts = sum(each.duration for each in session)
    if "counts_per_rev" in plant.sensor:
        encoder = f"encoder of {plant.sensor['counts_per_rev']:g} counts a turn"
    elif plant.count:
        encoder = f"encoder of {plant.count:g} {plant.position_unit} a count"
    else:
        encoder = "no encoder steps found, noise is estimated from the readings"
    made = plural(len(session), "recording")
    return f"sampling: every {every}, {lasts:.3g} s in {made}; {encoder}"
