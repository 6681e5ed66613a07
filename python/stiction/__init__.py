"""Simulates machines that stick, creep and slip, and shows what a simulation gets wrong.

>>> import stiction as st
>>> motor = st.Motor(inertia=0.0076, friction=st.FrictionModel("hsieh_pan"))
>>> position, velocity = motor.step(0.2, 1e-4)
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from ._native import FrictionModel, Motion, __version__
from .errors import InputError
from .motor import Motor
from .trajectory import Trajectory

if TYPE_CHECKING:
    from .catalogue import effects, laws
    from .diagnosis import Diagnosis, diagnose
    from .ensemble import Ensemble, EnsembleRun, simulate_ensemble
    from .fitting import FitResult, fit
    from .plant import Plant
    from .recording import Recording
    from .session import Session, load
    from .streaming import stream

__all__ = [
    "Diagnosis",
    "Ensemble",
    "EnsembleRun",
    "FitResult",
    "FrictionModel",
    "InputError",
    "Motion",
    "Motor",
    "Plant",
    "Recording",
    "Session",
    "Trajectory",
    "__version__",
    "diagnose",
    "effects",
    "fit",
    "laws",
    "load",
    "simulate_ensemble",
    "stream",
]

# Imported on first use, so that `import stiction` costs little more than numpy.
_LAZY = {
    "Diagnosis": "diagnosis",
    "Ensemble": "ensemble",
    "EnsembleRun": "ensemble",
    "FitResult": "fitting",
    "Plant": "plant",
    "Recording": "recording",
    "Session": "session",
    "diagnose": "diagnosis",
    "effects": "catalogue",
    "fit": "fitting",
    "laws": "catalogue",
    "load": "session",
    "simulate_ensemble": "ensemble",
    "stream": "streaming",
}


def __getattr__(name: str) -> Any:
    if name in _LAZY:
        value = getattr(import_module(f".{_LAZY[name]}", __name__), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
