"""A plant: drive, body, friction, effects, sensor and controller, as a plant file describes it."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from .._native import FrictionModel
from .._support import given
from .._support.arrays import FloatArray
from .._support.atomic_files import write_text
from .._support.frozen import ByPath, Frozen, freeze, path_of
from .._support.given import number
from .._support.keys import choice
from .._support.keywords import explain_keywords
from .._support.readers import FromFile
from .._support.units import Motion
from .._support.wording import commas
from ..catalogue import effects
from ..errors import InputError
from ..motor import Motor
from ..trajectory import Trajectory
from . import overlap, plant_file, steady
from .drive import check_servo, gain_name, servo_numbers, unscaled_unit
from .parameter import Parameter
from .stated import Effect, Friction, check_parameters

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..export import Export

__all__ = ["Plant"]

_logger = logging.getLogger(__name__)

GRAVITY: Final = 9.80665
"""m/s²."""


@cache
def _by_motor() -> frozenset[str]:
    """Effects by which friction grows with the effort of the motor."""
    return frozenset(record.name for record in effects() if record.by_motor)


@dataclass(frozen=True)
class Plant(metaclass=FromFile):
    """A single-axis machine; every parameter here is an attribute of the same name.

    Parameters
    ----------
    friction : Friction
        Law, parameters and options.
    motion : {"rotary", "linear"}
        Whether positions are rad or m and efforts N·m or N.
    drive : Mapping, optional
        ``input`` (name of the input column), ``gain`` (effort per unit of input; a ``Parameter``
        where it is fitted), ``limit`` (greatest magnitude of the input); ``kind =
        "prescribed_motion"``; or ``kind = "servo"`` with its numbers.
    body : Mapping of str to Parameter, optional
        ``inertia`` (kg·m² or kg), ``gravity_amplitude`` (N·m), ``gravity_zero_rad``, ``weight_n``,
        ``payload_kg``, ``payload_m``.
    effects : tuple of Effect
    sensor : Mapping of str to float, optional
        ``counts_per_rev`` or ``count_m``.
    controller : Mapping, optional
        As in the file; empty where the loop is not described.
    source : str
        Where it was read, for messages.

    Notes
    -----
    ``load``, ``from_dict`` and ``with_values`` check what they make. A plant that is put together
    by hand refuses parts that are of another class, and its ``motor`` what no motor has.
    """

    friction: Friction
    motion: Motion = "rotary"
    drive: Mapping[str, Any] = field(default_factory=dict)
    body: Mapping[str, Parameter] = field(default_factory=dict)
    effects: tuple[Effect, ...] = ()
    sensor: Mapping[str, float] = field(default_factory=dict)
    controller: Mapping[str, Any] = field(default_factory=dict)
    source: str = field(default="plant", compare=False)

    def __post_init__(self) -> None:
        freeze(self, Frozen, "drive", "body", "sensor", "controller")
        choice(self.motion, plant_file.MOTIONS, f"{self.source}: motion")
        given.instance(self.friction, Friction, f"{self.source}: friction", "a Friction")
        check_parameters(self.body, f"{self.source}: [body]")
        where = f"{self.source}: effects"
        object.__setattr__(self, "effects", tuple(given.each_of(self.effects, where, "Effects")))
        for effect in self.effects:
            given.instance(effect, Effect, f"{self.source}: an effect", "an Effect")

    @classmethod
    def load(cls, path: str | Path) -> Plant:
        """Read a plant file.

        Parameters
        ----------
        path : str or Path
            TOML, as ``save`` writes it.

        Returns
        -------
        Plant

        Raises
        ------
        InputError
            No path, missing file, not TOML, unknown or missing keys, wrong types, values out of
            bounds.
        """
        table, source = plant_file.read(given.path(path, "Plant.load"))
        return cls.from_dict(table, source=source)

    @classmethod
    def from_dict(cls, table: Mapping[str, Any], *, source: str = "plant") -> Plant:
        """A plant from the tables of a plant file.

        Parameters
        ----------
        table : Mapping
            As TOML is read, and as ``to_dict`` returns it.
        source : str
            What messages call it.

        Returns
        -------
        Plant

        Raises
        ------
        InputError
            No mapping, unknown or missing keys, wrong types, values out of bounds.

        Notes
        -----
        An effect that law or body state as well acts twice: a warning of the logger
        ``stiction.plant`` names both.
        """
        table = given.mapping(table, source, "the tables of a plant file")
        parts = plant_file.parse(table, source)
        plant = cls(
            friction=Friction(
                parts.law,
                parts.friction,
                parts.options,
            ),
            motion=parts.motion,
            drive=parts.drive,
            body=parts.body,
            effects=tuple(Effect(name, p) for name, p in parts.effects),
            sensor=parts.sensor,
            controller=parts.controller,
            source=source,
        )
        plant._check()
        for double in overlap.doubles(plant):
            _logger.warning("%s", double)
        return plant

    @classmethod
    def from_bam(
        cls, path: str | Path, *, kp: float | None = None, vin: float | None = None
    ) -> Plant:
        """A plant from a file of parameters of `better-actuator-models`.

        Parameters
        ----------
        path : str or Path
            JSON, as `bam.fit` writes it.
        kp, vin : float, optional
            Gain of the firmware in BAM's unit, and supply in V, where the file's do not hold.

        Returns
        -------
        Plant

        Raises
        ------
        InputError
            As for ``stiction.bam.read_bam``, which tells as well what the file leaves open.
        """
        from ..bam import read_bam

        return read_bam(path, kp=kp, vin=vin).plant

    def save(self, path: str | Path) -> Path:
        """Write a plant file.

        Parameters
        ----------
        path : str or Path
            A file that is there is replaced, and so is a link.

        Returns
        -------
        Path
            Of the file.

        Raises
        ------
        InputError
            No path, or a file that cannot be written.
        """
        path = given.path(path, "Plant.save")
        with given.explain_write_errors(path):
            write_text(path, plant_file.render(self.to_dict()))
        return path

    def to_dict(self) -> dict[str, Any]:
        """The tables of a plant file."""

        def plain(parameters: Mapping[str, Parameter]) -> dict[str, Any]:
            return {name: parameter.to_toml() for name, parameter in parameters.items()}

        table: dict[str, Any] = {"motion": {"kind": self.motion}}
        if self.drive:
            table["drive"] = {
                name: {"fixed": False, **_table(value)} if isinstance(value, Parameter) else value
                for name, value in self.drive.items()
                if not (name == "input" and self.servo)
            }
        if self.body:
            table["body"] = plain(self.body)
        table["friction"] = {
            "law": self.friction.law,
            **self.friction.options,
            **plain(self.friction.parameters),
        }
        if self.effects:
            table["effects"] = [{"name": e.name, **plain(e.parameters)} for e in self.effects]
        if self.sensor:
            table["sensor"] = dict(self.sensor)
        if self.controller:
            table["controller"] = dict(self.controller)
        return table

    @property
    def prescribed_motion(self) -> bool:
        """Whether the machine is moved and the effort measured."""
        return self.drive.get("kind") == "prescribed_motion"

    @property
    def servo(self) -> bool:
        """Whether the input is a goal position."""
        return self.drive.get("kind") == "servo"

    @property
    def gain(self) -> float:
        """Effort per unit of input; of a servo per ampere."""
        gain = self.drive.get(gain_name(self.drive), 1.0)
        return gain.value if isinstance(gain, Parameter) else float(gain)

    @property
    def si_effort_unit(self) -> str:
        """What an effort is measured in."""
        return "N·m" if self.motion == "rotary" else "N"

    @property
    def effort_unit(self) -> str:
        """Unit of effort; that of the input where nobody states how much effort it makes."""
        return unscaled_unit(self.drive) or self.si_effort_unit

    @property
    def position_unit(self) -> str:
        """Unit of position."""
        return "rad" if self.motion == "rotary" else "m"

    @property
    def count(self) -> float:
        """Size of a sensor count, 0 where none is stated."""
        if "counts_per_rev" in self.sensor:
            return float(2 * np.pi / self.sensor["counts_per_rev"])
        return float(self.sensor.get("count_m", 0.0))

    @property
    def inertia(self) -> float:
        """Inertia (mass), payload included.

        Raises
        ------
        InputError
            The file states none.
        """
        if "inertia" in self.body:
            return self.body["inertia"].value + self.payload[0]
        if self.prescribed_motion:
            return 0.0
        raise InputError(
            f"{self.source}: [body] inertia is missing; state it (kg·m² or kg), or [drive] kind = "
            "'prescribed_motion' for its friction alone"
        )

    @property
    def payload(self) -> tuple[float, float]:
        """What the payload adds to inertia (mass) and to the amplitude of the pendulum torque."""
        mass, lever = self._payload
        own = 0.0 if self.motion == "linear" else mass * lever * GRAVITY
        return mass * lever * lever, own

    @property
    def _payload(self) -> tuple[float, float]:
        """Mass that hangs on the machine, kg, and how far from its axis, m (1 for a linear one)."""
        mass, lever = (self.body.get(name) for name in ("payload_kg", "payload_m"))
        if mass is None or (lever is None and self.motion == "rotary"):
            return 0.0, 0.0
        return mass.value, 1.0 if lever is None else lever.value

    @property
    def gravity(self) -> float:
        """Amplitude of the pendulum torque, payload included, N·m."""
        own = self.body["gravity_amplitude"].value if "gravity_amplitude" in self.body else 0.0
        return own + self.payload[1]

    @property
    def weight(self) -> float:
        """Force against positive motion, payload included, N; 0 where no weight is stated."""
        # A payload alone says nothing of the slope: an axis that states no weight moves level.
        if "weight_n" not in self.body:
            return 0.0
        carried = self._payload[0] * GRAVITY if self.motion == "linear" else 0.0
        return self.body["weight_n"].value + carried

    @property
    def hangs(self) -> bool:
        """Whether it carries a load that need not be recorded."""
        return self.gravity != 0.0 or "gravity_amplitude" in self.body or "weight_n" in self.body

    def under(self, settings: Mapping[str, float]) -> Plant:
        """The plant with what was set for one recording.

        Parameters
        ----------
        settings : mapping of str to float
            ``Recording.settings``; SI.

        Returns
        -------
        Plant
            This one where nothing was set.

        Raises
        ------
        InputError
            Settings of a servo for a plant without one, or that leave it nothing to move with; a
            rotary payload of which nobody states how far from the axis it hangs.
        """
        settings = given.mapping(settings, f"{self.source}: settings", "numbers by name")
        if not settings:
            return self
        payload = {
            name: Parameter(number(value, f"{self.source}: [body] {name}"), fixed=True)
            for name, value in settings.items()
            if name.startswith("payload")
        }
        servo = {
            name: number(value, f"{self.source}: [drive] {name}")
            for name, value in settings.items()
            if name not in payload
        }
        if servo and not self.servo:
            raise InputError(
                f"{self.source}: {commas(servo)} is set for a recording, and only a servo has it; "
                "write [drive] kind = 'servo', or leave it out"
            )
        changed = replace(self, drive={**self.drive, **servo}, body={**self.body, **payload})
        if servo:
            check_servo(changed.drive, f"{self.source}: [drive] as set for a recording:")
        plant_file.check_payload(changed.body, self.motion, f"{self.source}: [body]")
        return changed

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Every stated parameter by its path, such as ``friction.coulomb``."""
        paths = {f"drive.{n}": p for n, p in self.drive.items() if isinstance(p, Parameter)}
        paths |= {f"body.{name}": p for name, p in self.body.items()}
        paths |= {f"friction.{name}": p for name, p in self.friction.parameters.items()}
        for effect in self.effects:
            paths |= {f"effects.{effect.name}.{n}": p for n, p in effect.parameters.items()}
        return ByPath(paths)

    def following(self, paths: Sequence[str]) -> list[tuple[str, int, float]]:
        """What moves along with parameters of these paths because the plant leaves it open.

        Parameters
        ----------
        paths : sequence of str
            Whole ones, such as ``friction.coulomb``.

        Returns
        -------
        list of (str, int, float)
            Path of what follows, place of the path that it follows, and the factor between them.

        Raises
        ------
        InputError
            Something else than paths.
        """
        paths = given.names(paths, f"{self.source}: paths")
        stated = self.friction.parameters
        found = []
        for record in self.friction.record.parameters:
            if record.follows is None or record.name in stated or record.follows[0] not in stated:
                continue
            other, factor = record.follows
            if f"friction.{other}" in paths and np.isfinite(factor * stated[other].value):
                place = list(paths).index(f"friction.{other}")
                found.append((f"friction.{record.name}", place, factor))
        return found

    def with_values(self, values: Mapping[str, float]) -> Plant:
        """A copy with other values of parameters that the plant states.

        Parameters
        ----------
        values : mapping of str to float
            SI values by path (or bare last word, where unique).

        Returns
        -------
        Plant

        Raises
        ------
        InputError
            A value that is not a number or out of its bounds.
        UnknownName
            An ``InputError`` and a ``KeyError``: the plant states no such parameter, or several.
        """
        stated = self.parameters
        changed = dict(stated)
        wanted = given.mapping(values, "Plant.with_values: values", "numbers by path")
        for name, value in wanted.items():
            path = path_of(name, stated, f"{self.source}: ", "is not stated")
            changed[path] = replace(stated[path], value=number(value, f"{self.source}: {path}"))

        def part(prefix: str) -> Mapping[str, Parameter]:
            return {p.removeprefix(prefix): v for p, v in changed.items() if p.startswith(prefix)}

        plant = replace(
            self,
            drive={**self.drive, **part("drive.")},
            body=part("body."),
            friction=replace(self.friction, parameters=part("friction.")),
            effects=tuple(replace(e, parameters=part(f"effects.{e.name}.")) for e in self.effects),
        )
        plant._check()
        return plant

    def motor(self, *, integrator: str = "fast") -> Motor:
        """The plant as a motor at rest.

        Parameters
        ----------
        integrator : {"fast", "reference"}
            As for ``Motor``.

        Returns
        -------
        Motor

        Raises
        ------
        InputError
            No inertia is stated, a value that no motor has, an unknown integrator.
        """
        inertia = self.inertia
        if inertia == 0.0:
            raise InputError(
                f"{self.source}: [body] inertia = 0 cannot be simulated as a motor; state one"
            )
        return self._motor(inertia, integrator)

    @property
    def friction_by_motor(self) -> bool:
        """Whether an effect lets friction grow with the effort of the motor."""
        return any(effect.name in _by_motor() for effect in self.effects)

    @property
    def shifts_mass(self) -> bool:
        """Whether an effect puts the centre of mass elsewhere than where the sensor reads it."""
        shifting = {record.name for record in effects() if record.shifts_mass}
        return any(effect.name in shifting for effect in self.effects)

    def follower(self, *, count: float | None = None) -> Motor:
        """The plant as a motor that is only moved along given positions (``Motor.follow``).

        Parameters
        ----------
        count : float, optional
            Size of a sensor count that the positions show, rad or m; that of the plant without it.

        Raises
        ------
        InputError
            As for ``motor``, but that a plant of prescribed motion needs no inertia; a count
            below 0.
        """
        return self._motor(self.inertia or 1.0, "fast", count)

    def friction_model(self, *, strict: bool = False) -> FrictionModel:
        """The friction of the plant, with the effects that act at the contact, never moved.

        What a diagnosis has found of the contact is in it: it steps at held velocities, gives
        friction and slope to implicit hosts, and goes into a ``Motor``. ``friction`` is the law
        as the plant states it, without any effect.

        Parameters
        ----------
        strict : bool
            Whether effects that no friction model can have (of drive and sensor, second masses)
            are refused. Otherwise they are left out, and a warning of the logger
            ``stiction.motor`` names them.

        Returns
        -------
        FrictionModel
            Its ``effects`` say what it has.

        Raises
        ------
        InputError
            As for ``follower``; with ``strict``: the plant has effects that no friction model can
            have.
        """
        return self.follower().friction_model(strict=strict)

    def _motor(self, inertia: float, integrator: str, count: float | None = None) -> Motor:
        shown = {} if count is None else {"count": count}
        return Motor(inertia, integrator=integrator, **(self._settings | shown))

    @cached_property
    def _settings(self) -> dict[str, Any]:
        """What a motor of this plant is made with: a fit makes one for every recording."""
        zero = self.body.get("gravity_zero_rad")
        return {
            "torque_constant": self.gain,
            "friction": self.friction.model(),
            "effects": {
                e.name: {n: p.value for n, p in e.parameters.items()} for e in self.effects
            },
            "gravity_amplitude": self.gravity,
            "gravity_zero": 0.0 if zero is None else zero.value,
            "weight": self.weight,
            "input_limit": float(self.drive.get("limit", np.inf)),
            "servo": servo_numbers(self.drive),
            "count": self.count,
        }

    @explain_keywords
    def simulate(
        self,
        input: npt.ArrayLike,
        dt: npt.ArrayLike,
        *,
        load: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
        enabled: npt.ArrayLike | None = None,
        outputs: list[str] | None = None,
        position: float = 0.0,
        velocity: float = 0.0,
    ) -> Trajectory:
        """Simulate samples of held input from rest, or from this position and velocity.

        Parameters
        ----------
        input : array_like, shape (n,)
            Held over each sample: A, V, N·m or N, of a servo its goal, rad or m.
        dt, load, temperature, enabled, outputs
            As for ``Motor.simulate``.
        position, velocity : float
            Before the first sample; rad and rad/s, or m and m/s.

        Returns
        -------
        Trajectory

        Raises
        ------
        InputError
            As for ``motor``, ``Motor.reset`` and ``Motor.simulate``; a plant of prescribed motion.
        """
        if self.prescribed_motion:
            raise InputError(
                f"{self.source}: [drive] kind = 'prescribed_motion' has no input to simulate; "
                "state [body] inertia and, in its place, [drive] input = 'torque_nm', or use "
                "Motor.follow"
            )
        motor = self.motor()
        motor.reset(position, velocity)
        run = motor.simulate(
            input, dt, load=load, temperature=temperature, enabled=enabled, outputs=outputs
        )
        return run.of_motion(self.motion)

    def friction_curve(self, speeds: npt.ArrayLike) -> FloatArray:
        """Effort that friction takes in steady motion, with the effects that go with the speed.

        Parameters
        ----------
        speeds : array_like
            rad/s or m/s, of either sign.

        Returns
        -------
        numpy.ndarray, of the same shape
            N·m or N, positive where it resists motion along +x; 0 at rest. Of a contact that has
            slid far enough for its friction to be steady, as it is when the machine was just
            switched on and nothing is known of its temperature.

        Raises
        ------
        InputError
            Speeds that are no finite numbers.
        """
        return steady.friction_curve(self, speeds)

    def curve_speeds(self) -> FloatArray:
        """Speeds at which a curve of friction is drawn, both ways, close about rest.

        Returns
        -------
        numpy.ndarray, shape (240,)
            Up to 10 rad/s or 0.2 m/s.
        """
        most = 10.0 if self.motion == "rotary" else 0.2
        one_way = np.geomspace(1e-4 * most, most, 120)
        return np.concatenate([-one_way[::-1], one_way])

    def plot_friction(
        self, ax: Axes | None = None, *, label: str = "", kind: str = "speed"
    ) -> Axes:
        """Friction of the plant as a curve, with the effects at its contact.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            To draw into, one of a new figure without it: several plants into one compare laws.
        label : str
            In the legend, law and effects without it.
        kind : {"speed", "hysteresis", "breakaway"}
            Steady friction over speed; friction over displacement through a loop and a minor loop
            of a few pre-sliding distances; greatest friction over the rate at which a soft spring
            loads the contact.

        Returns
        -------
        matplotlib Axes

        Raises
        ------
        InputError
            ``ax`` is something else than axes; another kind.
        """
        from ..friction_plot import draw

        return draw(self, ax, kind, label)

    def position_effort(self, positions: npt.ArrayLike) -> FloatArray:
        """Effort that the machine needs beside friction to stand at some places.

        Parameters
        ----------
        positions : array_like
            rad or m.

        Returns
        -------
        numpy.ndarray, of the same shape
            N·m or N: what bears gravity and added efforts (cogging, an offset).

        Raises
        ------
        InputError
            Positions that are no finite numbers.
        """
        return steady.position_effort(self, positions)

    @explain_keywords
    def export(self, to: str, *, speed: float | None = None) -> Export:
        """The plant as another tool takes it.

        Parameters
        ----------
        to : str
            Name of a target: `stiction export --list`.
        speed : float, optional
            Greatest speed at which friction matters, rad/s or m/s; 10 rad/s or 0.2 m/s without it,
            and three times the speed over which the friction of the plant is stated to fall where
            that is more.

        Returns
        -------
        Export
            Files to ``save``, and what the target cannot hold.

        Raises
        ------
        InputError
            No such target, a speed that is not above 0, a plant that lacks what the target needs.
        """
        from ..export.registry import export

        return export(self, to, speed=speed)

    def _check(self) -> None:
        """Refuse what the catalogue refuses, naming the file."""
        try:
            self._motor(1.0, "fast")
        except InputError as error:
            raise InputError(f"{self.source}: {error}") from None

    def __repr__(self) -> str:
        effects = f" + {', '.join(e.name for e in self.effects)}" if self.effects else ""
        return f"Plant({self.motion}, {self.friction.law}{effects}, from {self.source})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{path}</td><td>{p.value:.6g}</td></tr>" for path, p in self.parameters.items()
        )
        return f"<p>{self!r}</p><table><tr><th>parameter</th><th>value</th></tr>{rows}</table>"


def _table(parameter: Parameter) -> dict[str, float | bool]:
    """A parameter as a table, whatever it holds."""
    given = parameter.to_toml()
    return given if isinstance(given, dict) else {"value": given}
