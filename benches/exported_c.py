"""Motors with every law, and with effects, beside the C that `stiction export` writes of them.

The exported C is the same integrator with the numbers of a plant as constants and nothing but what
it has; it is compiled for speed, takes the same efforts in turn, and has to give the same motion.
Loops in C that were written by hand for speed alone are in `c/` (see `peers.py`).

    python benches/exported_c.py [--only LAW ...] [--rounds 9]
"""

from __future__ import annotations

import argparse
import ctypes
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import stiction as st
from stiction.export.fragments import names_of
from stiction.export.machine_source import MachineSource

from .peers import DT, FLAGS, SAMPLES, efforts

INERTIA = 0.0076
LAWS = tuple(names_of("laws"))
WITH_EFFECTS = ("coulomb", "hsieh_pan", "lugre")
SEVERAL = ("cogging", "position_dependent_friction", "torque_bias")
ALIKE = 1e-5
"""Of the range of the position. Bristles that are drawn at random go apart by rounding alone."""
AT_RANDOM = ("bristle",)
DRIVER = """
static stiction_machine it;
static stiction_way way;
int run(int n, const double *u, double dt, double *x, double *v)
{
    int k;
    it.enabled = 1;
    machine_begin(&it, 0.0, 0.0);
    way_begin(&way);
    for (k = 0; k < n; ++k) {
        const acting by = {way_pass(&way, u[k], dt), 0.0, 30.0};
        if (!machine_step(&it, &by, dt)) {
            break;
        }
        x[k] = it.contact.position.value;
        v[k] = it.velocity;
    }
    return k;
}
"""

Run = Callable[[], None]


def plant(law: str, effects: Sequence[str]) -> st.Plant:
    """A motor with a law that breaks away at .5 N·m where it can, and effects of typical size."""
    named = {each.name for each in st.laws()[law].parameters}
    friction: dict[str, Any] = {"law": law} | ({"breakaway": 0.5} if "breakaway" in named else {})
    return st.Plant.from_dict(
        {
            "body": {"inertia": INERTIA},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "friction": friction,
            "effects": [
                {"name": name} | {p.name: p.typical for p in st.effects()[name].parameters}
                for name in effects
            ],
        }
    )


def contestants(own: st.Plant, folder: Path) -> tuple[Run, Run, Callable[[], float]]:
    """The motor, its C, and how far they are apart as a share of the range of the position."""
    effort = efforts()
    ours = {name: np.zeros(SAMPLES) for name in ("position", "velocity")}
    theirs = {name: np.zeros(SAMPLES) for name in ours}
    motor = own.motor()
    source, built = folder / "machine.c", folder / "machine.so"
    source.write_text(MachineSource.of(own, (), {}).source + DRIVER)
    subprocess.run(["cc", *FLAGS, "-w", source, "-o", built, "-lm"], check=True)
    loop = ctypes.CDLL(str(built)).run
    pointers = [
        each.ctypes.data_as(ctypes.c_void_p)
        for each in (effort, theirs["position"], theirs["velocity"])
    ]

    def core() -> None:
        motor.reset()
        motor.simulate(effort, DT, out=ours, temperature=30.0)

    def in_c(_keep: object = effort) -> None:
        if loop(SAMPLES, pointers[0], ctypes.c_double(DT), *pointers[1:]) != SAMPLES:
            raise RuntimeError("the sample is too long for the C of this plant")

    def apart() -> float:
        span = float(np.ptp(theirs["position"])) or 1.0
        return float(np.max(np.abs(ours["position"] - theirs["position"]))) / span

    return core, in_c, apart


def compared(own: st.Plant, rounds: int) -> tuple[float, float, float]:
    """Nanoseconds a sample of the motor and of its C, the best of rounds in turn; how far apart."""
    with tempfile.TemporaryDirectory() as folder:
        core, in_c, apart = contestants(own, Path(folder))
        best = [np.inf, np.inf]
        for _ in range(rounds):
            for k, run in enumerate((core, in_c)):
                begun = time.perf_counter()
                run()
                best[k] = min(best[k], (time.perf_counter() - begun) * 1e9 / SAMPLES)
        return best[0], best[1], apart()


def main() -> None:
    """Print a line a plant."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="*", default=LAWS, help="laws")
    parser.add_argument("--rounds", type=int, default=9)
    args = parser.parse_args()
    wanted = [(law, ()) for law in args.only]
    singles = [(name,) for name in names_of("effects")]
    for law in (law for law in WITH_EFFECTS if law in args.only):
        wanted += [(law, effects) for effects in (*singles, SEVERAL)]
    print(f"{'plant':56}{'ns':>9}{'ns in C':>9}{'ratio':>7}")
    for law, effects in wanted:
        own, other, apart = compared(plant(law, effects), args.rounds)
        if law not in AT_RANDOM and apart > ALIKE:
            raise RuntimeError(
                f"{law} {effects}: C is another motion, {apart:.2g} of its range off"
            )
        print(
            f"{' + '.join((law, *effects)):56}{own:9.1f}{other:9.1f}{own / other:7.2f}", flush=True
        )


if __name__ == "__main__":
    main()
