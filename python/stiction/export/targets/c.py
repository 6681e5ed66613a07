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
from ...errors import InputError
from ..firmware import Firmware
from ..made import Export
from ..runs import EffortRun

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = (
    "friction step by step, feed-forward and disturbance observer in one C99 file, for firmware"
)
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


def runs(made: Export, plant: Plant) -> tuple[EffortRun]:
    """The file that was written, compiled and called."""
    friction, place = _compiled(made)

    def effort(velocity: FloatArray, position: FloatArray) -> FloatArray:
        pairs = zip(velocity.tolist(), position.tolist(), strict=True)
        return np.array([friction(at) + place(where) for at, where in pairs])

    return (EffortRun("", effort),)


def _compiled(made: Export) -> tuple[ctypes._NamedFuncPointer, ctypes._NamedFuncPointer]:
    """Friction over speed and effort over position, as C has them."""
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        raise InputError("c: there is no C compiler to run it with; install one (cc, gcc or clang)")
    with TemporaryDirectory() as folder:
        made.save(folder)
        built = Path(folder) / "feedforward.so"
        source = str(Path(folder) / "stiction_feedforward.c")
        flags = ["-std=c99", "-O2", "-shared", "-fPIC"]
        done = subprocess.run(
            [compiler, *flags, source, "-o", str(built), "-lm"], capture_output=True, text=True
        )
        if done.returncode != 0:
            raise InputError(f"c: {compiler} cannot compile it: {done.stderr.strip()}")
        # What is loaded stays when the file is gone.
        library = ctypes.CDLL(str(built))
    found = library.stiction_friction, library.stiction_place
    for function in found:
        function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double]
    return found


def _listed(sentences: tuple[str, ...]) -> str:
    return "\n".join(f" * - {_plain(sentence)}" for sentence in sentences)


def _plain(sentence: str) -> str:
    """A sentence for a comment: ASCII, and nothing that ends it."""
    ascii_only = sentence.replace("·", "*").replace("²", "2").encode("ascii", "replace").decode()
    return ascii_only.replace("*/", "* /")
