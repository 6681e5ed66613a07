"""Simulates machines that stick, creep and slip, and shows what a simulation gets wrong.

>>> import stiction as st
>>> motor = st.Motor(inertia=0.0076, friction=st.FrictionModel("hsieh_pan"))
>>> position, velocity = motor.step(0.2, 1e-4)
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._support.lazy import lazy
from .errors import InputError

if TYPE_CHECKING:
    from ._native import FrictionModel, Motion, __version__
    from .catalogue import effects, laws
    from .diagnosis import Diagnosis, diagnose
    from .ensemble import Ensemble, EnsembleRun, simulate_ensemble
    from .fitting import CurveFit, FitResult, fit, fit_curve
    from .loading import load
    from .motor import Motor
    from .plant import Plant
    from .recording import Recording
    from .session import Session
    from .streaming import stream
    from .trajectory import Trajectory

__all__ = [
    "CurveFit",
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
    "fit_curve",
    "laws",
    "load",
    "simulate_ensemble",
    "stream",
]

# Imported on first use: the command line hears Ctrl-C before numpy is there.
_LAZY = {
    "CurveFit": "fitting",
    "Diagnosis": "diagnosis",
    "Ensemble": "ensemble",
    "EnsembleRun": "ensemble",
    "FitResult": "fitting",
    "FrictionModel": "friction_model",
    "InputError": "errors",
    "Motion": "_native",
    "Motor": "motor",
    "Plant": "plant",
    "Recording": "recording",
    "Session": "session",
    "Trajectory": "trajectory",
    "__version__": "_native",
    "diagnose": "diagnosis",
    "effects": "catalogue",
    "fit": "fitting",
    "fit_curve": "fitting",
    "laws": "catalogue",
    "load": "loading",
    "simulate_ensemble": "ensemble",
    "stream": "streaming",
}


__getattr__, __dir__ = lazy(__name__, _LAZY)
