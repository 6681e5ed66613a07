"""Messages of robots (ROS): which of them hold signals, and what these are called.

`sensor_msgs/JointState` and the controller states of `control_msgs` name their joints in a list
beside lists of numbers: each number becomes ``<topic>.<joint>.<quantity>``.  Units are those that
the messages are defined in: rad, rad/s, N·m.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, Final

import numpy as np

from .gathered import Gathered

__all__ = ["add_message", "is_read", "why_not"]

_READ: Final = (
    *("sensor_msgs/JointState", "sensor_msgs/Temperature", "sensor_msgs/Imu"),
    *("geometry_msgs/WrenchStamped", "geometry_msgs/Wrench", "trajectory_msgs/JointTrajectory"),
    *(f"std_msgs/{kind}" for kind in ("Float64", "Float32", "Float64MultiArray", "Int32", "Int64")),
    *("std_msgs/Float32MultiArray", "control_msgs/"),
)
_NAMES: Final = ("name", "joint_names", "joint_name")
_SINGULAR: Final = {
    "positions": "position",
    "velocities": "velocity",
    "accelerations": "acceleration",
    "efforts": "effort",
}
_UNITS: Final = {"position": "rad", "velocity": "rad/s", "effort": "Nm"}
_PASSED_OVER: Final = ("header", "layout", "time_from_start")
_LONGEST: Final = 256
_DEEPEST: Final = 4
_NS: Final = 1e-9


def is_read(kind: str) -> bool:
    """Whether messages of a type are read; ``sensor_msgs/msg/JointState`` and without ``msg``."""
    short = kind.replace("/msg/", "/")
    return any(short == known or (known[-1] == "/" and short.startswith(known)) for known in _READ)


def why_not(kind: str) -> str:
    """Why no column is made of messages of this type."""
    return f"holds {kind}, of which no signal is read"


def add_message(found: Gathered, topic: str, received_ns: int, message: Any) -> None:
    """Add a decoded message as a row of its topic.

    Parameters
    ----------
    found : Gathered
    topic : str
    received_ns : int
        Since 1970; taken where the message has no stamp of its own.
    message : object
        With its fields as attributes.
    """
    group = topic.strip("/").replace("/", ".")
    values = dict(_numbers(message, "", (), 0))
    for name in values:
        last = name.rpartition(".")[2]
        if last in _UNITS:
            found.units.setdefault(f"{group}.{name}", _UNITS[last])
    if values:
        begins = found.begins
        if begins is None:
            begins = found.begins = float(received_ns // 10**9)
        found.row(group, _seconds(message, received_ns, int(begins)), values)


def _seconds(message: Any, received_ns: int, begins: int) -> float:
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    second = getattr(stamp, "sec", getattr(stamp, "secs", 0))
    nano = getattr(stamp, "nanosec", getattr(stamp, "nsecs", 0))
    if isinstance(second, int) and isinstance(nano, int) and second > 0:
        return (second - begins) + _NS * nano
    return _NS * (received_ns - begins * 10**9)


def _numbers(value: Any, name: str, joints: tuple[str, ...], depth: int) -> Iterator[Any]:
    """Every number of a message, under a dotted name."""
    own = _joints(value) or joints
    for field in _fields(value):
        inside = getattr(value, field, None)
        if field in _PASSED_OVER or field in _NAMES:
            continue
        path = f"{name}.{field}" if name else field
        if isinstance(inside, (bool, int, float, np.number)):
            yield path, float(inside)
        elif isinstance(inside, (list, tuple, array, np.ndarray)):
            yield from _list(inside, name, field, own, depth)
        elif inside is not None and depth < _DEEPEST:
            yield from _numbers(inside, path, own, depth + 1)


def _list(values: Any, name: str, field: str, joints: tuple[str, ...], depth: int) -> Iterator[Any]:
    if not 0 < len(values) <= _LONGEST:
        return
    before = f"{name}." if name else ""
    quantity = _SINGULAR.get(field, field)
    if isinstance(values[0], (bool, int, float, np.number)):
        for place, number in enumerate(values):
            if len(values) == len(joints):
                yield f"{before}{joints[place]}.{quantity}", float(number)
            else:
                yield f"{before}{quantity}[{place}]", float(number)
    elif len(values) == len(joints) and depth < _DEEPEST:
        # DynamicJointState: for each joint its interfaces, names and values.
        for joint, inside in zip(joints, values, strict=True):
            interfaces = getattr(inside, "interface_names", ())
            for interface, number in zip(interfaces, getattr(inside, "values", ()), strict=False):
                yield f"{before}{joint}.{interface}", float(number)


def _joints(value: Any) -> tuple[str, ...]:
    for field in _NAMES:
        names = getattr(value, field, None)
        if isinstance(names, (list, tuple)) and names and all(isinstance(n, str) for n in names):
            return tuple(each.replace(".", "_").replace("/", "_") for each in names)
    return ()


def _fields(value: Any) -> tuple[str, ...]:
    if type(value) is SimpleNamespace:
        return tuple(vars(value))
    named: Any = getattr(value, "__dataclass_fields__", None) or getattr(value, "__slots__", ())
    return tuple(field for field in named if not field.startswith("_"))
