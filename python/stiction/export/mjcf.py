"""A plant as joint and actuators of MuJoCo: LuGre, cogging, a late input and a servo with them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from ..plant.drive import servo_numbers
from ..plant.joint import beside, joint_of, losses_of
from .pd import PdServo

if TYPE_CHECKING:
    from ..plant import Plant
    from ..plant.stated import Effect

__all__ = ["LATE", "STIFF", "Attributes", "Mjcf"]

WAVE: Final = "cogging"
TURN: Final = "gravity_unbalance"
LATE: Final = "input_delay"
SLOW: Final = "goal_rate_limit"
"""Effects that simulators have elements for."""
SHORTEST_STEP: Final = 2e-5
"""Of a simulation, s, for which the buffer of a late input has room."""
CREEPS: Final = (
    "true stick: frictionloss of MuJoCo is a soft constraint, under which a joint at rest creeps"
)

STIFF: Final = {"solreffriction": (1e-4, 1.0), "solimpfriction": (0.9999, 0.9999, 1e-3)}
"""Of the constraint that is frictionloss: as stiff as the time step allows, which MuJoCo sees to.
The default lets a joint yield over 20 ms."""

Attributes = Mapping[str, str | float | tuple[float, ...]]


@dataclass(frozen=True)
class Mjcf:
    """A joint and the actuators on it, in the words of MJCF.

    Attributes
    ----------
    joint : dict of str to float
    actuators : tuple of (str, dict)
        Element and attributes of each, without the joint; the drive is the first.
    held, lost : tuple of str
    """

    joint: dict[str, float]
    actuators: tuple[tuple[str, Attributes], ...]
    held: tuple[str, ...]
    lost: tuple[str, ...]

    @classmethod
    def of(cls, plant: Plant, speed: float) -> Mjcf:
        """Of a plant; where its law is not that of MuJoCo, fitted up to a greatest speed."""
        bristles, waves = _bristles(plant), list(_waves(plant))
        drive, own = _drive(plant)
        own |= {name for name, _ in waves}
        inertia = 0.0 if plant.prescribed_motion else float(plant.inertia)
        if bristles is None:
            joint = joint_of(plant, speed)
            numbers = {"damping": joint.damping, "frictionloss": joint.friction}
            held = ["Coulomb and viscous friction"]
            lost = [*losses_of(plant, joint, limited=True, own=own), CREEPS]
        else:
            viscous = float(plant.friction.model().parameters["viscous"])
            numbers = {"damping": viscous, "frictionloss": 0.0}
            held = [f"the law {plant.friction.law}, by the lugre of a dcmotor, and its damping"]
            lost = list(beside(plant, lambda e: e.name in own, limited=True, yielding=True))
            if bristles[1] > 0.0 < inertia:
                lost.append(
                    "the damper of the bristles in time steps that are not well below "
                    f"{inertia / bristles[1]:.3g} s: MuJoCo takes it from the step before"
                )
        if plant.servo and drive[0] == "dcmotor":
            held.append("the controller of the servo and its motor, back-EMF with it")
            if plant.drive.get("integral", 0.0):
                lost.append("how the integral of the servo stops at its limits")
        if math.isfinite(float(plant.drive.get("limit", math.inf))):
            held.append("the limit of the drive")
        held += [each.name for each in plant.effects if each.name in own]
        return cls(
            {"armature": inertia, **numbers},
            (drive, *_passive(bristles, [wave for _, wave in waves])),
            ("inertia as armature", *held),
            tuple(lost),
        )


def _numbers(effect: Effect) -> dict[str, float]:
    """Parameters of an effect, defaults with them."""
    stated = {name: each.value for name, each in effect.parameters.items()}
    return {each.name: stated.get(each.name, each.default) for each in effect.record.parameters}


def _bristles(plant: Plant) -> tuple[float, ...] | None:
    """Stiffness, damping, levels and Stribeck velocity of MuJoCo's LuGre; None for other laws."""
    law, own = plant.friction.law, plant.friction.model().parameters
    if law == "dahl" and own["exponent"] == 1.0:
        # Dahl's law is LuGre without a damper, whose level is the same at every speed.
        return (own["initial_stiffness"], 0.0, own["coulomb"], own["coulomb"], 1.0)
    fits = own.get("stribeck_exponent") == 2.0 and own.get("damping_velocity") == math.inf
    if law != "lugre" or not fits:
        return None
    names = ("initial_stiffness", "damping", "coulomb", "breakaway", "stribeck_velocity")
    return tuple(own[name] for name in names)


def _waves(plant: Plant) -> Iterator[tuple[str, tuple[float, float, float]]]:
    """Efforts that repeat over the place: name of the effect; amplitude, order and phase."""
    for effect in plant.effects:
        values = _numbers(effect)
        if effect.name == TURN:
            values["order"] = 1.0
        elif effect.name != WAVE:
            continue
        for end in ("", "_2"):
            cosine, sine = values.get(f"cosine{end}", 0.0), values.get(f"sine{end}", 0.0)
            if cosine or sine:
                phase = math.atan2(cosine, sine)
                yield effect.name, (math.hypot(cosine, sine), values[f"order{end}"], phase)


def _passive(
    bristles: tuple[float, ...] | None, waves: list[tuple[float, float, float]]
) -> Iterator[tuple[str, Attributes]]:
    """Motors without an input, that have what a joint of MuJoCo has not."""
    for number in range(max(len(waves), bristles is not None)):
        own: dict[str, str | float | tuple[float, ...]] = {
            "name": f"friction_{number + 1}" if number else "friction",
            "input": "none",
            "motorconst": (0.0, 0.0),
            "resistance": 1.0,
        }
        if bristles is not None and number == 0:
            own["lugre"] = bristles
        if number < len(waves):
            own[WAVE] = waves[number]  # as MJCF calls it too
        yield "dcmotor", own


def _drive(plant: Plant) -> tuple[tuple[str, Attributes], set[str]]:
    """The motor, and names of the effects that it has."""
    own: dict[str, str | float | tuple[float, ...]] = {"name": "motor"}
    effects = {each.name: _numbers(each) for each in plant.effects}
    held = {LATE} & effects.keys()
    if held:
        delay = effects[LATE]["delay"]
        own |= {"delay": delay, "nsample": math.ceil(delay / SHORTEST_STEP) + 1}
    servo, numbers = PdServo.of(plant), servo_numbers(plant.drive)
    if servo is None or numbers is None:
        own["gear"] = plant.gain
        limit = float(plant.drive.get("limit", math.inf))
        if math.isfinite(limit):
            own |= {"ctrllimited": "true", "ctrlrange": (-limit, limit)}
        return ("motor", own), held
    slew = 0.0
    if SLOW in effects:
        held |= {SLOW}
        slew = 1.0 / effects[SLOW]["slowness"]
    # MuJoCo adds the voltage that the motor induces, which no such servo does: the damping, which
    # has it, takes it off.
    gains, voltage = (servo.stiffness, servo.integral, servo.damping), servo.no_load * plant.gain
    own |= {
        "input": "pos",
        "motorconst": (plant.gain, plant.gain),
        "resistance": numbers["resistance"],
        "controller": (*gains, slew, 0.0, voltage),
    }
    if servo.most < servo.stall:
        own["saturation"] = (servo.most, 0.0, 0.0)
    return ("dcmotor", own), held
