"""SDFormat: the ``<dynamics>`` of an axis, and the whole plant beside it."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

from ...plant.joint import body_losses, joint_of, loop_losses, losses_of, sidecar
from ..made import Export
from ..runs import EffortRun, dry_friction

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "<dynamics> of an axis (Gazebo), and a JSON file with the rest"


def write(plant: Plant, speed: float) -> Export:
    """A model of one joint; its ``<dynamics>`` goes into the axis that people have."""
    joint = joint_of(plant, speed)
    lost = (
        *losses_of(plant, joint),
        "inertia of the rotor: an axis of SDFormat has none",
        *body_losses(plant),
        *loop_losses(plant),
    )
    kind = "revolute" if plant.motion == "rotary" else "prismatic"
    text = (
        '<?xml version="1.0"?>\n<sdf version="1.9">\n  <model name="plant">\n'
        '    <link name="base"/>\n    <link name="moved"/>\n'
        f'    <joint name="joint" type="{kind}">\n      <parent>base</parent>\n'
        "      <child>moved</child>\n      <axis>\n        <xyz>0 0 1</xyz>\n        <dynamics>\n"
        f"          <damping>{joint.damping!r}</damping>\n"
        f"          <friction>{joint.friction!r}</friction>\n"
        "        </dynamics>\n      </axis>\n    </joint>\n  </model>\n</sdf>\n"
    )
    numbers = {"damping": joint.damping, "friction": joint.friction}
    held = ("Coulomb and viscous friction",)
    files = {"joint.sdf": text, "joint.json": sidecar(plant, numbers, lost)}
    return Export("sdf", files, held, lost, numbers)


def runs(made: Export, plant: Plant) -> tuple[EffortRun]:
    """The joint that was written, as a simulator reads it."""
    dynamics = next(ET.fromstring(made.files["joint.sdf"]).iter("dynamics"))
    numbers = {each.tag: float(each.text or "0") for each in dynamics}
    return dry_friction(plant, numbers["friction"], numbers["damping"])
