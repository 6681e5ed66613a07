"""What a simulation gets wrong: a recording of a motor that cogs, beside a plant that does not.

python examples/residual_of_a_recording.py [figure.png]
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import stiction as st
from stiction import plot
from stiction.residual import effort_residual

PLANT = """
[drive]
input = "current_a"
gain = 0.5                  # N·m/A
[body]
inertia = 0.0076            # kg·m²
[friction]
law = "hsieh_pan"
breakaway = 0.5             # N·m
viscous = 0.05              # N·m·s/rad
[sensor]
counts_per_rev = 1048576
"""
COGGING = '[[effects]]\nname = "cogging"\ncosine = 0.03\norder = 24\n'
DT = 1e-3  # s


def record(folder):
    """A CSV file with canonical column names, as a motor with cogging would give it."""
    (folder / "cogs.toml").write_text(PLANT + COGGING, encoding="utf-8")
    machine = st.Plant.load(folder / "cogs.toml").motor()
    time = DT * np.arange(8001)
    current = 1.6 * np.sin(2 * np.pi * 0.5 * time) + 0.5 * np.sin(2 * np.pi * 3.1 * time)
    run = machine.simulate(current, DT, outputs=("measured",))
    # Output k is the state after input k: it belongs to row k + 1.
    position = np.concatenate([[0.0], run.measured[:-1]])
    rows, head = np.column_stack([time, current, position]), "time_s,current_a,position_rad"
    np.savetxt(folder / "run.csv", rows, delimiter=",", header=head, comments="", fmt="%.12g")
    return folder / "run.csv"


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        recording = st.Recording.load(record(folder))
        (folder / "plain.toml").write_text(PLANT, encoding="utf-8")
        for title in ("plain", "cogs"):
            found = effort_residual(st.Plant.load(folder / f"{title}.toml"), recording)
            print(f"plant '{title}': {100 * found.relative:.2f} % of the effort unexplained")
            if title == "plain" and len(sys.argv) > 1:
                print("wrote", plot.save(found.plot(), sys.argv[1]))


if __name__ == "__main__":
    main()
