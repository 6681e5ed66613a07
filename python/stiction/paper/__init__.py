"""The experiments of the paper, ready to run.

C. Hsieh and Y.-C. Pan, "Dynamic behavior and modelling of the pre-sliding static friction",
Wear 242 (2000) 1-17. Every function runs one experiment on the illustrative rig, or on a rig of
yours, and returns what was recorded together with the numbers that an experimenter reads off.

>>> from stiction import paper
>>> run = paper.experiment_1()
>>> round(run.numbers["torque at cut 1"].value, 3)
0.215
"""

from __future__ import annotations

from .dynamic import (
    PulseTrains,
    RampAndCut,
    RampAndHold,
    experiment_1,
    experiment_2,
    experiment_3,
)
from .estimate import Estimate, Estimated, Recorded, estimate
from .local import LocalVariation, local_variation
from .loops import LoopAreas, loop_areas
from .mechanisms import (
    LoopStudy,
    ball_screw,
    bearing_loops,
    metal_contact,
    nanometre_loops,
)
from .result import MotionResult, Number, Result
from .rig import (
    ARC_SECOND,
    COARSE_COUNT,
    FINE_COUNT,
    ILLUSTRATIVE_RIG,
    RigLike,
    illustrative_friction,
    illustrative_motor,
)
from .static import (
    STATIC_CASES,
    DahlTest,
    HardeningCycles,
    NestedLoops,
    StaticCase,
    StaticTest,
    dahl_on_static_1,
    hardening_cycles,
    nested_loops,
    static_test,
)
from .stick_slip import SLIDING, StickSlip, stick_slip

__all__ = [
    "ARC_SECOND",
    "COARSE_COUNT",
    "FINE_COUNT",
    "ILLUSTRATIVE_RIG",
    "SLIDING",
    "STATIC_CASES",
    "DahlTest",
    "Estimate",
    "Estimated",
    "HardeningCycles",
    "LocalVariation",
    "LoopAreas",
    "LoopStudy",
    "MotionResult",
    "NestedLoops",
    "Number",
    "PulseTrains",
    "RampAndCut",
    "RampAndHold",
    "Recorded",
    "Result",
    "RigLike",
    "StaticCase",
    "StaticTest",
    "StickSlip",
    "ball_screw",
    "bearing_loops",
    "dahl_on_static_1",
    "estimate",
    "experiment_1",
    "experiment_2",
    "experiment_3",
    "hardening_cycles",
    "illustrative_friction",
    "illustrative_motor",
    "local_variation",
    "loop_areas",
    "metal_contact",
    "nanometre_loops",
    "nested_loops",
    "static_test",
    "stick_slip",
]
