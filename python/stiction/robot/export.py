"""A whole robot for other tools, by the targets that a plant has."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from xml.sax.saxutils import quoteattr

from .._support.keys import choice
from ..errors import InputError
from ..export import Export, targets
from ..export.mjcf import STIFF
from ..export.speeds import greatest_speed
from ..plant import Plant
from ..plant.joint import joint_of, losses_of
from .result import folder_names
from .robot import Robot

__all__ = ["export_robot"]


def export_robot(robot: Robot, to: str, *, speed: float | None = None) -> Mapping[str, Export]:
    """Write the friction of every joint for a target.

    Parameters
    ----------
    robot : Robot
        As a diagnosis writes it.
    to : str
        Target. Of ``urdf`` and ``mujoco`` there is one export for the whole arm: its URDF with
        <dynamics> in each joint, and a <joint> of MJCF for each; of ``ros2`` the parameters of one
        controller; of all others one for each joint.
    speed : float, optional
        Greatest speed at which friction matters, rad/s or m/s.

    Returns
    -------
    mapping of str to Export
        By the folder for it, "" for the target's own.

    Raises
    ------
    InputError
        An unknown target, or a joint that it cannot hold.
    """
    choice(to, tuple(targets()), f"{robot.source}: to")
    plants = {
        joint.name: joint.plant(joint.rotor_inertia, f"{robot.source}: joint '{joint.name}'")
        for joint in robot.joints
    }
    if to == "urdf":
        return {"": _urdf(robot, plants, speed)}
    if to == "mujoco":
        return {"": _mjcf(plants, speed)}
    whole = targets()[to].write_robot
    if whole is not None:
        speeds = {name: greatest_speed(plant, speed) for name, plant in plants.items()}
        return {"": whole(plants, speeds)}
    folders = folder_names(robot.names)
    return {folders[name]: plant.export(to, speed=speed) for name, plant in plants.items()}


def _urdf(robot: Robot, plants: Mapping[str, Plant], speed: float | None) -> Export:
    """The URDF of the robot, with damping and dry friction in each joint."""
    try:
        tree = ET.fromstring(robot.urdf.read_bytes())
    except (OSError, ET.ParseError, ValueError) as error:
        raise InputError(f"{robot.urdf}: cannot be read any more ({error})") from None
    numbers, lost = _numbers(plants, speed)
    for joint in tree.findall("joint"):
        name = joint.get("name", "")
        if name not in plants:
            continue
        own = joint.find("dynamics")
        if own is None:
            own = ET.SubElement(joint, "dynamics")
        own.set("damping", repr(numbers[f"{name}.damping"]))
        own.set("friction", repr(numbers[f"{name}.friction"]))
    text = ET.tostring(tree, encoding="unicode", xml_declaration=True) + "\n"
    lost.append("inertia of the rotors: a URDF joint has none")
    held = ("Coulomb and viscous friction of each joint",)
    return Export("urdf", {robot.urdf.name: text}, held, tuple(lost), numbers)


def _mjcf(plants: Mapping[str, Plant], speed: float | None) -> Export:
    """Attributes of each joint, for the joints of the same names in a model."""
    numbers, lost = _numbers(plants, speed)
    lines = ["<!-- Put these attributes to the joints of the same names in your model. -->"]
    stiff = " ".join(f'{name}="{" ".join(map(repr, own))}"' for name, own in STIFF.items())
    for name, plant in plants.items():
        damping, friction = numbers[f"{name}.damping"], numbers[f"{name}.friction"]
        lines.append(
            f'<joint name={quoteattr(name)} armature="{plant.inertia!r}" damping="{damping!r}" '
            f'frictionloss="{friction!r}" {stiff}/>'
        )
    text = "<mujoco>\n" + "\n".join(lines) + "\n</mujoco>\n"
    bare = [name for name, plant in plants.items() if plant.inertia <= 0.0]
    lost += [f"{name}: armature, for no rotor_inertia is stated" for name in bare]
    rotors = () if bare else ("inertia of the rotors as armature",)
    held = (*rotors, "Coulomb and viscous friction of each joint")
    return Export("mujoco", {"joints.xml": text}, held, tuple(lost), numbers)


def _numbers(
    plants: Mapping[str, Plant], speed: float | None
) -> tuple[dict[str, float], list[str]]:
    """Damping and dry friction of each joint, and what they leave out."""
    numbers: dict[str, float] = {}
    lost: list[str] = []
    for name, plant in plants.items():
        joint = joint_of(plant, greatest_speed(plant, speed))
        numbers[f"{name}.damping"] = joint.damping
        numbers[f"{name}.friction"] = joint.friction
        lost += [f"{name}: {sentence}" for sentence in losses_of(plant, joint)]
    return numbers, lost
