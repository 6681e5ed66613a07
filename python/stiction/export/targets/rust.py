"""Rust: the step of a plant's contact, its feed-forward and an observer, as a crate without std."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.atomic_files import atomic_write, write_text
from ...errors import InputError
from ..firmware import Firmware
from ..made import Export
from ..runs import EffortRun
from ..rust_source import crate_files

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "the same as c in Rust: a crate without std, allocation or unsafe code"

CALLER: Final = """\
use stiction_plant::{friction, place};

fn main() {
    for line in std::io::stdin().lines() {
        let line = line.unwrap();
        let mut given = line.split(' ').map(|each| each.parse().unwrap());
        let (velocity, position) = (given.next().unwrap(), given.next().unwrap());
        println!("{:e}", friction(velocity) + place(position));
    }
}
"""
"""A program that is told speeds and places, and tells efforts."""


def write(plant: Plant, speed: float) -> Export:
    """What the C of the plant states, as Rust."""
    made = Firmware.of(plant, speed)
    what = plant.friction.law + "".join(f" + {effect.name}" for effect in plant.effects)
    units = (plant.position_unit, plant.effort_unit)
    files = crate_files(made, what, units, made.held, made.lost)
    return Export("rust", files, made.held, made.lost, made.numbers)


def runs(made: Export, plant: Plant) -> tuple[EffortRun]:
    """The crate that was written, built by cargo and called."""
    cargo = shutil.which("cargo")
    if cargo is None:
        raise InputError("rust: there is no cargo to run it with; install Rust")
    program = _built(made, cargo)

    def effort(velocity: FloatArray, position: FloatArray) -> FloatArray:
        pairs = zip(velocity.tolist(), position.tolist(), strict=True)
        text = "".join(f"{at!r} {where!r}\n" for at, where in pairs)
        with TemporaryDirectory() as folder:
            caller = Path(folder) / "effort"
            with atomic_write(caller) as file:
                file.write(program)
            caller.chmod(0o700)
            told = subprocess.run(
                [str(caller)], input=text, capture_output=True, text=True, check=True
            )
        return np.array(told.stdout.split(), dtype=float)

    return (EffortRun("", effort),)


def _built(made: Export, cargo: str) -> bytes:
    """The program that calls the crate."""
    with TemporaryDirectory() as folder:
        made.save(folder)
        examples = Path(folder) / "examples"
        examples.mkdir()
        write_text(examples / "effort.rs", CALLER)
        target = Path(folder) / "target"
        done = subprocess.run(
            [cargo, "build", "--quiet", "--example", "effort", "--target-dir", str(target)],
            cwd=folder,
            capture_output=True,
            text=True,
        )
        if done.returncode != 0:
            last = " ".join(done.stderr.strip().splitlines()[-1:]).strip()
            raise InputError(f"rust: cargo cannot build it: {last}")
        return (target / "debug" / "examples" / "effort").read_bytes()
