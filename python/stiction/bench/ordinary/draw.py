"""What an ordinary session holds: machine, drive, loop, sensor, log, all drawn from one seed."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .hidden import MOVED_HIDDEN, Plain, with_effect
from .machine import Machine, simulate
from .signals import KINDS, FloatArray, signal

__all__ = [
    "FORMATS",
    "MOVED_HIDDEN",
    "OWN_LAWS",
    "RECORDINGS",
    "SAMPLE_TIMES",
    "SECONDS",
    "SIZES",
    "Log",
    "Ordinary",
    "Spec",
    "null_grid",
    "ordinary",
    "size_of",
]

SAMPLE_TIMES = (1e-3, 2e-3, 2.5e-3, 4e-3, 5e-3, 1e-2)
COUNTS = tuple(2**bits for bits in range(10, 21))
RECORDINGS = (1, 1, 2, 3, 4, 6, 8)
SECONDS = (40.0, 120.0)
"""Of a session: bounds of a draw."""
SIZES = (0.01, 0.3)
"""Of what is hidden, share of the dry friction: bounds of a log-uniform draw."""
FORMATS = ("npz", "csv", "mat", "json", "parquet")
FLAWS = ("constant", "holes", "still", "")
"""What may be wrong with the data: a channel that does not change, cells without a number, a drive
that moves nothing."""
HOLES = 0.12
OWN_LAWS = {"dry": "coulomb", "bristle": "lugre"}
"""Contacts of the machine, and the laws of the catalogue that have the same form."""


@dataclass(frozen=True)
class Spec:
    """What one session shall be; what is None is drawn.

    Attributes
    ----------
    seed : int
    law : str
        That the plant file states, whatever the machine has.
    hidden, size
        Name of an effect, "" for none, and share of the dry friction.
    kind : str
        "driven", "servo" or "moved" (prescribed motion).
    flaw : str
        One of `FLAWS`.
    """

    seed: int
    law: str = "coulomb"
    hidden: str = ""
    size: float | None = None
    kind: str = "driven"
    flaw: str = ""
    recordings: int | None = None
    seconds: float | None = None
    dt: float | None = None
    counts: int | None = None
    flicker: float | None = None
    log_noise: float | None = None
    signals: tuple[str, ...] | None = None
    loop: str | None = None
    contact: str | None = None
    drive: str | None = None
    file_format: str | None = None
    linear: bool | None = None


@dataclass(frozen=True)
class Decided:
    """A spec with everything decided; ``size`` is 0 where nothing is hidden."""

    seed: int
    law: str
    hidden: str
    size: float
    kind: str
    flaw: str
    recordings: int
    seconds: float
    dt: float
    counts: int
    flicker: float
    log_noise: float
    signals: tuple[str, ...]
    loop: str
    contact: str
    drive: str
    file_format: str
    linear: bool


@dataclass(frozen=True)
class Log:
    """Columns of one recording, SI, and the effort that was hidden in it."""

    time: FloatArray
    input: FloatArray
    position: FloatArray
    reference: FloatArray | None
    hidden: FloatArray
    kind: str
    start_s: float


@dataclass(frozen=True)
class Ordinary:
    """A session and its truth."""

    spec: Decided
    machine: Machine
    drive: dict[str, Any]
    logs: list[Log]
    radius: float | None
    stated_sensor: bool
    controller: dict[str, Any] = field(default_factory=dict)
    roles: tuple[str, ...] = ()
    clock: bool = False
    foreign_columns: bool = False

    @property
    def relative_rms(self) -> float:
        """rms of the hidden effort, share of the dry friction."""
        power = np.mean([np.mean(log.hidden**2) for log in self.logs])
        return float(math.sqrt(power)) / self.machine.coulomb

    @property
    def names(self) -> list[str]:
        return [self.spec.hidden] if self.spec.hidden else []


def ordinary(spec: Spec) -> Ordinary:
    """The session of a spec; the same for the same one, and the same machine whatever is hidden."""
    rng = _stream(spec.seed, "session")
    return _made(_drawn(spec, rng), rng)


def _made(spec: Decided, rng: np.random.Generator) -> Ordinary:
    machine = _machine(spec, _stream(spec.seed, "machine"))
    drive, machine = _drive(spec, machine, _stream(spec.seed, "drive"))
    if spec.hidden:
        plain = _plain(spec, machine, drive)
        hide = _stream(spec.seed, spec.hidden)
        machine = with_effect(machine, spec.hidden, spec.size, plain, hide)
    logs = _logs(spec, machine, drive)
    controller = _controller(spec, machine) if spec.loop == "pd" and rng.random() < 0.6 else {}
    roles = ("train", "select", "test") if spec.recordings >= 3 and rng.random() < 0.4 else ()
    return Ordinary(
        spec=spec,
        machine=machine,
        drive=drive,
        logs=[_flawed(log, spec, _stream(spec.seed, "flaw")) for log in logs],
        radius=float(rng.uniform(0.005, 0.05)) if spec.linear else None,
        stated_sensor=bool(rng.random() < 0.8),
        controller=controller,
        roles=roles,
        clock=bool(rng.random() < 0.4),
        foreign_columns=bool(rng.random() < 0.4),
    )


def size_of(rng: np.random.Generator) -> float:
    """A size, log-uniform."""
    return float(np.exp(rng.uniform(*np.log(SIZES))))


def null_grid(seed: int = 44) -> list[Spec]:
    """Two dozen sessions of known effort with nothing hidden, `coulomb` and the encoder stated.

    Six recordings of 20 s of sums of sines each, over encoders, sample times and noises of the log.
    """
    cells = [
        (counts, dt, noise)
        for counts in (1024, 4096, 16384, 65536)
        for dt in (1e-3, 2e-3, 5e-3)
        for noise in (0.0, 0.02)
    ]
    return [
        Spec(
            seed=seed + k,
            counts=counts,
            dt=dt,
            log_noise=noise,
            flicker=0.2,
            recordings=6,
            seconds=120.0,
            signals=("sines",) * 6,
            loop="open",
            contact="dry",
            drive="torque",
            file_format="npz",
            linear=False,
        )
        for k, (counts, dt, noise) in enumerate(cells)
    ]


# --- drawing


def _stream(seed: int, *words: str) -> np.random.Generator:
    return np.random.default_rng([seed, *(zlib.crc32(w.encode()) for w in ("ordinary", *words))])


def _drawn(spec: Spec, rng: np.random.Generator) -> Decided:
    """The spec with everything decided; every draw is made, so that what is given moves none."""
    number = int(rng.choice(RECORDINGS))
    mixed = tuple(str(k) for k in rng.choice(KINDS, number)) if rng.random() < 0.6 else ()
    one = str(rng.choice(KINDS))
    drawn: dict[str, Any] = {
        "recordings": number,
        "seconds": float(rng.uniform(*SECONDS)),
        "dt": float(rng.choice(SAMPLE_TIMES)),
        "counts": int(rng.choice(COUNTS)),
        "flicker": float(rng.choice([0.0, 0.2, 0.5])),
        "log_noise": float(rng.choice([0.0, 0.0, 0.02])),
        "loop": str(rng.choice(["open", "open", "pd", "velocity"])),
        "contact": str(rng.choice(["dry", "dry", "bristle"])),
        "drive": str(rng.choice(["torque", "current", "voltage"])),
        "file_format": str(rng.choice(FORMATS)),
        "linear": bool(rng.random() < 0.15),
        "size": size_of(rng) if spec.hidden else 0.0,
    }
    drawn |= {name: getattr(spec, name) for name in drawn if getattr(spec, name) is not None}
    if spec.kind != "driven":
        drawn |= {"loop": "open", "linear": False}
    kinds = spec.signals or mixed or (one,)
    if spec.signals is None:
        kinds = tuple(kinds[k % len(kinds)] for k in range(drawn["recordings"]))
    own: dict[str, Any] = {"seed": spec.seed, "law": spec.law, "hidden": spec.hidden}
    return Decided(**own, kind=spec.kind, flaw=spec.flaw, signals=kinds, **drawn)


def _machine(spec: Decided, rng: np.random.Generator) -> Machine:
    inertia = float(np.exp(rng.uniform(np.log(2e-5), np.log(2e-1))))
    coulomb = inertia * float(rng.uniform(50.0, 300.0))
    viscous = coulomb * float(rng.uniform(0.01, 0.1))
    deflection = float(np.exp(rng.uniform(np.log(1e-3), np.log(1e-2))))
    bristle = deflection if spec.contact == "bristle" else 0.0
    return Machine(inertia, coulomb, viscous, bristle=bristle)


def _drive(spec: Decided, machine: Machine, rng: np.random.Generator) -> tuple[Any, Machine]:
    if spec.kind == "servo":
        return _servo(machine, rng)
    constant = float(np.exp(rng.uniform(np.log(0.02), np.log(2.0))))
    if spec.drive == "current":
        return {"input": "current_a", "gain": constant}, replace(machine, gain=constant)
    if spec.drive == "voltage":
        # Its counter effort brakes as much as what is viscous.
        counter = machine.viscous * float(rng.uniform(0.3, 1.5))
        gain = counter / constant
        told = {"input": "voltage_v", "gain": gain}
        return told, replace(machine, gain=gain, counter=counter)
    return {"input": "torque_nm"}, machine


def _servo(machine: Machine, rng: np.random.Generator) -> tuple[Any, Machine]:
    supply = 12.0
    largest = float(rng.uniform(3.0, 6.0)) * machine.coulomb
    constant = float(np.exp(rng.uniform(np.log(0.1), np.log(1.0))))
    resistance = constant * supply / largest
    told = {
        "kind": "servo",
        "proportional": largest**-1
        * machine.inertia
        * (2.0 * math.pi * rng.uniform(3.0, 6.0)) ** 2,
        "supply_v": supply,
        "resistance_ohm": resistance,
        "torque_constant": constant,
    }
    return told, replace(machine, gain=constant / resistance, counter=constant**2 / resistance)


def _controller(spec: Decided, machine: Machine) -> dict[str, Any]:
    """Gains of the position loop, per unit of the input."""
    rng = _stream(spec.seed, "loop")
    omega = 2.0 * math.pi * float(rng.uniform(2.0, 5.0))
    omega = min(omega, 0.25 / spec.dt)
    kp = machine.inertia * omega**2 / machine.gain
    return {"kind": "pd", "kp": kp, "kd": 1.6 * kp / omega, "derivative": "backward"}


# --- recording


def _samples(spec: Decided) -> int:
    return round(spec.seconds / spec.recordings / spec.dt)


def _logs(spec: Decided, machine: Machine, drive: dict[str, Any]) -> list[Log]:
    logs, now = [], 0.0
    for k in range(spec.recordings):
        rng = _stream(spec.seed, "recording", str(k))
        make = {"driven": _driven, "servo": _goal, "moved": _moved}[spec.kind]
        time, given, read, reference, hidden = make(spec, machine, drive, spec.signals[k], rng)
        logs.append(Log(time, given, read, reference, hidden, spec.signals[k], round(now, 3)))
        now += float(time[-1]) + float(rng.uniform(1.0, 8.0))
    return logs


class _Encoder:
    """Whole counts, with flicker before they are cut."""

    def __init__(self, spec: Decided, rng: np.random.Generator) -> None:
        self.step = 2.0 * math.pi / spec.counts
        self.shaken = spec.flicker * rng.standard_normal(_samples(spec) * 10)
        self.read: list[float] = []

    def __call__(self, position: float) -> float:
        told = self.step * round(position / self.step + float(self.shaken[len(self.read)]))
        self.read.append(told)
        return told


def _driven(
    spec: Decided, machine: Machine, drive: dict[str, Any], kind: str, rng: np.random.Generator
) -> Any:
    samples, dt, encoder = _samples(spec), spec.dt, _Encoder(spec, rng)
    wave = signal(kind, samples, dt, rng)
    largest = 0.5 if spec.flaw == "still" else float(rng.uniform(1.6, 3.5))
    reference = None
    if spec.loop == "pd":
        gains = _controller(spec, machine)
        reference = wave * float(rng.uniform(0.5, 4.0))
        goals = [*reference[:1], *reference]

        def control(k: int, x: float) -> float:
            now = encoder(x)
            before = encoder.read[-2] if k else now
            wanted = (goals[k + 1] - goals[k]) / dt
            error = goals[k + 1] - now
            asked = gains["kp"] * error + gains["kd"] * (wanted - (now - before) / dt)
            return float(asked)

    elif spec.loop == "velocity":
        wanted = wave * float(rng.uniform(2.0, 12.0))
        omega = min(2.0 * math.pi * float(rng.uniform(3.0, 8.0)), 0.3 / dt)
        proportional = machine.inertia * omega / machine.gain
        held = [0.0]

        def control(k: int, x: float) -> float:
            now = encoder(x)
            before = encoder.read[-2] if k else now
            error = float(wanted[k]) - (now - before) / dt
            held[0] += 0.3 * omega * dt * error
            return proportional * (error + held[0])

    else:
        efforts = (wave * largest * machine.coulomb / machine.gain).tolist()

        def control(k: int, x: float) -> float:
            encoder(x)
            return float(efforts[k])

    given = []

    def logged(k: int, x: float) -> float:
        given.append(control(k, x))
        return given[-1]

    motion = simulate(machine, logged, samples, dt)
    noise = spec.log_noise * machine.coulomb / machine.gain * rng.standard_normal(samples)
    time = np.arange(samples) * dt
    return time, np.array(given) + noise, np.array(encoder.read), reference, np.array(motion.hidden)


def _goal(
    spec: Decided, machine: Machine, drive: dict[str, Any], kind: str, rng: np.random.Generator
) -> Any:
    """A servo that is told where to go; its own loop runs ten times as often as it is logged."""
    samples, dt, encoder = _samples(spec), spec.dt, _Encoder(spec, rng)
    goals = signal(kind, samples, dt, rng) * float(rng.uniform(0.5, 1.5))

    def control(k: int, x: float) -> float:
        if k % 10 == 0:
            encoder(x)
        duty = float(drive["proportional"]) * (float(goals[k // 10]) - x)
        return float(drive["supply_v"]) * max(-1.0, min(1.0, duty))

    motion = simulate(machine, control, 10 * samples, 0.1 * dt)
    hidden = np.array(motion.hidden)[::10]
    return np.arange(samples) * dt, goals, np.array(encoder.read), None, hidden


def _moved(
    spec: Decided, machine: Machine, drive: dict[str, Any], kind: str, rng: np.random.Generator
) -> Any:
    """The machine is moved along sines, and the effort that this takes is measured."""
    samples, dt, encoder = _samples(spec), spec.dt, _Encoder(spec, rng)
    t = np.arange(samples) * dt
    effects = machine.effects
    x, v, a = np.zeros((3, samples))
    for hertz in rng.uniform(0.2, 3.0, 3):
        w, phase = 2.0 * math.pi * hertz, rng.uniform(0.0, 2.0 * math.pi)
        x += np.sin(w * t + phase) / hertz
        v += w * np.cos(w * t + phase) / hertz
        a -= w * w * np.sin(w * t + phase) / hertz
    fall = effects.fall / (1.0 + (v / effects.fall_speed) ** 2)
    missing = machine.coulomb * np.sign(v) * (fall + effects.asymmetry * np.sign(v))
    missing += effects.quadratic * np.abs(v) * v + effects.bias
    effort = machine.inertia * a + machine.coulomb * np.sign(v) + machine.viscous * v + missing
    noise = max(spec.log_noise, 0.005) * machine.coulomb
    effort += noise * rng.standard_normal(samples)
    return t, effort, np.array([encoder(float(place)) for place in x]), None, missing


def _plain(spec: Decided, machine: Machine, drive: dict[str, Any]) -> Plain:
    """The first recording, short, with nothing hidden."""
    short = replace(spec, hidden="", size=0.0, recordings=1, seconds=spec.seconds / spec.recordings)
    (log,) = _logs(short, machine, drive)
    velocity = np.gradient(log.position, spec.dt)
    return Plain(machine.gain * log.input, velocity, float(np.ptp(log.position)), spec.dt)


def _flawed(log: Log, spec: Decided, rng: np.random.Generator) -> Log:
    if spec.flaw == "constant":
        return replace(log, position=np.full_like(log.position, log.position[0]))
    if spec.flaw == "holes":
        given = log.input.copy()
        given[rng.random(len(given)) < HOLES] = math.nan
        return replace(log, input=given)
    return log
