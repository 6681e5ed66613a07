"""What a URDF says of its joints, beside what pinocchio reads."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from .._support.given import regular
from ..errors import InputError

__all__ = ["Description", "JointLimits", "Mimic", "read_urdf"]

_LARGEST: Final = 2**24
_MOVING: Final = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: position = multiplier · position of ``joint`` + offset."""

    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class JointLimits:
    """What a joint may do, None where nobody says.

    Attributes
    ----------
    position : tuple of float or None
        From and to, rad or m.
    speed : float or None
        rad/s or m/s.
    effort : float or None
        N·m or N.
    """

    position: tuple[float, float] | None = None
    speed: float | None = None
    effort: float | None = None


@dataclass(frozen=True)
class Description:
    """The joints of a URDF.

    Attributes
    ----------
    name : str
        Of the robot.
    kinds : mapping of str to str
        revolute, continuous or prismatic, by joint, in the order of the file.
    mimics : mapping of str to Mimic
    limits : mapping of str to JointLimits
        By joint; a limit of 0 states none.
    """

    name: str
    kinds: Mapping[str, str]
    mimics: Mapping[str, Mimic]
    limits: Mapping[str, JointLimits] = field(default_factory=dict)

    @property
    def free(self) -> tuple[str, ...]:
        """Joints that move and follow no other."""
        return tuple(name for name in self.kinds if name not in self.mimics)


def read_urdf(urdf: Path) -> Description:
    """Read the joints of a URDF.

    Parameters
    ----------
    urdf : Path

    Raises
    ------
    InputError
        No file, no XML, no robot, no joint that moves; joints that are no tree, an axis or an
        inertia that is none.
    """
    try:
        if regular(urdf).st_size > _LARGEST:
            raise InputError(f"{urdf}: is larger than 16 MiB, and no URDF is; check the path")
        root = ElementTree.fromstring(urdf.read_bytes())
    except FileNotFoundError:
        raise InputError(f"{urdf}: there is no such file; check the path of the URDF") from None
    except OSError as error:
        raise InputError(f"{urdf}: cannot be read ({error.strerror}); check the path") from None
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise InputError(f"{urdf}: is not XML ({error}); give a URDF") from None
    if root.tag != "robot":
        raise InputError(f"{urdf}: its root is <{root.tag}> and not <robot>; give a URDF")
    _check_tree(root, urdf)
    for link in root.findall("link"):
        _check_inertial(link, urdf)
    kinds: dict[str, str] = {}
    mimics: dict[str, Mimic] = {}
    limits: dict[str, JointLimits] = {}
    for joint in root.findall("joint"):
        name, kind = joint.get("name", ""), joint.get("type", "")
        if not name or kind not in _MOVING:
            continue
        kinds[name] = kind
        limits[name] = _limits(joint, kind)
        mimic = joint.find("mimic")
        if mimic is not None:
            numbers = [_number(mimic.get(key), default, urdf, name) for key, default in _NUMBERS]
            mimics[name] = Mimic(mimic.get("joint", ""), *numbers)
    if not kinds:
        raise InputError(f"{urdf}: has no joint that moves; give the URDF of the arm")
    return Description(root.get("name", ""), kinds, mimics, limits)


def _check_tree(root: ElementTree.Element, urdf: Path) -> None:
    """Refuses joints between links that are not there, and links that hang on two or on themselves.

    pinocchio refuses some of them as well, after its parser has printed lines of its own.
    """
    links = _once([link.get("name", "") for link in root.findall("link")], "link", urdf)
    joints = root.findall("joint")
    _once([joint.get("name", "") for joint in joints], "joint", urdf)
    parents: dict[str, str] = {}
    for joint in joints:
        name = joint.get("name", "")
        ends = []
        for role in ("parent", "child"):
            found = joint.find(role)
            ends.append("" if found is None else found.get("link", ""))
            if ends[-1] not in links:
                raise InputError(
                    f"{urdf}: the {role} of joint '{name}' is link '{ends[-1]}', which the file "
                    "does not have; give the whole URDF"
                )
        parent, child = ends
        if child in parents:
            raise InputError(f"{urdf}: link '{child}' hangs on two joints; a URDF is a tree")
        parents[child] = parent
        _check_axis(joint, urdf)
    for link in links:
        above, steps = link, 0
        while above in parents and steps <= len(links):
            above, steps = parents[above], steps + 1
        if steps > len(links):
            raise InputError(f"{urdf}: link '{link}' hangs on itself; a URDF is a tree")


def _once(names: list[str], what: str, urdf: Path) -> list[str]:
    """The names, each of which stands there once."""
    for place, name in enumerate(names):
        if name in names[:place]:
            raise InputError(f"{urdf}: has {what} '{name}' twice; give each a name of its own")
    return names


def _check_axis(joint: ElementTree.Element, urdf: Path) -> None:
    axis = joint.find("axis")
    if axis is None or joint.get("type") not in _MOVING:
        return
    text = axis.get("xyz", "1 0 0")
    numbers = [_float(part) for part in text.split()]
    if len(numbers) != 3 or not 0.0 < math.hypot(*numbers) < math.inf:
        raise InputError(
            f"{urdf}: the axis of joint '{joint.get('name', '')}' is '{text}'; give three numbers "
            "that are not all 0"
        )


def _check_inertial(link: ElementTree.Element, urdf: Path) -> None:
    """Refuses masses and moments of inertia that no body has."""
    inertial = link.find("inertial")
    if inertial is None:
        return
    for tag, keys in (("mass", ("value",)), ("inertia", ("ixx", "iyy", "izz"))):
        found = inertial.find(tag)
        for key in keys:
            text = "" if found is None else found.get(key, "")
            if not 0.0 <= _float(text) < math.inf:
                raise InputError(
                    f"{urdf}: <{tag}> of link '{link.get('name', '')}' has {key} = '{text}'; give "
                    "a finite number from 0, or leave <inertial> out where nobody knows it"
                )


def _float(text: str) -> float:
    """A number, NaN where it is none."""
    try:
        return float(text)
    except ValueError:
        return math.nan


_NUMBERS: Final = (("multiplier", 1.0), ("offset", 0.0))


def _limits(joint: ElementTree.Element, kind: str) -> JointLimits:
    """Of a joint. A joint without end has none of position, and 0 is what nobody filled in."""
    limit = joint.find("limit")
    if limit is None:
        return JointLimits()
    low, high, speed, effort = (
        _stated(limit.get(key)) for key in ("lower", "upper", "velocity", "effort")
    )
    return JointLimits(
        (low, high) if kind != "continuous" and low < high else None,
        speed if speed > 0.0 else None,
        effort if effort > 0.0 else None,
    )


def _stated(text: str | None) -> float:
    """A limit, 0 where it is none: only plans need it, and say so where it is not there."""
    value = _float(text or "")
    return value if math.isfinite(value) else 0.0


def _number(text: str | None, default: float, urdf: Path, joint: str) -> float:
    value = default if text is None else _float(text)
    if not math.isfinite(value):
        raise InputError(f"{urdf}: <mimic> of joint '{joint}' has '{text}' for a number")
    return value
