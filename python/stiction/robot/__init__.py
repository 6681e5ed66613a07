"""Robots: machines of many joints, whose rigid links a URDF describes."""

from __future__ import annotations

from .diagnose import diagnose_robot
from .fit import RobotFit, fit_robot
from .plan import plan_robot
from .result import JointFindings, RobotDiagnosis
from .robot import Joint, Robot
from .session import RobotSession, Run, load_session
from .signals import RobotPlan, RobotSignal

__all__ = [
    "Joint",
    "JointFindings",
    "Robot",
    "RobotDiagnosis",
    "RobotFit",
    "RobotPlan",
    "RobotSession",
    "RobotSignal",
    "Run",
    "diagnose_robot",
    "fit_robot",
    "load_session",
    "plan_robot",
]
