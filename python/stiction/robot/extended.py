"""The robot file with what was found: laws and effects of each joint."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..plant.plant_file import render
from ..recording.columns import Column

if TYPE_CHECKING:
    from .result import RobotDiagnosis
    from .robot import Joint, Robot

__all__ = ["extended_text", "robot_text"]


def extended_text(diagnosis: RobotDiagnosis, folder: Path) -> str:
    """The text of robot.toml: as it was given, with what was found of each joint."""
    robot = diagnosis.fit.session.robot
    found = {joint.name: joint.diagnosis.plant.to_dict() for joint in diagnosis.joints}
    rotors = dict(zip(robot.names, diagnosis.fit.arm.rotors, strict=True))
    stated = {
        joint.name: {
            "rotor_inertia": float(rotors[joint.name]),
            **_stated(joint, found.get(joint.name, {})),
        }
        for joint in robot.joints
    }
    return robot_text(robot, stated, folder)


def _stated(joint: Joint, plant: dict[str, Any]) -> dict[str, Any]:
    friction = plant.get("friction", dict(joint.friction))
    effects = plant.get("effects", [dict(effect) for effect in joint.effects])
    return {"friction": friction, "effects": effects}


def robot_text(robot: Robot, joints: dict[str, dict[str, Any]], folder: Path) -> str:
    """A robot file.

    Parameters
    ----------
    robot : Robot
    joints : dict of str to dict
        ``rotor_inertia``, ``friction`` and ``effects`` of each.
    folder : Path
        That it will stand in.
    """
    own: dict[str, Any] = {"urdf": relative(robot.urdf, folder)}
    if robot.locked:
        own["locked"] = dict(robot.locked)
    if robot.gravity is not None:
        own["gravity"] = list(robot.gravity)
    entries = []
    for joint in robot.joints:
        drive = {"input": joint.input, "gain": joint.gain}
        if joint.gear_ratio != 1.0:
            drive["gear_ratio"] = joint.gear_ratio
        entry: dict[str, Any] = {
            "name": joint.name,
            "columns": {role: _column(column) for role, column in joint.columns.items()},
            "drive": drive,
            **joints[joint.name],
            "limits": dict(joint.limits),
        }
        entries.append({key: value for key, value in entry.items() if value})
    return render({"robot": own, "robot.joints": entries})


def relative(path: Path, folder: Path) -> str:
    """A path as a file in the folder names it."""
    try:
        return Path(os.path.relpath(path.resolve(), folder.resolve())).as_posix()
    except ValueError:  # another drive
        return path.resolve().as_posix()


def _column(column: Column) -> Any:
    told: dict[str, Any] = {"name": column.name}
    if column.unit is not None:
        told["unit"] = column.unit
    if column.scale != 1.0:
        told["scale"] = column.scale
    if column.offset != 0.0:
        told["offset"] = column.offset
    return told if len(told) > 1 else column.name
