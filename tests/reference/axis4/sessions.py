"""Ordinary sessions of the axis, drawn from a seed: what an engineer records, as files.

The truth lies in a folder apart.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from .machine import Loop, Machine, Motion, share, simulate

FAMILIES = ("torque_axis", "dc_motor", "geared_joint", "ballscrew")
EFFECTS = (
    "stribeck",
    "asymmetry",
    "viscous_quadratic",
    "cogging",
    "torque_bias",
    "position_load",
    "backlash",
    "shaft_compliance",
    "load_dependence",
    "input_saturation",
    "input_dead_band",
    "current_loop_lag",
    "torque_constant_error",
    "position_friction",
    "temperature_drift",
    "log_delay",
)
KINDS = ("sines", "ramps", "steps", "squares", "chirp")
DEAL = len(EFFECTS)
SLOWEST = 0.02
"""s: what a lag or a delay of size 1 is."""
REACH_S = 0.004
"""s at the typical speed in which a bristle is bent to where it slides."""
LEAD = 0.01
"""m a turn of the ballscrew."""


@dataclass
class Bench:
    """Everything of a session but its hidden effect."""

    seed: int
    family: str
    machine: Machine
    period: float
    counts: int  # per turn
    count: float  # rad or m
    noise: float  # of the readings, in counts
    log_noise: float  # share of coulomb
    typical: float  # speed, rad/s or m/s
    kinds: tuple[str, ...]
    seconds: float  # of each recording
    loop: Loop | None
    offset: float  # of the clock
    form: str  # "csv" or "npz"
    starts: tuple[float, ...]

    @property
    def linear(self) -> bool:
        return self.family == "ballscrew"


def draw(seed: int, family: str, *, six: bool, seconds: float, contact: str = "rigid") -> Bench:
    """A machine and a plan of recordings; `seconds` is the whole session's data."""
    r = np.random.default_rng([4, seed])
    linear, looped = family == "ballscrew", family in ("geared_joint", "ballscrew")
    coulomb = _log(r, 10.0, 80.0) if linear else _log(r, 0.02, 5.0)
    typical = _log(r, 0.03, 0.2) if linear else _log(r, 2.0, 20.0)
    viscous = r.uniform(0.3, 0.9) * coulomb / typical
    inertia = viscous * _log(r, 0.06, 0.4)
    periods = [0.001, 0.002, 0.004, 0.005] if looped else [0.001, 0.002, 0.005, 0.01]
    period = float(r.choice(periods))
    counts = int(2 ** r.integers(14 if looped else 10, 21))
    volts, amperes = _log(r, 0.05, 0.5), _log(r, 20.0, 200.0)
    gain = {"dc_motor": volts, "ballscrew": amperes}.get(family, 1.0)
    machine = Machine(inertia, coulomb, float(viscous), gain=gain)
    if contact != "rigid":
        machine = _yielding(machine, contact, REACH_S * typical)
    loop = _loop(r, machine, period, linear=linear) if looped else None
    if six:
        kinds = (*(KINDS[i] for i in r.permutation(5)), str(r.choice(KINDS)))
    else:
        kinds = (str(r.choice(["sines", "squares", "chirp", "ramps"])),)
    length = seconds / len(kinds)
    gaps = [length + r.uniform(2, 8) for _ in kinds[1:]]
    return Bench(
        seed=seed,
        family=family,
        machine=machine,
        period=period,
        counts=counts,
        count=(LEAD if linear else 2 * math.pi) / counts,
        typical=typical,
        kinds=kinds,
        seconds=length,
        loop=loop,
        starts=tuple(float(x) for x in np.cumsum([0.0, *gaps])),
        noise=float(r.uniform(0.0, 0.4)),
        log_noise=float(r.choice([0.0, 0.02])),
        offset=float(r.choice([0.0, r.uniform(0.5, 40.0)])),
        form=str(r.choice(["csv", "npz"])),
    )


def _log(r: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(r.uniform(np.log(low), np.log(high))))


def _yielding(m: Machine, contact: str, reach: float) -> Machine:
    """With a bristle that slides where it is bent by `reach`."""
    stiffness = m.coulomb / reach
    damping = 0.6 * math.sqrt(stiffness * m.inertia) if contact == "lugre" else 0.0
    return replace(m, contact=contact, bristle=stiffness, bristle_damping=damping)


def _loop(r: np.random.Generator, m: Machine, period: float, *, linear: bool) -> Loop:
    width = min(2 * math.pi * r.uniform(3.0, 8.0), 0.12 / period)
    return Loop(
        kind="position" if linear or r.random() < 0.5 else "velocity",
        proportional=m.inertia * width,
        integral=m.inertia * width * width / 4,
        position=width / 4,
        filter_s=0.35 / width,
        limit=12 * m.coulomb,
    )


def excitation(b: Bench, kind: str, r: np.random.Generator) -> np.ndarray:
    """An effort, a speed or a position over one recording, from rest."""
    n = round(b.seconds / b.period)
    t = np.arange(n) * b.period
    shape = _shape(kind, t, b.seconds, r)
    if b.loop is None:
        m = b.machine
        return shape * (m.coulomb + m.viscous * b.typical) * r.uniform(1.1, 1.7)
    speed = shape * b.typical * r.uniform(0.8, 1.3)
    if b.loop.kind == "velocity":
        return speed
    # A position: the speed made smooth and summed, without what would carry it away.
    width = max(1, round(0.05 / b.period))
    smooth = np.convolve(speed, np.ones(width) / width)[:n]
    place = np.cumsum(smooth) * b.period
    return place - place[-1] * t / t[-1]


def _shape(kind: str, t: np.ndarray, length: float, r: np.random.Generator) -> np.ndarray:
    """Of size about one."""
    if kind == "sines":
        rates = np.exp(r.uniform(np.log(0.2), np.log(3.0), 4))
        sizes, phases = r.uniform(0.4, 1.0, 4), r.uniform(0, 2 * np.pi, 4)
        y = sum(
            a * (np.sin(2 * np.pi * f * t + p))
            for a, f, p in zip(sizes, rates, phases, strict=True)
        )
        return y / (0.6 * np.sum(sizes)) * np.minimum(t / 0.3, 1.0)
    if kind == "ramps":
        period = r.uniform(1.5, 4.0)
        phase = (t / period + 0.25) % 1.0
        return 1.2 * (1.0 - 4.0 * np.abs(phase - 0.5)) * (0.5 + 0.5 * (np.floor(t / period) % 2))
    if kind == "steps":
        hold = r.uniform(0.3, 0.8)
        levels = r.uniform(-1.3, 1.3, math.ceil(length / hold) + 1)
        return levels[(t / hold).astype(int)]
    if kind == "squares":
        period, duty = r.uniform(1.0, 2.5), r.uniform(0.5, 0.8)
        phase = t / period % 1.0
        size = np.array([1.0, 0.7, 1.2])[(t / period).astype(int) % 3]
        return np.where(
            phase < duty / 2, size, np.where((phase > 0.5) & (phase < 0.5 + duty / 2), -size, 0.0)
        )
    low, high = 0.15, r.uniform(2.0, 5.0)
    k = np.log(high / low) / length
    return 1.1 * np.sin(2 * np.pi * low / k * (np.exp(k * t) - 1.0))


def hide(
    b: Bench, effect: str, size: float, r: np.random.Generator, peak: float
) -> tuple[Machine, float]:
    """The machine with the effect, and how late its readings are logged.

    `size` has no unit and is about the share of coulomb; `calibrate` finds the right one.
    """
    if effect == "log_delay":
        return b.machine, min(size, 2.0) * SLOWEST
    return replace(b.machine, **_PARTS[effect](_Hiding(b, size, r, peak))), 0.0


class _Hiding:
    """What the size of an effect is measured in."""

    def __init__(self, b: Bench, size: float, r: np.random.Generator, peak: float) -> None:
        self.m, self.typical, self.linear = b.machine, b.typical, b.linear
        self.size, self.r, self.peak = size, r, peak
        self.force = size * b.machine.coulomb
        self.wave = 2 * math.pi / (LEAD if b.linear else 2 * math.pi)  # once a turn
        self.total = b.seconds * len(b.kinds)
        self.far = r.uniform(0.35, 0.6)  # share of the inertia behind the shaft


def _cogging(h: _Hiding) -> dict[str, Any]:
    wave, (p, q) = h.wave * int(h.r.integers(4, 13)), h.r.uniform(0, 2 * math.pi, 2)
    return {"ripple": ((h.force, wave, p), (0.4 * h.force, 2 * wave, q))}


def _position_load(h: _Hiding) -> dict[str, Any]:
    if h.linear:
        return {"spring": h.force / (h.typical * 0.5)}
    return {"gravity": 1.4 * h.size * h.m.coulomb, "gravity_zero": h.r.uniform(-math.pi, math.pi)}


def _backlash(h: _Hiding) -> dict[str, Any]:
    # A stiff mesh, so that the gap is what is seen.
    return _behind(h, h.r.uniform(0.15, 0.35), 120.0) | {"play": 0.06 * h.size * h.typical}


def _compliance(h: _Hiding) -> dict[str, Any]:
    return _behind(h, h.far, 14.0 / math.sqrt(max(h.size, 0.02)))


def _behind(h: _Hiding, share: float, hertz: float) -> dict[str, Any]:
    far = share * h.m.inertia
    reduced, rate = far * (h.m.inertia - far) / h.m.inertia, 2 * math.pi * min(hertz, 150.0)
    return {
        "load_inertia": far,
        "load_viscous": 0.05 * h.m.viscous,
        "shaft": reduced * rate**2,
        "shaft_damping": 2 * 0.06 * reduced * rate,
    }


def _position_friction(h: _Hiding) -> dict[str, Any]:
    wave = h.wave * int(h.r.integers(1, 4)) / (10 if h.linear else 1)
    share, phase = 1.4 * min(h.size, 0.6), h.r.uniform(0, 2 * math.pi)
    return {"patch": share, "patch_wave": wave, "patch_phase": phase}


_PARTS: dict[str, Callable[[_Hiding], dict[str, Any]]] = {
    "stribeck": lambda h: {
        "stribeck": 3 * h.force,
        "stribeck_speed": h.typical * h.r.uniform(0.08, 0.3),
    },
    "asymmetry": lambda h: {"asymmetry": h.size},
    "viscous_quadratic": lambda h: {"quadratic": h.force / h.typical**2},
    "cogging": _cogging,
    "torque_bias": lambda h: {"bias": h.force * float(h.r.choice([-1, 1]))},
    "position_load": _position_load,
    "backlash": _backlash,
    "shaft_compliance": _compliance,
    "load_dependence": lambda h: {"load_share": h.size * 0.6},
    "input_saturation": lambda h: {"limit": h.peak * (1.0 - min(h.size, 0.8))},
    "input_dead_band": lambda h: {"dead_band": h.force},
    "current_loop_lag": lambda h: {"lag": h.size * SLOWEST},
    "torque_constant_error": lambda h: {"weakening": min(h.size, 0.7), "weakening_at": h.peak},
    "position_friction": _position_friction,
    "temperature_drift": lambda h: {"warm": 2 * h.size, "warm_time": 0.4 * h.total},
}


def run_all(b: Bench, m: Machine, drives: list[np.ndarray], step: float) -> list[Motion]:
    return [
        simulate(m, d, b.period, loop=b.loop, count=b.count, step=step, clock=c)
        for d, c in zip(drives, b.starts, strict=True)
    ]


def calibrate(b: Bench, effect: str, target: float, drives: list[np.ndarray], peak: float) -> float:
    """The size that gives the wanted share, by repeated proportion."""
    size = target
    for _ in range(7):
        m, late = hide(b, effect, size, np.random.default_rng([5, b.seed]), peak)
        got = share(m, run_all(b, m, drives, 4e-4), b.period, late)[0]
        if abs(got / target - 1) < 0.08:
            break
        size = float(np.clip(size * np.clip(target / max(got, 1e-4), 0.4, 2.5), 1e-3, 4.0))
    return size


def write(
    b: Bench, effect: str | None, target: float, folder: Path, truth: Path
) -> dict[str, object]:
    """Simulates the session and writes its files; what was hidden goes into `truth` alone."""
    r = np.random.default_rng([6, b.seed])
    drives = [excitation(b, kind, r) for kind in b.kinds]
    step = min(2e-4, b.period / 5)
    plain = run_all(b, b.machine, drives, 4e-4)
    peak = float(np.quantile(np.abs(np.concatenate([p.command for p in plain])), 0.995))
    m, late, size = b.machine, 0.0, 0.0
    if effect:
        size = calibrate(b, effect, target, drives, peak)
        m, late = hide(b, effect, size, np.random.default_rng([5, b.seed]), peak)
    runs = run_all(b, m, drives, step)
    raw, left = share(m, runs, b.period, late)
    folder.mkdir(parents=True, exist_ok=True)
    names = []
    for i, run in enumerate(runs):
        names.append(f"rec{i + 1}.{b.form}")
        _save(b, m, run, late, r, folder / names[-1])
    _toml(b, names, r, folder)
    facts = {
        "seed": b.seed,
        "family": b.family,
        "contact": m.contact,
        "hidden": [effect] if effect else [],
        "wanted_share": target if effect else 0.0,
        "share": raw,
        "share_left_by_the_fit": left,
        "size": size,
        "delay_s": late,
        "period_s": b.period,
        "counts": b.counts,
        "reading_noise_counts": b.noise,
        "log_noise": b.log_noise,
        "kinds": list(b.kinds),
        "loop": b.loop.kind if b.loop else None,
        "sliding": float(np.mean(np.concatenate([x.sliding for x in runs]))),
        "machine": asdict(m),
    }
    truth.mkdir(parents=True, exist_ok=True)
    (truth / f"{folder.name}.json").write_text(
        json.dumps(facts, indent=1, default=float), encoding="utf-8"
    )
    return facts


def _save(
    b: Bench, m: Machine, run: Motion, late: float, r: np.random.Generator, path: Path
) -> None:
    x = np.interp(run.time - late, run.time, run.position) if late else run.position
    read = np.floor(x / b.count + b.noise * r.standard_normal(len(x)) + 0.5) * b.count
    put = (run.command + b.log_noise * m.coulomb * r.standard_normal(len(x))) / m.gain
    unit, place = _names(b)
    table = {"time_s": run.time + b.offset, unit: put, place: read}
    if path.suffix == ".npz":
        np.savez(path, **table)
        return
    with path.open("w", newline="", encoding="utf-8") as f:
        out = csv.writer(f)
        out.writerow(table)
        out.writerows(
            [f"{t:.6f}", f"{u:.9g}", f"{p:.12g}"] for t, u, p in zip(*table.values(), strict=True)
        )


def _names(b: Bench) -> tuple[str, str]:
    unit = {
        "torque_axis": "torque_nm",
        "dc_motor": "voltage_v",
        "geared_joint": "torque_nm",
        "ballscrew": "current_a",
    }
    return unit[b.family], "position_m" if b.linear else "position_rad"


def stated_law(m: Machine) -> str:
    """What the plant file says: the form of contact that the machine has."""
    return "coulomb" if m.contact == "rigid" else m.contact


def _toml(b: Bench, names: list[str], r: np.random.Generator, folder: Path) -> None:
    sensor = f"count_m = {b.count!r}" if b.linear else f"counts_per_rev = {b.counts}"
    drawn = b.machine.inertia * r.uniform(0.85, 1.15)
    (folder / "plant.toml").write_text(
        f'[motion]\nkind = "{"linear" if b.linear else "rotary"}"\n\n'
        f'[drive]\ninput = "{_names(b)[0]}"\ngain = {b.machine.gain!r}\n\n'
        f"[body]\ninertia = {drawn:.4g}  # from the drawings\n\n"
        f'[friction]\nlaw = "{stated_law(b.machine)}"\n\n[sensor]\n{sensor}\n',
        encoding="utf-8",
    )
    text = 'plant = "plant.toml"\n'
    for name, kind, start in zip(names, b.kinds, b.starts, strict=True):
        text += f'\n[[recordings]]\nfile = "{name}"\nkind = "{kind}"\nstart_s = {start:.1f}\n'
    (folder / "session.toml").write_text(text, encoding="utf-8")


@dataclass(frozen=True)
class Planned:
    """A session that is to be made."""

    name: str
    bench: Bench
    effect: str | None
    share: float


def plan(seed: int, number: int = 16, seconds: tuple[float, float] = (20.0, 30.0)) -> list[Planned]:
    """As many with nothing hidden as with one effect; a longer plan holds the shorter one."""
    deals = [_deal(seed, k, seconds) for k in range(-(-number // DEAL))]
    plain = [each for deal in deals for each in deal[:DEAL]]
    hidden = [each for deal in deals for each in deal[DEAL:]]
    return plain[:number] + hidden[:number]


def _deal(seed: int, deal: int, seconds: tuple[float, float]) -> list[Planned]:
    """Sixteen sessions with nothing hidden, and every effect once."""
    r = np.random.default_rng([7, seed, deal])
    found = []
    contacts = ["rigid"] * 12 + ["dahl", "lugre"] * 2
    for i in range(DEAL):
        own, length = 1000 * seed + DEAL * deal + i, float(r.uniform(*seconds))
        contact = contacts[i * 5 % DEAL]
        bench = draw(own, FAMILIES[i % 4], six=bool(i // 4 % 2), seconds=length, contact=contact)
        found.append(Planned(f"n{own:05d}", bench, None, 0.0))
    for i, k in enumerate(r.permutation(DEAL)):
        own, length = 1000 * seed + 500 + DEAL * deal + i, float(r.uniform(*seconds))
        effect = EFFECTS[k]
        six = bool(i // 4 % 2) or effect == "temperature_drift"
        bench = draw(own, FAMILIES[i % 4], six=six, seconds=length)
        if effect == "backlash" and bench.loop and bench.counts < 2**17:
            # Else the loop makes the encoder's steps into effort, and the mesh's resonance
            # outweighs the gap.
            bench = replace(bench, counts=2**17, count=bench.count * bench.counts / 2**17)
        size = float(np.exp(r.uniform(np.log(0.08), np.log(0.4))))
        found.append(Planned(f"h{own:05d}", bench, effect, size))
    return found


def make(seed: int, out: Path, number: int = 16) -> None:
    for each in plan(seed, number):
        bench = each.bench
        facts = write(bench, each.effect, each.share, out / "sessions" / each.name, out / "truth")
        asked, got = each.share, facts["share"]
        print(f"{each.name} {bench.family} {each.effect}: {asked:.3f} asked, {got:.3f}", flush=True)


if __name__ == "__main__":
    import sys

    make(int(sys.argv[1]), Path(sys.argv[2]))
