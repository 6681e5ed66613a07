"""How the time of a run grows with its horizon and its members, in one run.

`maxwell_slip` has no number of elements to grow with: it takes ever more of them in closed form.

    python benches/cost_growth.py [--repeats 5] [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import stiction as st

DT = 1e-4
FACTOR = 10
ROUNDS = 5

Run = Callable[[], None]


def efforts(samples: int) -> np.ndarray:
    """Efforts that ring, creep and now and then break away, period after period."""
    t = np.mod(np.arange(samples) * DT, np.pi / 3.0)
    return 0.45 * np.sin(6.0 * t) + np.where(np.mod(t, 0.3) < 0.02, 0.3, 0.0)


def horizon(samples: int) -> Run:
    """One trajectory."""
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan", breakaway=0.5))
    effort, outputs = efforts(samples), {"position": np.zeros(samples)}

    def run() -> None:
        motor.reset()
        motor.simulate(effort, DT, out=outputs)

    return run


def members(number: int) -> Run:
    """An ensemble on one core, reduced."""
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan", breakaway=0.5))
    sizes = np.resize(np.linspace(0.85, 1.15, 64), number)
    rows = sizes[:, None] * efforts(20_000)

    def run() -> None:
        st.simulate_ensemble(motor, rows, DT, reduce="rms", threads=1)

    return run


GROWTHS: dict[str, tuple[Callable[[int], Run], int]] = {
    "horizon, samples": (horizon, 20_000),
    "ensemble, members": (members, 64),
}


def main() -> None:
    """Print the table and write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path)
    chosen = parser.parse_args()
    rows = {}
    print(f"{'':24}{'from':>8}{'to':>8}{'time':>8}{'spread':>14}")
    for name, (make, size) in GROWTHS.items():
        small, large = make(size), make(FACTOR * size)
        ratios = []
        for _ in range(chosen.repeats):
            best = [np.inf, np.inf]
            for _ in range(ROUNDS):
                for k, run in enumerate((small, large)):
                    start = time.thread_time()
                    run()
                    best[k] = min(best[k], time.thread_time() - start)
            ratios.append(best[1] / best[0])
        middle, least, most = statistics.median(ratios), min(ratios), max(ratios)
        rows[name] = {"ratio": middle, "least": least, "most": most}
        print(f"{name:24}{size:8}{FACTOR * size:8}{middle:8.2f}{least:8.2f}–{most:.2f}", flush=True)
    if chosen.json:
        chosen.json.write_text(json.dumps(rows, indent=1) + "\n")


if __name__ == "__main__":
    main()
