"""What the command line writes of a simulation: a file that can be read as a recording."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from .._support.arrays import FloatArray
from .._support.table_file import save_table
from .._support.units import Motion
from ..plant import Plant
from ..recording import Recording
from ..trajectory import Trajectory

__all__ = ["save_trajectory"]

CANONICAL: Final[dict[Motion, dict[str, str]]] = {
    "rotary": {
        "position": "position_rad",
        "velocity": "velocity_rad_s",
        "friction": "friction_nm",
        "measured": "measured_rad",
        "load": "load_nm",
    },
    "linear": {
        "position": "position_m",
        "velocity": "velocity_m_s",
        "friction": "friction_n",
        "measured": "measured_m",
        "load": "load_n",
    },
}
"""Names that say quantity and unit; states of a law keep theirs, SI."""
INPUTS: Final = {
    "A": "current_a",
    "V": "voltage_v",
    "N·m": "torque_nm",
    "N": "force_n",
    "rad": "goal_rad",
    "m": "goal_m",
}
"""Names of an input by its unit, where the plant states none."""


def save_trajectory(path: Path, plant: Plant, recording: Recording, trajectory: Trajectory) -> Path:
    """Write a simulated recording under canonical names, with what acted in it.

    Parameters
    ----------
    path : Path
        CSV file.
    plant : Plant
    recording : Recording
        Whose input was simulated.
    trajectory : Trajectory
        Row k is the state at the stamp of row k + 1 of the recording.

    Returns
    -------
    Path
        Of the file.

    Raises
    ------
    InputError
        It cannot be written.
    """
    names = CANONICAL[plant.motion]
    table: dict[str, FloatArray] = {"time_s": trajectory.time}
    for name in trajectory:
        table[names.get(name, name)] = trajectory[name]
    # A row holds the state at its stamp and the input from there on, as in every recording.
    if recording.input is not None:
        table[_input_name(plant, recording)] = recording.input[1:]
    beside = {"load": names["load"], "temperature": "temperature_c", "enabled": "enabled"}
    for name, column in beside.items():
        if name in recording.channels:
            table[column] = recording.channels[name][1:]
    return save_table(path, {name: np.asarray(values) for name, values in table.items()})


def _input_name(plant: Plant, recording: Recording) -> str:
    stated = plant.drive.get("input")
    return str(stated or INPUTS.get(recording.units.get("input", ""), "input"))
