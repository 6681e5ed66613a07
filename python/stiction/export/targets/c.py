"""C99: a step of a plant's contact, its feed-forward and an observer, in one file without heap."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.atomic_files import write_text
from ...errors import InputError
from ..firmware import Firmware
from ..made import Export
from ..runs import EffortRun, Led, StepRun

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = (
    "friction step by step, feed-forward and disturbance observer in one C99 file, for firmware"
)
_DOUBLES: Final = ctypes.POINTER(ctypes.c_double)
HEAD: Final = """\
/* {what}. Made from a plant file by stiction; made again, not edited.
 *
 * velocity in {unit}/s, acceleration in {unit}/s2, position in {unit}, time in s, temperature in
 * degrees Celsius; efforts in {effort}. C99, no heap, no library but that of math.h.
 * Define STICTION_REAL as float where that is faster, here and where the header is read.
 * What it holds:
{held}
 * What it cannot hold:
{lost}
 */
#include "stiction_feedforward.h"
"""


STEPPING: Final = """\
#include "stiction_feedforward.h"

void stiction_led(const double *position, const double *drive, const double *load,
                  const double *temperature, double dt, long samples, double *needed)
{
    stiction_state contact;
    long k;
    stiction_init(&contact);
    PLACED
    for (k = 0; k < samples; k++) {
        const double velocity = (position[k + 1] - position[k]) / dt;
        const double gravity = GRAVITY(0.5 * (position[k] + position[k + 1]));
        const double effort = drive[k] + load[k] + gravity;
        needed[k] = stiction_step(&contact, velocity, dt, effort, load[k], temperature[k])
                    - GRAVITY(position[k + 1]);
    }
}
"""
"""A contact that was never moved, stepped along a motion."""


def write(plant: Plant, speed: float) -> Export:
    """Law and effects as C, curves as points with lines between them, an observer."""
    made = Firmware.of(plant, speed)
    head = HEAD.format(
        what=plant.friction.law + "".join(f" + {effect.name}" for effect in plant.effects),
        unit=plant.position_unit,
        effort=_plain(plant.effort_unit),
        held=_listed(made.held),
        lost=_listed(made.lost) or " * nothing",
    )
    files = {"stiction_feedforward.c": head + made.source, "stiction_feedforward.h": made.header}
    return Export("c", files, made.held, made.lost, made.numbers)


def runs(made: Export, plant: Plant) -> tuple[EffortRun | StepRun, ...]:
    """The file that was written, compiled and called: its curves, and its contact step by step."""
    header = str(made.files["stiction_feedforward.h"])
    steps = "stiction_step(" in header
    library = _compiled(made, _stepping(header) if steps else "")
    friction, place = library.stiction_friction, library.stiction_place
    for function in (friction, place):
        function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double]

    def effort(velocity: FloatArray, position: FloatArray) -> FloatArray:
        pairs = zip(velocity.tolist(), position.tolist(), strict=True)
        return np.array([friction(at) + place(where) for at, where in pairs])

    def stepped(led: Led) -> FloatArray:
        samples = len(led.drive)
        unknown = np.full(samples, np.nan)
        given = (led.position, led.drive, led.load, led.temperature)
        held = [np.ascontiguousarray(unknown if each is None else each) for each in given]
        needed = np.empty(samples)
        pointers = [each.ctypes.data_as(_DOUBLES) for each in (*held, needed)]
        library.stiction_led(
            *pointers[:-1], ctypes.c_double(led.dt), ctypes.c_long(samples), pointers[-1]
        )
        return needed

    curves = EffortRun("", effort)
    return (curves, StepRun("step by step", stepped)) if steps else (curves,)


def _stepping(header: str) -> str:
    """What steps the contact of a plant along a motion."""
    placed = "stiction_set_position(&contact, position[0]);" if "set_position(" in header else ""
    hangs = "stiction_gravity(" in header
    macro = f"#define GRAVITY(at) {'stiction_gravity(at)' if hangs else '(0.0 * (at))'}\n"
    return macro + STEPPING.replace("PLACED", placed)


def _compiled(made: Export, beside: str) -> ctypes.CDLL:
    """The file and what is beside it, compiled."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        raise InputError("c: there is no C compiler to run it with; install one (cc, gcc or clang)")
    with TemporaryDirectory() as folder:
        made.save(folder)
        built = Path(folder) / "feedforward.so"
        sources = [str(Path(folder) / "stiction_feedforward.c")]
        if beside:
            sources.append(str(Path(folder) / "led.c"))
            write_text(Path(sources[-1]), beside)
        flags = ["-std=c99", "-O2", "-shared", "-fPIC"]
        done = subprocess.run(
            [compiler, *flags, *sources, "-o", str(built), "-lm"], capture_output=True, text=True
        )
        if done.returncode != 0:
            raise InputError(f"c: {compiler} cannot compile it: {done.stderr.strip()}")
        # What is loaded stays when the file is gone.
        return ctypes.CDLL(str(built))


def _listed(sentences: tuple[str, ...]) -> str:
    return "\n".join(f" * - {_plain(sentence)}" for sentence in sentences)


def _plain(sentence: str) -> str:
    """A sentence for a comment: ASCII, and nothing that ends it."""
    ascii_only = sentence.replace("·", "*").replace("²", "2").encode("ascii", "replace").decode()
    return ascii_only.replace("*/", "* /")
