"""Exported C, compiled for this machine and stepped along a motion."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import stiction as st

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
FLAGS = ("-std=c99", "-O2", *WARNINGS)
KINDS = {"double": (ctypes.c_double, np.float64), "float": (ctypes.c_float, np.float32)}
DRIVER = """
#include "stiction_feedforward.h"
static stiction_state state;
unsigned long size_of_state(void);
void begin(void);
void replay(int n, const STICTION_REAL *v, const STICTION_REAL *dt, const STICTION_REAL *effort,
            const STICTION_REAL *load, const STICTION_REAL *temperature, STICTION_REAL *friction);
unsigned long size_of_state(void) { return (unsigned long)sizeof(state); }
void begin(void) { stiction_init(&state); }
#ifdef HAS_POSITION
void begin_at(STICTION_REAL position);
void begin_at(STICTION_REAL position) { stiction_set_position(&state, position); }
#endif
void replay(int n, const STICTION_REAL *v, const STICTION_REAL *dt, const STICTION_REAL *effort,
            const STICTION_REAL *load, const STICTION_REAL *temperature, STICTION_REAL *friction)
{
    int k;
    for (k = 0; k < n; ++k) {
        friction[k] = stiction_step(&state, v[k], dt[k], effort[k], load[k], temperature[k]);
    }
}
"""


class Compiled:
    """The C of a plant."""

    def __init__(
        self,
        plant: st.Plant,
        folder: Path,
        real: str = "double",
        driver: str = DRIVER,
        flags: tuple[str, ...] = FLAGS,
    ) -> None:
        compiler = shutil.which("cc") or pytest.skip("no C compiler is installed")
        self.made = plant.export("c")
        self.made.save(folder)
        (folder / "driver.c").write_text(driver)
        if "set_position" in self.made.files["stiction_feedforward.h"]:
            flags = (*flags, "-DHAS_POSITION")
        built = folder / f"plant_{real}.so"
        sources = [str(folder / name) for name in ("stiction_feedforward.c", "driver.c")]
        flags = (*flags, f"-DSTICTION_REAL={real}", "-shared", "-fPIC")
        subprocess.run([compiler, *flags, *sources, "-o", str(built), "-lm"], check=True)
        self.kind, self.type = KINDS[real]
        self.library = ctypes.CDLL(str(built))

    def function(self, name: str, given: int):
        """A function of numbers."""
        found = getattr(self.library, f"stiction_{name}")
        found.restype, found.argtypes = self.kind, [self.kind] * given
        return found

    def begin(self, position: float) -> None:
        """A contact that was never moved, at a position."""
        self.library.begin()
        if hasattr(self.library, "begin_at"):
            self.library.begin_at(self.kind(position))

    def step(self, velocity, dt, effort=0.0, load=0.0, temperature=np.nan, *, begin=True):
        """Friction along a motion of a contact that was never moved."""
        if begin:
            self.library.begin()
        shape = np.shape(velocity)
        columns = [
            np.ascontiguousarray(np.broadcast_to(each, shape), dtype=self.type)
            for each in (velocity, dt, effort, load, temperature)
        ]
        friction = np.zeros(shape, dtype=self.type)
        pointers = [each.ctypes.data_as(ctypes.c_void_p) for each in (*columns, friction)]
        self.library.replay(len(friction), *pointers)
        return friction.astype(float)
