"""Numbers of a plant as the models of `better-actuator-models` (BAM) hold them."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError
from ..plant import steady
from ..plant.joint import WORTH_SAYING, beside, speeds_up_to
from .format import ACTUATORS, GOAL, LOAD

if TYPE_CHECKING:
    from ..plant import Plant
    from ..plant.stated import Effect

__all__ = ["BamNumbers", "numbers_of"]

EXACT: Final = ("coulomb", "load_dependent")
"""Laws whose numbers are those of BAM."""
NO_BACK_EMF: Final = 1e-9
"""kt, N·m/A, of a drive whose own voltage is in viscous friction already."""
NO_LIMIT: Final = 1e-9
"""R, Ω, of a drive that no supply limits."""
FALLS: Final = np.geomspace(2e-3, 2.0, 40)
"""Speeds of a fall that are tried, as shares of the greatest speed..."""
SHAPES: Final = (0.5, 1.0, 1.5, 2.0, 3.0, 5.0)
"""... and its exponents."""


@dataclass(frozen=True)
class BamNumbers:
    """A file of parameters, as plain data.

    Attributes
    ----------
    model, actuator : str
    numbers : dict of str to float
        All that the file holds, by name.
    input : str
        Of a drive without a loop, "" of a servo.
    held, lost : tuple of str
        What of the plant the file holds, and what it cannot hold.
    """

    model: str
    actuator: str
    numbers: dict[str, float]
    input: str
    held: tuple[str, ...]
    lost: tuple[str, ...]

    @property
    def table(self) -> dict[str, float | str]:
        """What the file holds; BAM passes over the input and what its logs say otherwise."""
        beside = {"input": self.input} if self.input else {}
        return {"model": self.model, "actuator": self.actuator, **self.numbers, **beside}


def numbers_of(plant: Plant, speed: float) -> BamNumbers:
    """The model, and the actuator, that hold most of a plant.

    Parameters
    ----------
    plant : Plant
    speed : float
        Greatest speed at which friction matters, rad/s: where the law is none of BAM's, its curve
        up to there is fitted.

    Raises
    ------
    InputError
        A linear plant; one without a stated inertia.
    """
    if plant.motion == "linear":
        raise InputError(
            f"{plant.source}: is linear, and actuators of better-actuator-models turn; export it "
            "to another target"
        )
    friction, drive = _Friction(plant, speed), _drive(plant)
    body = _body(plant)
    held = [f"friction as {friction.model.upper()}", "inertia as armature", *drive.held]

    def kept(effect: Effect) -> bool:
        return effect.name in (*friction.effects, *drive.effects)

    lost = (*friction.lost, *beside(plant, kept, limited=False), *drive.lost)
    if plant.gravity and "mass" not in body:
        lost += (f"gravity of {plant.gravity:.4g} N·m: of a pendulum BAM knows mass and length",)
    elif "gravity_amplitude" in plant.body and plant.body["gravity_amplitude"].value:
        lost += ("gravity_amplitude beside the payload, which alone has mass and length",)
    if plant.sensor:
        lost += ("the sensor: BAM's servos read without counts",)
    if plant.controller:
        lost += ("the controller: that of an actuator is in BAM's code",)
    return BamNumbers(
        friction.model,
        drive.actuator,
        {**drive.numbers, **body, **friction.numbers},
        drive.input,
        tuple(held),
        lost,
    )


# --- drive and body


@dataclass(frozen=True)
class _Drive:
    actuator: str
    numbers: dict[str, float]
    input: str
    held: tuple[str, ...]
    lost: tuple[str, ...]
    effects: tuple[str, ...] = ()


def _drive(plant: Plant) -> _Drive:
    if plant.servo:
        return _servo(plant)
    gain, lost = plant.gain, []
    if gain < 0.0:
        lost.append("the sign of the drive: turn the sign of what is given to it")
        gain = -gain
    if plant.prescribed_motion:
        numbers = {"kt": 1.0, "R": NO_LIMIT}
        return _Drive("erob80_50", numbers, "torque_nm", (), (*lost, "what moves it: nothing does"))
    kind = plant.drive.get("input", "torque_nm")
    if kind == "voltage_v":
        numbers = {"kt": NO_BACK_EMF, "R": NO_BACK_EMF / gain}
        held = "the gain of the drive, as kt/R; its own voltage is in friction_viscous"
        return _Drive("xl330", numbers, kind, (held,), tuple(lost))
    held = "the gain of the drive, as kt"
    return _Drive("erob80_50", {"kt": gain, "R": NO_LIMIT}, kind, (held,), tuple(lost))


def _servo(plant: Plant) -> _Drive:
    drive, lost, held = plant.drive, [], []
    limit = float(drive.get("duty_limit", 1.0))
    most = float(drive.get("current_limit_a", math.inf))
    goal = next((each for each in plant.effects if each.name == GOAL), None)
    slowness = goal.parameters.get("slowness") if goal is not None else None
    slow = slowness is not None and slowness.value > 0.0
    name = "sts3215" if slow else _nearest(limit, most, float(drive["supply_v"]))
    known = ACTUATORS[name]
    numbers = {"kt": plant.gain, "R": float(drive["resistance_ohm"])}
    if slow:
        assert slowness is not None
        numbers |= {"error_gain_ratio": 1.0, "max_velocity": 1.0 / slowness.value}
    numbers["kp"] = float(drive["proportional"]) / known.error_gain
    numbers["vin"] = float(drive["supply_v"])
    nearest = "" if slow else ", the nearest in limits and supply: a plant does not say which it is"
    held.append(f"the loop of the servo, as kp and vin of BAM's {name}{nearest}")
    if not math.isclose(limit, known.duty_limit, rel_tol=1e-12):
        lost.append(
            f"duty_limit = {limit:g}: that of BAM's {name} is {known.duty_limit:g}, in its code"
        )
    if most != known.current_limit:
        theirs = f"{known.current_limit:g} A" if math.isfinite(known.current_limit) else "none"
        lost.append(f"current_limit_a = {most:g}: that of BAM's {name} is {theirs}, in its code")
    lost += [
        f"{key} = {float(drive[key]):g} of the servo: BAM's {name} has none"
        for key in ("integral", "derivative")
        if drive.get(key)
    ]
    return _Drive(name, numbers, "", tuple(held), tuple(lost), (GOAL,) if slow else ())


def _nearest(limit: float, most: float, supply: float) -> str:
    """The servo of BAM, of those whose goals are not held back, with these limits and supply."""
    names = [n for n, a in ACTUATORS.items() if a.kind == "voltage" and "max_velocity" not in a.own]

    def off(name: str) -> tuple[float, bool, float]:
        known = ACTUATORS[name]
        return (
            abs(known.duty_limit - limit),
            known.current_limit != most,
            abs(known.supply - supply),
        )

    return min(names, key=off)


def _body(plant: Plant) -> dict[str, float]:
    inertia = plant.body.get("inertia")
    if inertia is None and not plant.prescribed_motion:
        # It says what to state.
        assert plant.inertia
    zero = plant.body.get("gravity_zero_rad")
    body = {
        "armature": 0.0 if inertia is None else inertia.value,
        "q_offset": 0.0 if zero is None or zero.value == 0.0 else -zero.value,
    }
    payload = [plant.body.get(name) for name in ("payload_kg", "payload_m")]
    if all(each is not None for each in payload):
        body |= {
            name: each.value
            for name, each in zip(("mass", "length"), payload, strict=True)
            if each is not None
        }
    return body


# --- friction


class _Friction:
    """The model and its numbers; effects that are in them, and what is not."""

    def __init__(self, plant: Plant, speed: float) -> None:
        self._plant, self._speed = plant, speed
        stated = plant.friction.model().parameters
        in_curve = [each for each in plant.effects if steady.in_curve(plant, each)]
        bent = [each for each in in_curve if each.name != LOAD]
        self.lost: list[str] = []
        if plant.friction.law in EXACT and not bent:
            fall = _Fall(
                stated["coulomb"],
                stated["breakaway"] - stated["coulomb"],
                stated["stribeck_velocity"],
                stated["stribeck_exponent"],
                stated["viscous"],
            )
            changed: list[Effect] = []
        else:
            fall, changed = self._fitted(bent), bent
        load = _Load.of(stated) if plant.friction.law == "load_dependent" else _Load()
        self.effects = [each.name for each in changed]
        load = self._with_effect(load, fall)
        falls = fall.excess > 0.0 or load.falls
        self.model = load.model(falls=falls)
        self.numbers = {"friction_base": fall.base, **load.numbers(self.model)}
        if falls or self.model in ("m5", "m6"):
            self.numbers |= {
                "friction_stribeck": fall.excess,
                "dtheta_stribeck": fall.speed,
                "alpha": fall.exponent,
            }
        self.numbers["friction_viscous"] = fall.viscous

    def _with_effect(self, load: _Load, fall: _Fall) -> _Load:
        """Load with what an effect adds to it."""
        effect = next((each for each in self._plant.effects if each.name == LOAD), None)
        if effect is None:
            return load
        drive, back = (
            0.0 if (found := effect.parameters.get(name)) is None else found.value
            for name in ("drive", "back_drive")
        )
        mean, apart = 0.5 * (drive + back), 0.5 * abs(drive - back)
        if load != _Load() or mean <= 0.0:
            return load
        self.effects.append(LOAD)
        if apart > WORTH_SAYING * mean:
            self.lost.append(
                f"{LOAD}: {drive:.4g} of the load while the machine drives it and {back:.4g} while "
                f"it drives the machine; {mean:.4g} is held for both"
            )
        # The effect multiplies a level, and so what falls with speed as well.
        steep = mean * fall.excess / fall.base if fall.base > 0.0 else 0.0
        return _Load(external=mean, external_steep=steep)

    def _fitted(self, bent: list[Effect]) -> _Fall:
        """The curve of both directions alike, as a fall that is nearest to it."""
        speed, unit = self._speed, self._plant.effort_unit
        both = speeds_up_to(speed)
        even = np.linspace(speed / 100.0, speed, 100)
        speeds = np.unique(np.concatenate([both[both > 0.0][::4], even]))
        forth = steady.friction_curve(self._plant, speeds)
        back = -steady.friction_curve(self._plant, -speeds)
        mean = 0.5 * (forth + back)
        fall = _fall_of(speeds, mean, speed)
        worth = WORTH_SAYING * max(fall.base + fall.excess, 1e-300)
        off = np.abs(mean - fall.at(speeds))
        if (most := float(np.max(off))) > worth:
            lost = f"the curve of friction over speed is off by {most:.3g} {unit} at most, at "
            self.lost.append(f"{lost}{speeds[int(np.argmax(off))]:.3g} rad/s")
        if (apart := float(np.max(np.abs(forth - back)))) > worth:
            self.lost.append(f"friction of the two directions differs by {apart:.3g} {unit}")
        self._untold(bent, speeds, mean)
        return fall

    def _untold(self, bent: list[Effect], speeds: FloatArray, mean: FloatArray) -> None:
        """Takes effects out that leave the mean of both directions as it is."""
        for effect in tuple(bent):
            others = tuple(each for each in self._plant.effects if each.name != effect.name)
            plant = replace(self._plant, effects=others)
            curve = [sign * steady.friction_curve(plant, sign * speeds) for sign in (1.0, -1.0)]
            if np.max(np.abs(0.5 * (curve[0] + curve[1]) - mean)) <= steady.SEEN * np.max(mean):
                bent.remove(effect)


@dataclass(frozen=True)
class _Fall:
    """Friction of one direction: base + excess·e^(−|v/speed|^exponent) + viscous·v."""

    base: float
    excess: float
    speed: float
    exponent: float
    viscous: float

    def at(self, speeds: FloatArray) -> FloatArray:
        left = np.exp(-((speeds / self.speed) ** self.exponent))
        friction: FloatArray = self.base + self.excess * left + self.viscous * speeds
        return friction


def _fall_of(speeds: FloatArray, curve: FloatArray, most: float) -> _Fall:
    """Least squares with no number below 0; without a fall where that leaves as little."""
    from scipy.optimize import minimize, nnls

    def solved(speed: float, exponent: float, *, falls: bool = True) -> tuple[float, _Fall]:
        left = np.exp(-((speeds / speed) ** exponent)) if falls else np.zeros(len(speeds))
        columns = np.column_stack([np.ones(len(speeds)), left, speeds])
        (base, excess, viscous), rest = nnls(columns, curve)
        return float(rest), _Fall(float(base), float(excess), speed, exponent, float(viscous))

    plain = solved(0.1 * most, 2.0, falls=False)
    best = min(
        (solved(share * most, shape) for share in FALLS for shape in SHAPES),
        key=lambda found: found[0],
    )
    low, high = (math.log(FALLS[k] * most) for k in (0, -1))

    def inside(x: FloatArray) -> tuple[float, float]:
        return math.exp(min(max(x[0], low), high)), min(max(x[1], SHAPES[0]), SHAPES[-1])

    found = minimize(
        lambda x: solved(*inside(x))[0],
        [math.log(best[1].speed), best[1].exponent],
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-12 * (plain[0] + 1e-300), "maxiter": 400},
    )
    best = min(best, solved(*inside(found.x)), key=lambda each: each[0])
    size = float(np.linalg.norm(curve))
    return plain[1] if plain[0] <= WORTH_SAYING * 0.1 * size else best[1]


@dataclass(frozen=True)
class _Load:
    """Shares of the load that friction grows by, in BAM's order: motor, external."""

    motor: float = 0.0
    external: float = 0.0
    motor_steep: float = 0.0
    external_steep: float = 0.0
    motor_quad: float = 0.0
    external_quad: float = 0.0

    @classmethod
    def of(cls, stated: dict[str, float]) -> _Load:
        """Of the law ``load_dependent``, whose quadratic terms are named the other way."""
        return cls(
            stated["drive"],
            stated["back_drive"],
            stated["drive_stribeck"],
            stated["back_drive_stribeck"],
            motor_quad=stated["back_drive_quadratic"],
            external_quad=stated["drive_quadratic"],
        )

    @property
    def falls(self) -> bool:
        """Whether some of it falls with speed."""
        return any((self.motor_steep, self.external_steep, self.motor_quad, self.external_quad))

    def model(self, *, falls: bool) -> str:
        """The least of the models that holds it."""
        if self.motor_quad or self.external_quad:
            return "m6"
        if (self.motor, self.motor_steep) != (self.external, self.external_steep):
            return "m5"
        if self.motor or self.motor_steep:
            return "m4" if falls else "m3"
        return "m2" if falls else "m1"

    def numbers(self, model: str) -> dict[str, float]:
        """By their names in a model."""
        if model in ("m1", "m2"):
            return {}
        if model in ("m3", "m4"):
            steep = {"load_friction_stribeck": self.motor_steep} if model == "m4" else {}
            return {"load_friction_base": self.motor, **steep}
        numbers = {
            "load_friction_motor": self.motor,
            "load_friction_external": self.external,
            "load_friction_motor_stribeck": self.motor_steep,
            "load_friction_external_stribeck": self.external_steep,
        }
        if model == "m6":
            numbers["load_friction_motor_quad"] = self.motor_quad
            numbers["load_friction_external_quad"] = self.external_quad
        return numbers
