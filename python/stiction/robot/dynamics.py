"""Rigid-body efforts and regressors of an arm, by pinocchio."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.wording import commas, did_you_mean
from ..errors import InputError
from .description import Description, read_urdf

__all__ = ["PER_LINK", "Arm", "Drives"]

PER_LINK: Final = 10
"""Mass, its first moments and its moments of inertia about the joint's frame: m, m·c, then Ixx,
Ixy, Iyy, Ixz, Iyz, Izz (Featherstone 2008, table 2.5; the order is pinocchio's)."""


@dataclass(frozen=True)
class Drives:
    """Which joints of a description move with what is measured.

    Attributes
    ----------
    names : tuple of str
        Joints that are measured, in the order of the columns.
    matrix : numpy.ndarray, shape (joints of the description, measured)
        Velocities of all joints, from those that are measured.
    offset : numpy.ndarray, shape (joints of the description,)
        Their positions where those that are measured are 0.
    """

    names: tuple[str, ...]
    matrix: FloatArray
    offset: FloatArray


class Arm:
    """An arm of rigid links.

    Parameters
    ----------
    urdf : Path
    joints : sequence of str
        That are measured and driven; a joint that mimics one of them follows it.
    locked : mapping of str to float, optional
        Joints that rest, and where, rad or m.
    gravity : sequence of float, optional
        In the frame of the base, m/s².

    Attributes
    ----------
    names : tuple of str
        Joints that are measured.
    prior : numpy.ndarray, shape (links · 10,)
        Inertial parameters that the description states.

    Raises
    ------
    InputError
        No pinocchio, no URDF, a joint that it has not, or one that nothing is said of.
    """

    def __init__(
        self,
        urdf: Path,
        joints: Sequence[str],
        *,
        locked: Mapping[str, float] | None = None,
        gravity: Sequence[float] | None = None,
    ) -> None:
        self._pin = _pinocchio()
        self.description = read_urdf(urdf)
        self._model = self._built(urdf)
        if gravity is not None:
            self._model.gravity.linear = np.asarray(gravity, dtype=float)
        self._data = self._model.createData()
        self._joints = list(self._model.names)[1:]
        odd = [j.shortname() for j in list(self._model.joints)[1:] if j.nv != 1]
        if odd:
            raise InputError(
                f"{urdf}: has a joint of more than one degree of freedom ({odd[0]}); an arm has "
                "revolute, continuous and prismatic joints"
            )
        self.drives = self._driven(urdf, joints, dict(locked or {}))
        self.names = self.drives.names
        inertias = list(self._model.inertias)[1:]
        self.prior = np.concatenate([i.toDynamicParameters() for i in inertias])

    def __reduce__(self) -> str | tuple[Any, ...]:
        raise TypeError("an Arm holds a model of pinocchio; make another from its description")

    @property
    def links(self) -> int:
        """Links that move."""
        return len(self._joints)

    @property
    def carries(self) -> int:
        """The link that the last measured joint moves, from 0: a payload hangs there."""
        return self._joints.index(self.names[-1])

    def efforts(
        self,
        position: FloatArray,
        velocity: FloatArray,
        acceleration: FloatArray,
        parameters: FloatArray | None = None,
    ) -> FloatArray:
        """Efforts that move the links, friction and rotors apart.

        Parameters
        ----------
        position, velocity, acceleration : numpy.ndarray, shape (n, joints)
            Of the joints that are measured, SI.
        parameters : numpy.ndarray, shape (links · 10,), optional
            Inertial parameters in place of those of the description.

        Returns
        -------
        numpy.ndarray, shape (n, joints)
            N·m or N.
        """
        pin, model, data = self._pin, self._model, self._data
        if parameters is not None:
            model = model.copy()
            for k in range(self.links):
                own = np.ascontiguousarray(parameters[PER_LINK * k : PER_LINK * (k + 1)])
                model.inertias[k + 1] = pin.Inertia.FromDynamicParameters(own)
            data = model.createData()
        found = np.empty((len(position), self.links))
        for k, (q, v, a) in enumerate(self._whole(position, velocity, acceleration)):
            found[k] = pin.rnea(model, data, q, v, a)
        return found @ self.drives.matrix

    def regressor(
        self, position: FloatArray, velocity: FloatArray, acceleration: FloatArray
    ) -> FloatArray:
        """What a unit of each inertial parameter adds to each effort.

        Parameters
        ----------
        position, velocity, acceleration : numpy.ndarray, shape (n, joints)

        Returns
        -------
        numpy.ndarray, shape (joints, n, links · 10)
        """
        pin, model, data = self._pin, self._model, self._data
        mixed = self.drives.matrix.T
        plain = bool(np.array_equal(mixed, np.eye(self.links)))
        found = np.empty((len(self.names), len(position), PER_LINK * self.links))
        for k, (q, v, a) in enumerate(self._whole(position, velocity, acceleration)):
            own = pin.computeJointTorqueRegressor(model, data, q, v, a)
            found[:, k] = own if plain else mixed @ own
        return found

    def _whole(
        self, position: FloatArray, velocity: FloatArray, acceleration: FloatArray
    ) -> zip[tuple[FloatArray, FloatArray, FloatArray]]:
        """Configuration, velocity and acceleration of every joint, row by row."""
        matrix = self.drives.matrix.T
        angles = position @ matrix + self.drives.offset
        turning = [j.nq == 2 for j in list(self._model.joints)[1:]]
        if any(turning):
            # A joint without end is kept as a cosine and a sine.
            columns: list[FloatArray] = []
            for k, turns in enumerate(turning):
                own = angles[:, k]
                columns += [np.cos(own), np.sin(own)] if turns else [own]
            angles = np.stack(columns, axis=1)
        rates, changes = velocity @ matrix, acceleration @ matrix
        return zip(*map(np.ascontiguousarray, (angles, rates, changes)), strict=True)

    def _built(self, urdf: Path) -> Any:
        try:
            return self._pin.buildModelFromUrdf(str(urdf))
        except (ValueError, RuntimeError) as error:
            told = " ".join(str(error).split())
            raise InputError(
                f"{urdf}: pinocchio cannot read it as a URDF ({told}); correct the file"
            ) from None

    def _driven(self, urdf: Path, joints: Sequence[str], locked: dict[str, float]) -> Drives:
        for name in (*joints, *locked):
            if name not in self._joints:
                raise InputError(
                    f"{urdf}: has no joint '{name}' that moves"
                    f"{did_you_mean(name, self._joints)}; it has {commas(self._joints)}"
                )
        matrix = np.zeros((self.links, len(joints)))
        offset = np.zeros(self.links)
        for k, name in enumerate(self._joints):
            source, factor, at = _followed(name, self.description, joints)
            offset[k] = locked.get(name, at)
            if source is not None and name not in locked:
                matrix[k, list(joints).index(source)] = factor
            elif name not in locked:
                raise InputError(
                    f"{urdf}: nothing says how joint '{name}' moves; give it a table under "
                    f"[[robot.joints]], or write [robot] locked = {{ {name} = 0.0 }} where it rests"
                )
        return Drives(tuple(joints), matrix, offset)


def _followed(
    name: str, description: Description, measured: Sequence[str]
) -> tuple[str | None, float, float]:
    """The measured joint that one moves with, by which factor, and from where."""
    factor, offset = 1.0, 0.0
    seen = set()
    while name not in measured:
        mimic = description.mimics.get(name)
        if mimic is None or name in seen:
            return None, 0.0, 0.0
        seen.add(name)
        offset += factor * mimic.offset
        factor *= mimic.multiplier
        name = mimic.joint
    return name, factor, offset if math.isfinite(offset) else 0.0


def _pinocchio() -> Any:
    try:
        import pinocchio
    except ImportError as error:
        raise InputError(
            "efforts of rigid links need pinocchio; install it with pip install 'stiction[robot]'"
        ) from error
    return pinocchio
