"""The same work by this library and by its peers, side by side in one run.

Every peer is optional: what cannot run says why. Rounds go through all contestants in turn, so that
a busy machine disturbs them alike; each repeat takes the best of some rounds. Only the ratios of
one run mean anything.

    python benches/peers.py [--repeats 5] [--json FILE] [--bam-python PYTHON]
"""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import stiction as st

HERE = Path(__file__).parent
SAMPLES, DT = 20_000, 1e-4
MEMBERS = 64
# Of an ensemble in which a second thread takes no part of the time to begin.
MORE_MEMBERS = 256
ROUNDS = 8
FLAGS = ["-O3", "-std=c11", "-fno-math-errno", "-fno-trapping-math", "-shared", "-fPIC"]
# Contestants that take long are timed over fewer samples.
FEW = 2000

# What a row is a multiple of where it is not the loop in C of the first row.
IN_TURN = f"C, {MEMBERS} members in turn"
LOGS = 100
OF_LOGS = f"simulate_ensemble, {LOGS}, x and v"
BAM = "better-actuator-models"
# Laws beside hsieh_pan with a loop in C, and what they state.
LAWS = {"lugre": {}, "dahl": {}, "coulomb": {"breakaway": 0.5}, "maxwell_slip": {}}
UNITS = {f"Motor.simulate, {law}": f"C, {law}" for law in LAWS} | {
    f"{who}, {MEMBERS}, {cores}": IN_TURN
    for who in ("simulate_ensemble", "numba prange")
    for cores in ("one core", "two cores")
}
UNITS |= {
    f"simulate_ensemble, {MORE_MEMBERS}, {cores}": IN_TURN for cores in ("one core", "two cores")
}
UNITS[f"{BAM}, {LOGS} batched"] = OF_LOGS

Run = Callable[[], None]


def efforts() -> np.ndarray:
    """Efforts that ring, creep and now and then break away, as in benches/lib.rs."""
    t = np.arange(SAMPLES) * DT
    return 0.45 * np.sin(6.0 * t) + np.where(np.mod(t, 0.3) < 0.02, 0.3, 0.0)


def own_law(law: str) -> tuple[Run, int]:
    """`Motor.simulate` of another law, into reused arrays."""
    motor = st.Motor(0.0076, friction=st.FrictionModel(law, **LAWS[law]))
    effort, outputs = efforts(), {"position": np.zeros(SAMPLES), "velocity": np.zeros(SAMPLES)}

    def run() -> None:
        motor.reset()
        motor.simulate(effort, DT, out=outputs)

    return run, SAMPLES


def own(outputs: dict[str, np.ndarray] | None) -> tuple[Run, int]:
    """`Motor.simulate`, into these arrays or into fresh ones for six columns."""
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan", breakaway=0.5))
    effort = efforts()
    names = ["position", "velocity", "friction", "measured", "plastic", "hardening"]

    def run() -> None:
        motor.reset()
        if outputs is None:
            motor.simulate(effort, DT, outputs=names)
        else:
            motor.simulate(effort, DT, out=outputs)

    run()
    if min(motor.statistics["breakaways"], motor.statistics["sticks"]) < 2:
        raise RuntimeError("the timed path does not break away and stick again")
    return run, SAMPLES


def jacobian(columns: int, *, reused: bool) -> tuple[Run, int]:
    """`Motor.sensitivity` by so many parameters, into an array that is there or a fresh one."""
    law = st.FrictionModel("hsieh_pan", breakaway=0.5, viscous=0.05)
    motor = st.Motor(0.0076, friction=law, weight=0.01)
    paths = [p for p in motor.parameters if not p.startswith("friction.loading")]
    paths = [p for p in paths if "gravity" not in p][:columns]
    if len(paths) < columns:
        raise RuntimeError(f"this motor has {len(paths)} parameters")
    effort = efforts()
    out = np.zeros((2, columns, SAMPLES)) if reused else None
    return lambda: _drop(motor.sensitivity(effort, DT, paths, out=out)), SAMPLES


def _drop(_: object) -> None:
    pass


def c_loop(name: str, folder: Path) -> Callable[..., None]:
    """The loop in C, compiled."""
    library = folder / f"{name}.so"
    direct = ["-DHSIEH_PAN_DIRECT"] if name.endswith("direct") else []
    source = HERE / "c" / f"{name.removesuffix('_direct')}.c"
    subprocess.run(["cc", *FLAGS, *direct, source, "-o", library, "-lm"], check=True)
    loop: Callable[..., None] = getattr(ctypes.CDLL(str(library)), name)
    return loop


def in_c(name: str, folder: Path) -> tuple[Run, int]:
    """The loop in C, one trajectory."""
    loop = c_loop(name, folder)
    effort = efforts()
    x, v = np.empty_like(effort), np.empty_like(effort)
    counted = (ctypes.c_long * 2)()
    effort_, x_, v_ = (a.ctypes.data_as(ctypes.c_void_p) for a in (effort, x, v))
    samples = ctypes.c_size_t(SAMPLES)

    def run(_keep: object = (effort, x, v)) -> None:
        loop(effort_, samples, x_, v_, counted)

    return run, SAMPLES


def in_numba() -> tuple[Run, int]:
    """The loop in numba, warm."""
    sys.path.insert(0, str(HERE))
    import numba_loops

    effort = efforts()
    x, v = np.empty_like(effort), np.empty_like(effort)
    if min(numba_loops.hsieh_pan(effort, x, v)) < 2:
        raise RuntimeError("the timed path does not break away and stick again")
    return lambda: _drop(numba_loops.hsieh_pan(effort, x, v)), SAMPLES


def many_efforts(members: int = MEMBERS) -> np.ndarray:
    """Those of an ensemble: the same at sizes from 0.85 to 1.15, so that events come apart."""
    return np.linspace(0.85, 1.15, members)[:, None] * efforts()


def many_in_c(folder: Path) -> tuple[Run, int]:
    """The loop in C, one member after the other, nothing reduced."""
    loop = c_loop("hsieh_pan", folder)
    rows = many_efforts()
    x, v = np.empty(SAMPLES), np.empty(SAMPLES)
    counted = (ctypes.c_long * 2)()
    x_, v_ = (a.ctypes.data_as(ctypes.c_void_p) for a in (x, v))
    pointers = [row.ctypes.data_as(ctypes.c_void_p) for row in rows]
    samples = ctypes.c_size_t(SAMPLES)

    def run(_keep: object = (rows, x, v)) -> None:
        for pointer in pointers:
            loop(pointer, samples, x_, v_, counted)

    return run, SAMPLES * MEMBERS


def many_own(threads: int, members: int = MEMBERS) -> tuple[Run, int]:
    """`simulate_ensemble`, reduced to the root mean square of the position."""
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan", breakaway=0.5))
    rows = many_efforts(members)

    def run() -> None:
        st.simulate_ensemble(motor, rows, DT, reduce="rms", threads=threads)

    return run, SAMPLES * members


def own_logs() -> tuple[Run, int]:
    """`simulate_ensemble` of as many as the batch of `bam`, every position and velocity kept."""
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan", breakaway=0.5))
    rows = many_efforts(LOGS)[:, :FEW]
    shown = ("position", "velocity")
    work = partial(st.simulate_ensemble, motor, rows, DT, outputs=shown, threads=1)
    return lambda: _drop(work()), FEW * LOGS


def many_in_numba(threads: int) -> tuple[Run, int]:
    """The loop in numba, members shared among threads by `prange`, reduced likewise."""
    sys.path.insert(0, str(HERE))
    import numba
    import numba_loops

    rows, found = many_efforts(), np.empty(MEMBERS)

    def run() -> None:
        numba.set_num_threads(threads)
        numba_loops.hsieh_pan_ensemble(rows, found)

    return run, SAMPLES * MEMBERS


def by_scipy(method: str) -> tuple[Run, int]:
    """LuGre, a smooth law with one state, through `solve_ivp`: lighter work than the other rows."""
    from scipy.integrate import solve_ivp

    effort = efforts()[:FEW]

    def rates(t: float, y: np.ndarray) -> list[float]:
        v, z = y[1], y[2]
        g = 0.35 + 0.15 * np.exp(-((v / 0.1) ** 2))
        dz = v - 3000.0 * abs(v) / g * z
        u = effort[min(int(t / DT), FEW - 1)]
        return [v, (u - 3000.0 * z - 0.45 * dz) / 0.0076, dz]

    span = (0.0, FEW * DT)
    return lambda: _drop(solve_ivp(rates, span, [0.0, 0.0, 0.0], method=method, rtol=1e-6)), FEW


def by_mujoco(kind: str) -> tuple[Run, int]:
    """`mj_step(n)` of one hinge: frictionloss, or LuGre friction in its direct-current motor."""
    import mujoco

    loss = 'frictionloss="0.35" damping="0.05"' if kind == "frictionloss" else ""
    lugre = '<dcmotor joint="j" motorconst="1 1" resistance="1" lugre="3000 0.45 0.35 0.5 0.1"/>'
    actuator = '<motor joint="j"/>' if kind == "frictionloss" else lugre
    model = mujoco.MjModel.from_xml_string(f"""<mujoco>
        <option timestep="{DT}" gravity="0 0 0"><flag contact="disable"/></option>
        <worldbody><body>
            <joint name="j" type="hinge" axis="0 0 1" armature="0.0076" {loss}/>
            <geom size="0.01" mass="1e-6"/>
        </body></worldbody>
        <actuator>{actuator}</actuator></mujoco>""")
    if kind != "frictionloss" and model.na == 0:
        raise RuntimeError(f"MuJoCo {mujoco.__version__} has no LuGre state")
    data = mujoco.MjData(model)
    data.ctrl[0] = 0.3
    return lambda: mujoco.mj_step(model, data, nstep=FEW), FEW


def bam(python: str, repeats: int) -> dict[str, list[float]]:
    """Nanoseconds a step of a log of better-actuator-models, in a Python of its own."""
    # -E: what is on the path of this Python is not on that of the other.
    script = [python, "-E", str(HERE / "bam_rollout.py"), str(repeats)]
    done = subprocess.run(script, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError((done.stderr.strip().splitlines() or ["failed"])[-1])
    found = json.loads(done.stdout.splitlines()[-1])["seconds"]
    return {name: [1e9 * s for s in each] for name, each in found.items()}


def contestants(folder: Path) -> tuple[dict[str, tuple[Run, int]], dict[str, str]]:
    """Those that run, and why the others do not."""
    reused = {"position": np.zeros(SAMPLES), "velocity": np.zeros(SAMPLES)}
    makers: dict[str, Callable[[], tuple[Run, int]]] = {
        "C": lambda: in_c("hsieh_pan", folder),
        "C, every exponential by the library": lambda: in_c("hsieh_pan_direct", folder),
        "Motor.simulate, x and v reused": lambda: own(reused),
        "Motor.simulate, six fresh columns": lambda: own(None),
        "Motor.sensitivity, 16 columns, reused": lambda: jacobian(16, reused=True),
        "Motor.sensitivity, 16 columns, fresh": lambda: jacobian(16, reused=False),
        "numba, warm": in_numba,
        IN_TURN: lambda: many_in_c(folder),
        f"simulate_ensemble, {MEMBERS}, one core": lambda: many_own(1),
        f"simulate_ensemble, {MEMBERS}, two cores": lambda: many_own(2),
        f"simulate_ensemble, {MORE_MEMBERS}, one core": lambda: many_own(1, MORE_MEMBERS),
        f"simulate_ensemble, {MORE_MEMBERS}, two cores": lambda: many_own(2, MORE_MEMBERS),
        OF_LOGS: own_logs,
        f"numba prange, {MEMBERS}, one core": lambda: many_in_numba(1),
        f"numba prange, {MEMBERS}, two cores": lambda: many_in_numba(2),
        "SciPy LSODA (LuGre)": lambda: by_scipy("LSODA"),
        "SciPy Radau (LuGre)": lambda: by_scipy("Radau"),
        "MuJoCo mj_step, frictionloss": lambda: by_mujoco("frictionloss"),
        "MuJoCo mj_step, LuGre": lambda: by_mujoco("lugre"),
    }
    for law in LAWS:
        makers[f"C, {law}"] = partial(in_c, law, folder)
        makers[f"Motor.simulate, {law}"] = partial(own_law, law)
    ready, missing = {}, {}
    for name, make in makers.items():
        try:
            run, samples = make()
            run()
            ready[name] = (run, samples)
        except Exception as problem:
            missing[name] = f"{type(problem).__name__}: {str(problem).splitlines()[0]}"
    return ready, missing


def measured(ready: dict[str, tuple[Run, int]], repeats: int) -> dict[str, list[float]]:
    """Nanoseconds a sample, one number a repeat: the best of some rounds through all."""
    slow = {"SciPy LSODA (LuGre)", "SciPy Radau (LuGre)"}
    times: dict[str, list[float]] = {name: [] for name in ready}
    for _ in range(repeats):
        best = dict.fromkeys(ready, float("inf"))
        for turn in range(ROUNDS):
            for name, (run, samples) in ready.items():
                if turn and name in slow:
                    continue
                # Time on the processor, which others on the machine do not lengthen, where one
                # thread does all of it.
                clock = time.perf_counter if name.endswith("two cores") else time.thread_time
                start = clock()
                run()
                best[name] = min(best[name], 1e9 * (clock() - start) / samples)
        for name, each in best.items():
            times[name].append(each)
    return times


def main() -> None:
    """Print the table and write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--bam-python", default=os.environ.get("BAM_PYTHON"))
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        ready, missing = contestants(Path(folder))
        times = measured(ready, chosen.repeats)
    try:
        if chosen.bam_python is None:
            raise RuntimeError("no --bam-python: it needs a Python 3.12 of its own")
        rollouts = bam(chosen.bam_python, chosen.repeats)
        times[f"{BAM}, one log"] = rollouts["one"]
        times[f"{BAM}, {LOGS} batched"] = rollouts["batched"]
    except (RuntimeError, OSError) as problem:
        missing[BAM] = str(problem)
    usual = "C" if "C" in times else "Motor.simulate, x and v reused"
    print(f"{'':38}{'ns a sample':>12}{'against C':>12}{'spread':>18}")
    rows = {}
    for name, each in times.items():
        unit = times.get(UNITS.get(name, usual), times[usual])
        ratios = [a / b for a, b in zip(each, unit, strict=True)]
        row = {"ns": statistics.median(each), "ratio": statistics.median(ratios)}
        rows[name] = row | {"least": min(ratios), "most": max(ratios)}
        print(
            f"{name:38}{row['ns']:12.1f}{row['ratio']:12.2f}{min(ratios):10.2f}–{max(ratios):.2f}"
        )
    for name, why in missing.items():
        print(f"{name:38}not run: {why}")
    if chosen.json:
        chosen.json.write_text(json.dumps({"rows": rows, "not_run": missing}, indent=1) + "\n")


if __name__ == "__main__":
    main()
