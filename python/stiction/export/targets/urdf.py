"""URDF: the ``<dynamics>`` of a joint, and the whole plant beside it."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING, Final

from ...plant.joint import body_losses, joint_of, loop_losses, losses_of, sidecar
from ..made import Export
from ..runs import EffortRun, dry_friction

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "<dynamics damping friction> of a joint, and a JSON file with the rest"

LIMITS: Final = "limits of the slide: URDF asks for some, and a plant knows none; write your own"


def write(plant: Plant, speed: float) -> Export:
    """A robot of one joint; its ``<dynamics>`` goes into the joint that people have."""
    joint = joint_of(plant, speed)
    kind = "continuous" if plant.motion == "rotary" else "prismatic"
    lost = (
        *losses_of(plant, joint),
        "inertia of the rotor: a URDF joint has none",
        *body_losses(plant),
        *loop_losses(plant),
        *(() if kind == "continuous" else (LIMITS,)),
    )
    limit = (
        ""
        if kind == "continuous"
        else '    <limit lower="-1" upper="1" effort="0" velocity="0"/>\n'
    )
    text = (
        '<?xml version="1.0"?>\n<robot name="plant">\n  <link name="base"/>\n'
        f'  <link name="moved"/>\n  <joint name="joint" type="{kind}">\n'
        '    <parent link="base"/>\n    <child link="moved"/>\n    <axis xyz="0 0 1"/>\n'
        f"{limit}"
        f'    <dynamics damping="{joint.damping!r}" friction="{joint.friction!r}"/>\n'
        "  </joint>\n</robot>\n"
    )
    numbers = {"damping": joint.damping, "friction": joint.friction}
    held = ("Coulomb and viscous friction",)
    files = {"joint.urdf": text, "joint.json": sidecar(plant, numbers, lost)}
    return Export("urdf", files, held, lost, numbers)


def runs(made: Export, plant: Plant) -> tuple[EffortRun]:
    """The joint that was written, as a simulator reads it."""
    dynamics = next(ET.fromstring(made.files["joint.urdf"]).iter("dynamics"))
    return dry_friction(plant, *(float(dynamics.attrib[name]) for name in ("friction", "damping")))
