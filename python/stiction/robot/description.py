"""What a URDF says of its joints, beside what pinocchio reads."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ..errors import InputError
from ..given import regular

__all__ = ["Description", "Mimic", "described"]

_LARGEST: Final = 2**24
_MOVING: Final = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: position = multiplier · position of ``joint`` + offset."""

    joint: str
    multiplier: float
    offset: float


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
    """

    name: str
    kinds: Mapping[str, str]
    mimics: Mapping[str, Mimic]

    @property
    def free(self) -> tuple[str, ...]:
        """Joints that move and follow no other."""
        return tuple(name for name in self.kinds if name not in self.mimics)


def described(urdf: Path) -> Description:
    """Read the joints of a URDF.

    Parameters
    ----------
    urdf : Path

    Raises
    ------
    InputError
        No file, no XML, no robot, no joint that moves.
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
    kinds: dict[str, str] = {}
    mimics: dict[str, Mimic] = {}
    for joint in root.findall("joint"):
        name, kind = joint.get("name", ""), joint.get("type", "")
        if not name or kind not in _MOVING:
            continue
        kinds[name] = kind
        mimic = joint.find("mimic")
        if mimic is not None:
            numbers = [_number(mimic.get(key), default, urdf, name) for key, default in _NUMBERS]
            mimics[name] = Mimic(mimic.get("joint", ""), *numbers)
    if not kinds:
        raise InputError(f"{urdf}: has no joint that moves; give the URDF of the arm")
    return Description(root.get("name", ""), kinds, mimics)


_NUMBERS: Final = (("multiplier", 1.0), ("offset", 0.0))


def _number(text: str | None, default: float, urdf: Path, joint: str) -> float:
    try:
        value = default if text is None else float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{urdf}: <mimic> of joint '{joint}' has '{text}' for a number")
    return value
