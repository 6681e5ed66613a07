"""Ordinary sessions of the axis, drawn from a seed: what an engineer records, as files, and the truth in a folder apart."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from tests.reference.axis4.machine import Loop, Machine, Motion, share, simulate

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
LEAD = 0.01  # m per turn of the ballscrew


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


def draw(seed: int, family: str, *, six: bool, seconds: float, contact: str | None = None) -> Bench:
    """A machine and a plan of recordings; `seconds` is the whole session's data."""
    r = np.random.default_rng([4, seed])

    def log(low: float, high: float) -> float:
        return float(np.exp(r.uniform(np.log(low), np.log(high))))

    linear = family == "ballscrew"
    coulomb = log(10.0, 80.0) if linear else log(0.02, 5.0)
    typical = log(0.03, 0.2) if linear else log(2.0, 20.0)
    viscous = r.uniform(0.3, 0.9) * coulomb / typical
    inertia = viscous * log(0.06, 0.4)
    looped = family in ("geared_joint", "ballscrew")
    period = float(r.choice([0.001, 0.002, 0.004, 0.005] if looped else [0.001, 0.002, 0.005, 0.01]))
    counts = int(2 ** r.integers(14 if looped else 10, 21))
    turn = LEAD if linear else 2 * math.pi
    count = turn / counts
    contact = contact or "rigid"
    reach = typical * 0.004  # the bristle's deflection where it slides
    bristle = coulomb / reach if contact != "rigid" else 0.0
    gain = {"torque_axis": 1.0, "dc_motor": log(0.05, 0.5), "geared_joint": 1.0, "ballscrew": log(20.0, 200.0)}[family]
    machine = Machine(
        inertia,
        coulomb,
        float(viscous),
        contact=contact,
        bristle=bristle,
        bristle_damping=0.6 * math.sqrt(bristle * inertia) if contact == "lugre" else 0.0,
        gain=gain,
    )
    loop = None
    if looped:
        width = min(2 * math.pi * r.uniform(3.0, 8.0), 0.12 / period)
        kind = "position" if linear or r.random() < 0.5 else "velocity"
        loop = Loop(kind, inertia * width, inertia * width * width / 4, width / 4, 0.35 / width, 12 * coulomb)
    if six:
        kinds = tuple(KINDS[i] for i in r.permutation(5)) + (str(r.choice(KINDS)),)
        length = seconds / 6
    else:
        kinds, length = (str(r.choice(["sines", "squares", "chirp", "ramps"])),), seconds
    starts = tuple(float(x) for x in np.cumsum([0.0] + [length + r.uniform(2, 8) for _ in kinds[1:]]))
    return Bench(
        seed,
        family,
        machine,
        period,
        counts,
        count,
        float(r.uniform(0.0, 0.4)),
        float(r.choice([0.0, 0.02])),
        typical,
        kinds,
        length,
        loop,
        float(r.choice([0.0, r.uniform(0.5, 40.0)])),
        str(r.choice(["csv", "npz"])),
        starts,
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
        y = sum(a * (np.sin(2 * np.pi * f * t + p)) for a, f, p in zip(sizes, rates, phases, strict=True))
        return y / (0.6 * np.sum(sizes)) * np.minimum(t / 0.3, 1.0)
    if kind == "ramps":
        period = r.uniform(1.5, 4.0)
        phase = (t / period + 0.25) % 1.0
        return 1.2 * (1.0 - 4.0 * np.abs(phase - 0.5)) * (0.5 + 0.5 * np.floor(t / period + 0.25) % 2)
    if kind == "steps":
        hold = r.uniform(0.3, 0.8)
        levels = r.uniform(-1.3, 1.3, math.ceil(length / hold) + 1)
        return levels[(t / hold).astype(int)]
    if kind == "squares":
        period, duty = r.uniform(1.0, 2.5), r.uniform(0.5, 0.8)
        phase = t / period % 1.0
        size = np.array([1.0, 0.7, 1.2])[(t / period).astype(int) % 3]
        return np.where(phase < duty / 2, size, np.where((phase > 0.5) & (phase < 0.5 + duty / 2), -size, 0.0))
    low, high = 0.15, r.uniform(2.0, 5.0)
    k = np.log(high / low) / length
    return 1.1 * np.sin(2 * np.pi * low / k * (np.exp(k * t) - 1.0))


def hide(b: Bench, effect: str, size: float, r: np.random.Generator, peak: float) -> tuple[Machine, float]:
    """The machine with the effect, and how late its readings are logged. `size` is a number without unit, calibrated later."""
    m = b.machine
    turn = LEAD if b.linear else 2 * math.pi
    total = b.seconds * len(b.kinds)
    two = dict(load_inertia=r.uniform(0.35, 0.6) * m.inertia, load_viscous=0.05 * m.viscous)
    if effect == "stribeck":
        return replace(m, stribeck=3 * size * m.coulomb, stribeck_speed=b.typical * r.uniform(0.08, 0.3)), 0.0
    if effect == "asymmetry":
        return replace(m, asymmetry=size), 0.0
    if effect == "viscous_quadratic":
        return replace(m, quadratic=size * m.coulomb / b.typical**2), 0.0
    if effect == "cogging":
        wave = 2 * math.pi / turn * int(r.integers(4, 13))
        p, q = r.uniform(0, 2 * math.pi, 2)
        return replace(m, ripple=((size * m.coulomb, wave, p), (0.4 * size * m.coulomb, 2 * wave, q))), 0.0
    if effect == "torque_bias":
        return replace(m, bias=size * m.coulomb * float(r.choice([-1, 1]))), 0.0
    if effect == "position_load":
        if b.linear:
            return replace(m, spring=size * m.coulomb / (b.typical * 0.5)), 0.0
        return replace(m, gravity=1.4 * size * m.coulomb, gravity_zero=r.uniform(-math.pi, math.pi)), 0.0
    if effect in ("backlash", "shaft_compliance"):
        if effect == "backlash":  # a stiff mesh, so that the gap is what is seen
            two["load_inertia"] = r.uniform(0.15, 0.35) * m.inertia
        jl = two["load_inertia"]
        reduced = jl * (m.inertia - jl) / m.inertia
        rate = 2 * math.pi * (120.0 if effect == "backlash" else 14.0 / math.sqrt(max(size, 0.02)))
        rate = min(rate, 2 * math.pi * 150.0)
        shaft, damping = reduced * rate**2, 2 * 0.06 * reduced * rate
        gap = 0.06 * size * b.typical if effect == "backlash" else 0.0
        return replace(m, **two, shaft=shaft, shaft_damping=damping, play=gap), 0.0
    if effect == "load_dependence":
        return replace(m, load_share=size * 0.6), 0.0
    if effect == "input_saturation":
        return replace(m, limit=peak * (1.0 - min(size, 0.8))), 0.0
    if effect == "input_dead_band":
        return replace(m, dead_band=size * m.coulomb), 0.0
    if effect == "current_loop_lag":
        return replace(m, lag=size * 0.02), 0.0
    if effect == "torque_constant_error":
        return replace(m, weakening=min(size, 0.7), weakening_at=peak), 0.0
    if effect == "position_friction":
        wave = 2 * math.pi / turn * int(r.integers(1, 4)) / (10 if b.linear else 1)
        return replace(m, patch=1.4 * min(size, 0.6), patch_wave=wave, patch_phase=r.uniform(0, 2 * math.pi)), 0.0
    if effect == "temperature_drift":
        return replace(m, warm=2 * size, warm_time=0.4 * total), 0.0
    if effect == "log_delay":
        return m, min(size, 2.0) * 0.02
    raise ValueError(effect)


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


def write(b: Bench, effect: str | None, target: float, folder: Path, truth: Path) -> dict[str, object]:
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
    (truth / f"{folder.name}.json").write_text(json.dumps(facts, indent=1, default=float), encoding="utf-8")
    return facts


def _save(b: Bench, m: Machine, run: Motion, late: float, r: np.random.Generator, path: Path) -> None:
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
        out.writerows([f"{t:.6f}", f"{u:.9g}", f"{p:.12g}"] for t, u, p in zip(*table.values(), strict=True))


def _names(b: Bench) -> tuple[str, str]:
    unit = {"torque_axis": "torque_nm", "dc_motor": "voltage_v", "geared_joint": "torque_nm", "ballscrew": "current_a"}
    return unit[b.family], "position_m" if b.linear else "position_rad"


def _toml(b: Bench, names: list[str], r: np.random.Generator, folder: Path) -> None:
    law = "coulomb" if b.machine.contact == "rigid" else b.machine.contact
    sensor = f"count_m = {b.count!r}" if b.linear else f"counts_per_rev = {b.counts}"
    (folder / "plant.toml").write_text(
        f'[motion]\nkind = "{"linear" if b.linear else "rotary"}"\n\n'
        f'[drive]\ninput = "{_names(b)[0]}"\ngain = {b.machine.gain!r}\n\n'
        f"[body]\ninertia = {b.machine.inertia * r.uniform(0.85, 1.15):.4g}  # from the drawings\n\n"
        f'[friction]\nlaw = "{law}"\n\n[sensor]\n{sensor}\n',
        encoding="utf-8",
    )
    text = 'plant = "plant.toml"\n'
    for name, kind, start in zip(names, b.kinds, b.starts, strict=True):
        text += f'\n[[recordings]]\nfile = "{name}"\nkind = "{kind}"\nstart_s = {start:.1f}\n'
    (folder / "session.toml").write_text(text, encoding="utf-8")


def plan(seed: int, number: int = 16) -> list[tuple[str, Bench, str | None, float]]:
    """Names, benches, hidden effects and wanted shares: as many nulls as hidden ones; each effect once in sixteen."""
    r = np.random.default_rng([7, seed])
    out: list[tuple[str, Bench, str | None, float]] = []
    contacts = ["rigid"] * 12 + ["dahl", "lugre"] * 2
    for i in range(number):
        own = 1000 * seed + i
        bench = draw(
            own, FAMILIES[i % 4], six=bool(i // 4 % 2), seconds=float(r.uniform(20, 30)), contact=contacts[(i * 5) % 16]
        )
        out.append((f"n{own:05d}", bench, None, 0.0))
    order = r.permutation(len(EFFECTS))
    for i in range(number):
        own = 1000 * seed + 500 + i
        effect = EFFECTS[order[i % len(EFFECTS)]]
        six = bool(i // 4 % 2) or effect == "temperature_drift"
        bench = draw(own, FAMILIES[i % 4], six=six, seconds=float(r.uniform(20, 30)))
        if effect == "backlash" and bench.loop and bench.counts < 2**17:
            # Else the loop makes the encoder's steps into effort, and the mesh's resonance outweighs the gap.
            bench = replace(bench, counts=2**17, count=bench.count * bench.counts / 2**17)
        out.append((f"h{own:05d}", bench, effect, float(np.exp(r.uniform(np.log(0.08), np.log(0.4))))))
    return out


def make(seed: int, out: Path, number: int = 16) -> None:
    for name, bench, effect, target in plan(seed, number):
        facts = write(bench, effect, target, out / "sessions" / name, out / "truth")
        print(
            f"{name} {bench.family:12} {facts['contact']:6} {effect or '-':22} {target:.3f} {facts['share']:.3f}"
            f" {facts['share_left_by_the_fit']:.3f} size {facts['size']:.3f} dt {bench.period} counts {bench.counts}"
            f" {bench.loop.kind if bench.loop else 'open':9} {','.join(bench.kinds):20} slides {facts['sliding']:.2f}",
            flush=True,
        )


if __name__ == "__main__":
    import sys

    make(int(sys.argv[1]), Path(sys.argv[2]))
