"""What a residual that depends on a coordinate usually comes from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from ..plant import Plant

__all__ = ["hint"]

HINTS: Final = {
    "velocity": "friction that differs by direction or with speed",
    "speed": "another shape of friction over speed",
    "position": "a pull that depends on place: unbalance, cogging, a cable, a spring",
    "position along the motion": "friction that is higher in some places than in others",
    "angle": "a pull that repeats each turn: unbalance, cogging",
    "angle along the motion": "friction that repeats each turn: a bent shaft, a bearing",
    "order over position": "a pull that repeats with position: cogging, teeth of a gear or belt",
    "order along the motion": "friction that repeats with position: balls, teeth, a bent screw",
    "order over position, times acceleration": "the position sensor: off centre, or wrongly "
    "interpolated",
    "order over position, times squared speed": "the position sensor, or an inertia that changes "
    "with position",
    "order over position, times effort": "the drive's gain over position: magnets, commutation",
    "acceleration": "inertia, or a part that moves by itself",
    "response to the effort": "a delay, a filter of the drive, or a shaft that gives",
    "the inertia that is held fixed": "a number in the plant file, or the scale of the effort",
    "the gravity that is held fixed": "a number in the plant file, or the scale of the effort",
    "the direction of gravity that is held fixed": "a number in the plant file, or an offset",
    "the weight that is held fixed": "a number in the plant file, or an offset",
    "acceleration, recording by recording": "an inertia that is not the same in all recordings: a "
    "payload, a tool, a mounting",
    "effort, recording by recording": "a drive whose gain is not the same in all recordings: warm "
    "magnets, a supply, a scale of the log",
    "frequency": "the mains, a fan, a neighbouring machine",
    "single moments in time": "what comes once: a drive at its limit, a cable, a person, a machine "
    "nearby",
    "effort": "the drive: gain, saturation, dead zone",
    "rate of the effort": "a delay or lag between input and effort",
    "distance since the reversal": "friction just after a turn: pre-sliding, backlash",
    "time since the reversal": "friction that builds up or relaxes: creep, dwell, lag",
    "rest before the slide": "a contact that grows stronger at rest",
    "loading before the slide": "a contact that holds more when it is loaded slowly",
    "session time": "an offset that drifts during the session",
    "session time along the motion": "friction that drifts during the session: warm-up, wear",
    "load along the motion": "friction that grows with what the machine carries: gears, screws",
    "temperature along the motion": "friction that changes with temperature: grease",
    "path along the motion": "friction that changes with use: run-in, wear",
}
"""By the name of the coordinate."""
MOVED: Final = {
    "single moments in time": "what comes once: a cable, a person, a machine nearby",
    "acceleration": "a mass between the specimen and the sensor of the effort",
    "response to the effort": "effort and position that are not stamped alike, or a fixture that "
    "gives",
    "effort": "the calibration of the sensor of the effort, or friction that grows with the effort",
    "rate of the effort": "effort and position that are not stamped alike",
    "order over position, times effort": "the calibration of the sensor of "
    "the effort over position",
    "acceleration, recording by recording": "a mass between the specimen and the sensor of the "
    "effort that is not the same in all recordings",
    "effort, recording by recording": "a specimen or a calibration that is not the same in all "
    "recordings",
}
"""The same where a rig moves a specimen: there is no drive that could be the cause."""


def hint(coordinate: str, plant: Plant) -> str:
    """What a residual over a coordinate usually points to on such a machine, "" where unknown."""
    usual = HINTS.get(coordinate, "")
    return MOVED.get(coordinate, usual) if plant.prescribed_motion else usual
