"""A robot as its file describes it: a URDF, and what each joint is measured and driven by."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from .._support import given
from .._support.given import number
from .._support.keys import check_keys, choice
from .._support.units import Motion
from ..catalogue import effects
from ..errors import InputError
from ..plant import Plant
from ..plant.drive import INPUTS
from ..plant.plant_file import read_toml, section
from ..recording import Columns
from .description import JointLimits, read_urdf
from .dynamics import Arm
from .limits import limits_table

__all__ = ["Joint", "Robot", "describes_robot"]

_KEYS: Final = ("urdf", "locked", "gravity", "joints")
_JOINT: Final = ("name", "columns", "drive", "rotor_inertia", "friction", "effects", "limits")
_DRIVE: Final = ("input", "gain", "gear_ratio")
_COLUMNS: Final = ("position", "velocity", "input", "temperature")
BIAS: Final = {"name": next(record.name for record in effects() if record.constant)}
"""What drifts and offsets of a drive's zero leave; beside it a structure is measured."""


@dataclass(frozen=True)
class Joint:
    """One joint of a robot.

    Attributes
    ----------
    name : str
        In the URDF.
    motion : {"rotary", "linear"}
    columns : Columns
        ``position`` and ``input``, and where they are recorded ``velocity`` and ``temperature``.
    input : str
        What drives it: current_a, voltage_v, torque_nm or force_n.
    gain : float
        Effort of the motor per unit of input.
    gear_ratio : float
        Turns of the motor to one of the joint.
    friction : mapping
        As [friction] of a plant file.
    effects : sequence of mapping
        As [[effects]].
    rotor_inertia : float
        Of motor and gear on the side of the joint, kg·m² or kg, where it is known: for exports.
    limits : mapping
        ``position`` (from and to, rad or m), ``speed`` and ``effort`` where they are narrower than
        in the URDF: for plans.
    """

    name: str
    motion: Motion
    columns: Columns
    input: str
    gain: float = 1.0
    gear_ratio: float = 1.0
    friction: Mapping[str, Any] = field(default_factory=lambda: {"law": "coulomb"})
    effects: Sequence[Mapping[str, Any]] = ()
    rotor_inertia: float = 0.0
    limits: Mapping[str, Any] = field(default_factory=dict)

    @property
    def effort_per_input(self) -> float:
        """Effort at the joint per unit of input."""
        return self.gain * self.gear_ratio

    def plant(self, inertia: float, source: str = "joint") -> Plant:
        """The joint as a machine of one axis, whose load is what the links need.

        Parameters
        ----------
        inertia : float
            Of its rotor, on the side of the joint: where the fit starts.
        source : str
            What messages call it.

        Raises
        ------
        InputError
            As for ``Plant.from_dict``.
        """
        plain = any(effect.get("name") == BIAS["name"] for effect in self.effects)
        table = {
            "motion": {"kind": self.motion},
            "drive": {"input": self.input, "gain": self.effort_per_input},
            "body": {"inertia": _inertia(inertia, f"{source}: inertia")},
            "friction": dict(self.friction),
            "effects": [dict(e) for e in self.effects] + ([] if plain else [dict(BIAS)]),
        }
        return Plant.from_dict(table, source=source)


@dataclass(frozen=True)
class Robot:
    """A robot: its links and its joints.

    Attributes
    ----------
    urdf : Path
    joints : tuple of Joint
        From the base on.
    locked : mapping of str to float
        Joints that rest, and where.
    gravity : tuple of float or None
        In the frame of the base, m/s²; None for 9.81 downwards.
    source : str
        Where it was read, for messages.
    """

    urdf: Path
    joints: tuple[Joint, ...]
    locked: Mapping[str, float] = field(default_factory=dict)
    gravity: tuple[float, float, float] | None = None
    source: str = field(default="robot", compare=False)

    @classmethod
    def load(cls, path: str | Path) -> Robot:
        """Read a robot file.

        Parameters
        ----------
        path : str or Path
            TOML with a table [robot].

        Raises
        ------
        InputError
            No path, missing file, not TOML, unknown or missing keys, wrong types, a joint that the
            URDF has not.
        """
        path = given.path(path, "Robot.load")
        table = read_toml(path, least='[robot] urdf = "arm.urdf"')
        return cls.from_dict(table, folder=path.parent, source=str(path))

    @classmethod
    def from_dict(
        cls, table: Mapping[str, Any], *, folder: Path = Path(), source: str = "robot"
    ) -> Robot:
        """A robot from the tables of a robot file.

        Parameters
        ----------
        table : mapping
        folder : Path
            That the path of the URDF starts from.
        source : str
            What messages call it.

        Raises
        ------
        InputError
            As for ``load``.
        """
        table = given.mapping(table, source, "the tables of a robot file")
        check_keys(table, ("robot",), source)
        own = section(table, "robot", source)
        where = f"{source}: [robot]"
        check_keys(own, _KEYS, where)
        named = own.get("urdf")
        if not isinstance(named, str) or not named or "\0" in named:
            raise InputError(f'{where} urdf = {given.brief(named)}; write urdf = "arm.urdf"')
        urdf = given.path(folder, "Robot.from_dict: folder") / named
        kinds = read_urdf(urdf).kinds
        entries = own.get("joints", [])
        if not isinstance(entries, list) or not entries:
            raise InputError(
                f"{where} has no joints; write a table [[robot.joints]] for each that is measured"
            )
        joints = [
            _joint(entry, kinds, f"{source}: joint {k}") for k, entry in enumerate(entries, 1)
        ]
        names = [joint.name for joint in joints]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"{source}: joint '{name}' is there twice; drop one")
        robot = cls(
            urdf,
            tuple(sorted(joints, key=lambda joint: list(kinds).index(joint.name))),
            _locked(section(own, "locked", where), f"{where} locked"),
            _gravity(own.get("gravity"), f"{where} gravity"),
            source,
        )
        for joint in robot.joints:
            # What is wrong with a joint's friction is said before anything is read.
            joint.plant(0.0, f"{source}: joint '{joint.name}'")
        return robot

    @property
    def names(self) -> tuple[str, ...]:
        """Of the joints."""
        return tuple(joint.name for joint in self.joints)

    @cached_property
    def stated_limits(self) -> Mapping[str, JointLimits]:
        """What the URDF says that its joints may do, by joint.

        Raises
        ------
        InputError
            The URDF is gone.
        """
        return read_urdf(self.urdf).limits

    @cached_property
    def arm(self) -> Arm:
        """Its rigid links.

        Raises
        ------
        InputError
            As for ``Arm``.
        """
        try:
            return Arm(self.urdf, self.names, locked=self.locked, gravity=self.gravity)
        except InputError as error:
            raise InputError(f"{self.source}: {error}") from None


def describes_robot(path: Path) -> bool:
    """Whether a plant file describes a robot."""
    try:
        return "robot" in read_toml(path)
    except InputError:
        # What is wrong with it is told where it is read.
        return False


def _joint(entry: object, kinds: Mapping[str, str], where: str) -> Joint:
    if not isinstance(entry, Mapping):
        raise InputError(f"{where} is {given.brief(entry)}; write a table [[robot.joints]]")
    check_keys(entry, _JOINT, where)
    if "name" not in entry:
        raise InputError(f'{where}: name is missing; write name = "…", as in the URDF')
    name = choice(entry["name"], kinds, f"{where} name")
    where = f"{where} ('{name}')"
    motion: Motion = "linear" if kinds[name] == "prismatic" else "rotary"
    drive = section(entry, "drive", where)
    check_keys(drive, _DRIVE, f"{where} drive")
    if "input" not in drive:
        raise InputError(
            f'{where}: drive is missing; write drive = {{ input = "current_a", gain = 1.0 }}'
        )
    effort = "force_n" if motion == "linear" else "torque_nm"
    inputs = [name for name in INPUTS if name in ("current_a", "voltage_v", effort)]
    columns = section(entry, "columns", where)
    check_keys(columns, _COLUMNS, f"{where} columns")
    if "input" not in columns or not {"position", "velocity"} & set(columns):
        raise InputError(
            f"{where}: columns lacks the input, or position and velocity both; write "
            'columns = { position = "…", input = "…" }'
        )
    effects = entry.get("effects", [])
    if not isinstance(effects, list) or not all(isinstance(e, Mapping) for e in effects):
        raise InputError(f"{where}: effects is no list of tables; write [[robot.joints.effects]]")
    return Joint(
        name,
        motion,
        Columns.parse(columns, where=f"{where} columns"),
        choice(drive["input"], inputs, f"{where} drive input"),
        _above_zero(drive.get("gain", 1.0), f"{where} gain"),
        _above_zero(drive.get("gear_ratio", 1.0), f"{where} gear_ratio"),
        {"law": "coulomb", **section(entry, "friction", where)},
        tuple(effects),
        _inertia(entry.get("rotor_inertia", 0.0), f"{where} rotor_inertia"),
        limits_table(section(entry, "limits", where), f"{where} limits"),
    )


def _inertia(value: object, where: str) -> float:
    found = number(value, where)
    if not 0.0 <= found < math.inf:
        raise InputError(f"{where} = {found:g} is out of bounds: give a finite number from 0")
    return found


def _above_zero(value: object, where: str) -> float:
    found = number(value, where)
    if not 0.0 < found < 1e12:
        raise InputError(
            f"{where} = {found:g} is out of bounds: give a finite number above 0; what turns "
            "round is the column, with scale = -1.0"
        )
    return found


def _locked(table: Mapping[str, Any], where: str) -> dict[str, float]:
    found = {name: number(value, f"{where} {name}") for name, value in table.items()}
    for name, value in found.items():
        if not math.isfinite(value):
            raise InputError(f"{where} {name} = {value}: give a finite position")
    return found


def _gravity(value: object, where: str) -> tuple[float, float, float] | None:
    if value is None:
        return None
    told = f"{where} = {given.brief(value)}: give three numbers in m/s², as in [0.0, 0.0, -9.81]"
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(told)
    x, y, z = (number(part, where) for part in value)
    if not all(map(math.isfinite, (x, y, z))):
        raise InputError(told)
    return x, y, z
