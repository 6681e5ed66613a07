"""C99: the feed-forward of a plant in one file, without heap and without a library."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

import numpy as np

from ...errors import InputError
from ...trajectory import FloatArray
from ..curves import Curves
from ..made import Export
from ..runs import EffortRun

if TYPE_CHECKING:
    from ...plant import Plant

SUMMARY = "feed-forward of friction, position and inertia in one C99 file, for firmware"
MOST: Final = 48

HEAD: Final = """\
/* Feed-forward of {what}. Made from a plant file by stiction; made again, not edited.
 *
 * velocity in {unit}/s, acceleration in {unit}/s2, position in {unit}; the result in {effort}.
 * C99, no heap, no library. Define STICTION_REAL as float where that is faster.
 * What it cannot hold:
{lost}
 */
#ifndef STICTION_REAL
#define STICTION_REAL double
#endif
#define R(x) ((STICTION_REAL)(x))

enum {{ SPEEDS = {speeds}, PLACES = {places} }};
static const STICTION_REAL speed_at[SPEEDS] = {{{speed_at}}};
static const STICTION_REAL friction_at[SPEEDS] = {{{friction_at}}};
static const STICTION_REAL place_at[PLACES] = {{{place_at}}};
static const STICTION_REAL effort_at[PLACES] = {{{effort_at}}};
static const STICTION_REAL inertia = R({inertia});
static const STICTION_REAL gain = R({gain});
"""
BODY: Final = """
static STICTION_REAL between(const STICTION_REAL *x, const STICTION_REAL *y, int n,
                             STICTION_REAL at)
{
    int low = 0, high = n - 1;
    if (at <= x[0]) {
        return y[0];
    }
    if (at >= x[high]) {
        return y[high];
    }
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (x[middle] <= at) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return y[low] + (y[high] - y[low]) * (at - x[low]) / (x[high] - x[low]);
}

/* Effort that friction takes at a speed; between the slowest speeds of both directions a line. */
STICTION_REAL stiction_friction(STICTION_REAL velocity)
{
    return between(speed_at, friction_at, SPEEDS, velocity);
}

/* Effort that the machine needs to stand at a place. */
STICTION_REAL stiction_place(STICTION_REAL position)
{
    const STICTION_REAL turn = place_at[PLACES - 1];
    if (turn > R(0)) {
        const STICTION_REAL turns = position / turn;
        long whole = (long)turns;
        if ((STICTION_REAL)whole > turns) {
            whole -= 1;
        }
        position -= turn * (STICTION_REAL)whole;
    }
    return between(place_at, effort_at, PLACES, position);
}

/* Effort for a reference. */
STICTION_REAL stiction_feedforward(STICTION_REAL velocity, STICTION_REAL acceleration,
                                   STICTION_REAL position)
{
    return inertia * acceleration + stiction_friction(velocity) + stiction_place(position);
}

/* The input of the drive for that effort. */
STICTION_REAL stiction_input(STICTION_REAL effort)
{
    return effort / gain;
}
"""
HEADER: Final = """\
/* See stiction_feedforward.c. */
#ifndef STICTION_FEEDFORWARD_H
#define STICTION_FEEDFORWARD_H
#ifndef STICTION_REAL
#define STICTION_REAL double
#endif
STICTION_REAL stiction_friction(STICTION_REAL velocity);
STICTION_REAL stiction_place(STICTION_REAL position);
STICTION_REAL stiction_feedforward(STICTION_REAL velocity, STICTION_REAL acceleration,
                                   STICTION_REAL position);
STICTION_REAL stiction_input(STICTION_REAL effort);
#endif
"""


def write(plant: Plant, speed: float) -> Export:
    """Curves as points with lines between them, each off by as little as so many points can be."""
    curves = Curves.of(plant, speed, MOST)
    text = HEAD.format(
        what=plant.friction.law + "".join(f" + {effect.name}" for effect in plant.effects),
        unit=plant.position_unit,
        effort=plant.effort_unit.replace("·", "*"),
        lost="\n".join(f" * - {_plain(sentence)}" for sentence in curves.lost) or " * nothing",
        speeds=len(curves.speeds),
        places=len(curves.places),
        speed_at=_array(curves.speeds),
        friction_at=_array(curves.friction),
        place_at=_array(curves.places),
        effort_at=_array(curves.efforts),
        inertia=repr(0.0 if plant.prescribed_motion else plant.inertia),
        gain=repr(plant.gain),
    )
    files = {"stiction_feedforward.c": text + BODY, "stiction_feedforward.h": HEADER}
    held = curves.held if plant.prescribed_motion else (*curves.held, "inertia")
    return Export("c", files, held, curves.lost, curves.numbers)


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
            [compiler, *flags, source, "-o", str(built)], capture_output=True, text=True
        )
        if done.returncode != 0:
            raise InputError(f"c: {compiler} cannot compile it: {done.stderr.strip()}")
        # What is loaded stays when the file is gone.
        library = ctypes.CDLL(str(built))
    found = library.stiction_friction, library.stiction_place
    for function in found:
        function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double]
    return found


def _array(values: FloatArray) -> str:
    numbers = [f"R({value!r})" for value in values.tolist()]
    rows = [", ".join(numbers[k : k + 4]) for k in range(0, len(numbers), 4)]
    return "\n    " + ",\n    ".join(rows) + "\n"


def _plain(sentence: str) -> str:
    """A sentence for a comment: ASCII, and nothing that ends it."""
    ascii_only = sentence.replace("·", "*").replace("²", "2").encode("ascii", "replace").decode()
    return ascii_only.replace("*/", "* /")
