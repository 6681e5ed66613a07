"""An FMU that was written, run by its own functions of FMI 3.0."""

from __future__ import annotations

import ctypes
import io
import re
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np

from .._support.arrays import FloatArray
from ..errors import InputError
from .fmi_description import IDENTIFIER

if TYPE_CHECKING:
    from .runs import Windows

__all__ = ["run_windows"]

INPUT, LOAD, POSITION, VELOCITY, ENABLED = 1, 2, 4, 5, 12
"""Numbers of variables."""


def run_windows(archive: bytes, windows: Windows) -> FloatArray:
    """Where the FMU gets to in windows along a recording, its contact led to where they start.

    Returns
    -------
    numpy.ndarray, shape (windows, length)

    Raises
    ------
    InputError
        An archive without a binary for this computer; a step that the FMU refuses.
    """
    machine = _Instance(archive)
    position = np.ascontiguousarray(windows.position, dtype=float)
    inputs = np.ascontiguousarray(windows.input, dtype=float)
    loads = np.ascontiguousarray(windows.load, dtype=float)
    found = np.empty((len(windows.starts), windows.length))
    machine.begin(float(position[0]), windows.clock, windows.path)
    row = 0
    for window, start in enumerate(windows.starts.tolist()):
        pace = windows.velocity(start)
        machine.follow(start - row, windows.dt, position[row:], inputs[row:], loads[row:], pace)
        row, kept = start, machine.state()
        time = start * windows.dt
        for sample in range(windows.length):
            at = start + sample
            machine.enable(windows.drives(at))
            machine.step(time, windows.duration(at), inputs[at], loads[at])
            time += windows.duration(at)
            found[window, sample] = machine.get(POSITION)
        machine.go_back(kept)
    machine.free()
    return found


class _Instance:
    """An instance for co-simulation."""

    def __init__(self, archive: bytes) -> None:
        with zipfile.ZipFile(io.BytesIO(archive)) as files, TemporaryDirectory() as folder:
            binaries = [name for name in files.namelist() if name.startswith("binaries/")]
            if not binaries:
                raise InputError("fmu: it has no binary to run; install a C compiler")
            token = re.search(
                'instantiationToken="([^"]*)"', files.read("modelDescription.xml").decode()
            )
            # What is loaded stays when the file is gone.
            self._library = ctypes.CDLL(str(Path(files.extract(binaries[0], folder))))
        for name in ("fmi3InstantiateCoSimulation", "fmi3GetVersion"):
            getattr(self._library, name).restype = ctypes.c_void_p
        off, none = ctypes.c_bool(False), ctypes.c_void_p(None)
        own = token[1].encode() if token else b""
        made = self._library.fmi3InstantiateCoSimulation(
            IDENTIFIER.encode(), own, b"", off, off, off, off, none, ctypes.c_size_t(0), none,
            none, none,
        )  # fmt: skip
        self._own = ctypes.c_void_p(made)

    def _call(self, name: str, *given: Any) -> None:
        if getattr(self._library, name)(self._own, *given) != 0:
            raise InputError("fmu: a step was refused; the samples are too long for this machine")

    def _set(self, variable: int, value: float) -> None:
        one, number = ctypes.c_size_t(1), ctypes.c_uint32(variable)
        wanted = ctypes.c_double(value)
        self._call("fmi3SetFloat64", ctypes.byref(number), one, ctypes.byref(wanted), one)

    def enable(self, drives: bool) -> None:
        one, number, on = ctypes.c_size_t(1), ctypes.c_uint32(ENABLED), ctypes.c_bool(drives)
        self._call("fmi3SetBoolean", ctypes.byref(number), one, ctypes.byref(on), one)

    def get(self, variable: int) -> float:
        one, number, found = ctypes.c_size_t(1), ctypes.c_uint32(variable), ctypes.c_double()
        self._call("fmi3GetFloat64", ctypes.byref(number), one, ctypes.byref(found), one)
        return found.value

    def begin(self, position: float, clock: float, path: float) -> None:
        self._set(POSITION, position)
        off, zero = ctypes.c_bool(False), ctypes.c_double(0.0)
        self._call("fmi3EnterInitializationMode", off, zero, zero, off, zero)
        self._call("fmi3ExitInitializationMode")
        self._library.stiction_set_clock(self._own, ctypes.c_double(clock), ctypes.c_double(path))

    def follow(
        self,
        samples: int,
        dt: float,
        position: FloatArray,
        inputs: FloatArray,
        loads: FloatArray,
        velocity: float,
    ) -> None:
        pointers = [each.ctypes.data_as(ctypes.c_void_p) for each in (position, inputs, loads)]
        number, span = ctypes.c_size_t(samples), ctypes.c_double(dt)
        follow = self._library.stiction_follow
        follow(self._own, number, span, *pointers, ctypes.c_double(velocity))

    def step(self, time: float, dt: float, value: float, load: float) -> None:
        self._set(INPUT, float(value))
        self._set(LOAD, float(load))
        told = [ctypes.byref(ctypes.c_bool()) for _ in range(3)]
        last = ctypes.byref(ctypes.c_double())
        at, span = ctypes.c_double(time), ctypes.c_double(dt)
        self._call("fmi3DoStep", at, span, ctypes.c_bool(False), *told, last)

    def state(self) -> ctypes.c_void_p:
        kept = ctypes.c_void_p(None)
        self._call("fmi3GetFMUState", ctypes.byref(kept))
        return kept

    def go_back(self, kept: ctypes.c_void_p) -> None:
        self._call("fmi3SetFMUState", kept)
        self._call("fmi3FreeFMUState", ctypes.byref(kept))

    def free(self) -> None:
        self._library.fmi3FreeInstance(self._own)
