"""Robots whose truth is known: links by MuJoCo's inverse dynamics, friction by code of its own.

Nothing here comes from the core, nor from pinocchio. A joint's friction may hide one effect.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

EFFECTS = (
    "load_dependent_friction",
    "stribeck",
    "viscous_quadratic",
    "position_dependent_friction",
)
RATE = 200.0
FINER = 8
"""Steps of the simulator to one row of the recording."""


@dataclass(frozen=True)
class Friction:
    """Friction of a joint, N·m."""

    coulomb: float
    viscous: float
    bias: float
    effect: str = ""
    size: float = 0.0

    def acts(self, position: Array, velocity: Array, links: Array) -> Array:
        way = np.tanh(velocity / 1e-4)
        level = np.full_like(position, self.coulomb)
        plus = np.zeros_like(position)
        if self.effect == "load_dependent_friction":
            level += self.size * np.abs(links)
        elif self.effect == "stribeck":
            level += self.size * self.coulomb * np.exp(-np.abs(velocity / 0.1))
        elif self.effect == "viscous_quadratic":
            plus = self.size * self.viscous * velocity * np.abs(velocity)
        elif self.effect == "position_dependent_friction":
            level *= 1.0 + self.size * np.cos(3.0 * position + 0.4)
        return level * way + self.viscous * velocity + plus + self.bias


@dataclass(frozen=True)
class SimulatedRobot:
    """An arm that turns at its base and nods at shoulder and elbow."""

    masses: tuple[float, float, float] = (6.0, 4.0, 2.0)
    lengths: tuple[float, float] = (0.4, 0.3)
    rotors: tuple[float, ...] = (0.4, 0.4, 0.2)
    friction: tuple[Friction, ...] = (
        Friction(6.0, 8.0, 0.1),
        Friction(5.0, 7.0, -0.2),
        Friction(3.0, 3.0, 0.05),
    )
    counts: int = 1_000_000
    noise: float = 0.02
    """Of the torque, as a share of its rms."""
    joints: tuple[str, ...] = field(default=("base", "shoulder", "elbow"))

    @property
    def urdf(self) -> str:
        m, (upper, fore) = self.masses, self.lengths
        links = [
            _link("column", m[0], (0.02, 0.01, 0.1), (0.05, 0.06, 0.04)),
            _link("upper", m[1], (0.5 * upper, 0.02, -0.01), (0.02, 0.08, 0.08)),
            _link("fore", m[2], (0.4 * fore, -0.01, 0.02), (0.01, 0.03, 0.03)),
        ]
        joints = [
            _joint("base", "ground", "column", "0 0 0.2", "0 0 1"),
            _joint("shoulder", "column", "upper", "0.05 0 0.3", "0 1 0"),
            _joint("elbow", "upper", "fore", f"{upper} 0 0", "0 1 0"),
        ]
        return (
            '<?xml version="1.0"?>\n<robot name="arm">\n<link name="ground"/>\n'
            + "\n".join([*links, *joints])
            + "\n</robot>\n"
        )

    def record(self, seed: int, seconds: float) -> Mapping[str, Array]:
        """A recording: t, and q, tau of each joint."""
        rng = np.random.default_rng(seed)
        count = int(seconds * RATE)
        rows = np.arange(count) / RATE
        # Midpoints of fine steps: their mean over a row lies in its middle.
        fine = (np.arange(count * FINER) + 0.5) / (RATE * FINER)
        sines = [_drawn_sines(rng) for _ in self.joints]
        motion = [_multisine(own, fine) for own in sines]
        q, v, a = (np.stack([one[k] for one in motion], axis=1) for k in range(3))
        links = self.links(q, v, a)
        table = {"t": rows}
        for k, friction in enumerate(self.friction):
            torque = links[:, k] + self.rotors[k] * a[:, k]
            torque = torque + friction.acts(q[:, k], v[:, k], links[:, k])
            # What is held from a row to the next is the mean of what acts in between.
            held = torque.reshape(count, FINER).mean(axis=1)
            held += self.noise * np.sqrt(np.mean(held**2)) * rng.standard_normal(count)
            step = 2.0 * np.pi / self.counts
            table[f"q{k + 1}"] = np.round(_multisine(sines[k], rows)[0] / step) * step
            table[f"tau{k + 1}"] = held
        return table

    def links(self, q: Array, v: Array, a: Array) -> Array:
        """Efforts of the rigid links, by MuJoCo."""
        import mujoco

        model = mujoco.MjModel.from_xml_string(self.urdf)
        data = mujoco.MjData(model)
        found = np.empty_like(q)
        for k in range(len(q)):
            data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
            mujoco.mj_inverse(model, data)
            found[k] = data.qfrc_inverse
        return found

    def lay_out(
        self,
        folder: Path,
        seconds: float = 24.0,
        seed: int = 0,
        record: Callable[[int, float], Mapping[str, Array]] | None = None,
    ) -> Path:
        """Files as a user has them; the URDF says other inertias than are true.

        ``record`` makes a recording from seed and seconds, ``self.record`` without it.
        """
        record = record or self.record
        folder.mkdir(parents=True, exist_ok=True)
        rough = SimulatedRobot(tuple(1.2 * m for m in self.masses), self.lengths)  # type: ignore[arg-type]
        (folder / "arm.urdf").write_text(rough.urdf)
        lines = ["[robot]", 'urdf = "arm.urdf"']
        for k, name in enumerate(self.joints, 1):
            lines += ["[[robot.joints]]", f'name = "{name}"', "[robot.joints.columns]"]
            lines += [f'position = {{ name = "q{k}", unit = "rad" }}', f'input = "tau{k}"']
            lines += ["[robot.joints.drive]", 'input = "torque_nm"']
        (folder / "robot.toml").write_text("\n".join(lines) + "\n")
        session = ['plant = "robot.toml"', "[columns]", 'time = "t"']
        for k, role in enumerate(("train", "train", "select", "test")):
            table = record(10 * seed + k, seconds)
            np.savez(folder / f"run{k}.npz", **table)
            session += ["[[recordings]]", f'file = "run{k}.npz"', f"role = {json.dumps(role)}"]
        (folder / "session.toml").write_text("\n".join(session) + "\n")
        return folder / "session.toml"


def drawn(seed: int) -> tuple[SimulatedRobot, str, str]:
    """A robot, the joint that hides something, and what; "" where none does."""
    rng = np.random.default_rng([7, seed])
    names = SimulatedRobot().joints
    sizes = {
        "load_dependent_friction": 0.25,
        "stribeck": 0.6,
        "viscous_quadratic": 0.5,
        "position_dependent_friction": 0.3,
    }
    effect = ("", *EFFECTS)[seed % 5]
    hides = int(rng.integers(1 if effect == "load_dependent_friction" else 0, 3))
    frictions = []
    for k, plain in enumerate(SimulatedRobot().friction):
        own = effect if k == hides else ""
        scale = rng.uniform(0.6, 1.6)
        frictions.append(
            Friction(
                plain.coulomb * scale,
                plain.viscous * scale,
                plain.bias,
                own,
                sizes.get(own, 0.0) * rng.uniform(0.8, 1.4),
            )
        )
    masses = tuple(float(m * rng.uniform(0.7, 1.4)) for m in SimulatedRobot().masses)
    robot = SimulatedRobot(masses=masses, friction=tuple(frictions))  # type: ignore[arg-type]
    return robot, names[hides] if effect else "", effect


Sines = list[tuple[float, float, float]]


def _drawn_sines(rng: np.random.Generator) -> Sines:
    """Angular frequency, amplitude and phase of each."""
    return [
        (
            2.0 * np.pi * frequency,
            rng.uniform(0.5, 1.0) * 0.5 / (0.5 + 2.0 * frequency),
            rng.uniform(0, 6.28),
        )
        for frequency in rng.uniform(0.08, 0.6, 5)
    ]


def _multisine(sines: Sines, time: Array) -> tuple[Array, Array, Array]:
    """Position, velocity and acceleration of a few sines that begin at rest."""
    ease = 1.0 - np.exp(-((time / 0.5) ** 2))
    d_ease = 2.0 * time / 0.25 * np.exp(-((time / 0.5) ** 2))
    dd_ease = (2.0 / 0.25 - (2.0 * time / 0.25) ** 2) * np.exp(-((time / 0.5) ** 2))
    x, v, a = np.zeros_like(time), np.zeros_like(time), np.zeros_like(time)
    for w, size, phase in sines:
        x += size * np.sin(w * time + phase)
        v += size * w * np.cos(w * time + phase)
        a -= size * w * w * np.sin(w * time + phase)
    return ease * x, ease * v + d_ease * x, ease * a + 2.0 * d_ease * v + dd_ease * x


def _link(name: str, mass: float, at: tuple[float, ...], inertia: tuple[float, ...]) -> str:
    x, y, z = at
    xx, yy, zz = (mass / 4.0 * i for i in inertia)
    return (
        f'<link name="{name}"><inertial><origin xyz="{x} {y} {z}" rpy="0 0 0"/>'
        f'<mass value="{mass}"/><inertia ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/>'
        "</inertial></link>"
    )


def _joint(name: str, parent: str, child: str, at: str, axis: str) -> str:
    return (
        f'<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{at}" rpy="0 0 0"/><axis xyz="{axis}"/></joint>'
    )
