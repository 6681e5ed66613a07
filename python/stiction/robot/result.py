"""What the diagnosis of a robot returns: a diagnosis for each joint, and what they share."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Any, Final

from .._support import given
from .._support.wording import commas, plural
from ..diagnosis.findings.result import SCHEMA, Diagnosis
from ..diagnosis.records import Cause, Verdict
from .agreement import Agreement
from .fit import RobotFit

__all__ = ["JointFindings", "RobotDiagnosis"]

PRECEDENCE: Final[tuple[Verdict, ...]] = (
    "unexplained",
    "ambiguous",
    "missing_effect",
    "nothing_missing",
    "not_testable",
    "data_fault",
)
"""Of a robot's verdict: the first that a joint has. One that cannot be tested hides no other."""


@dataclass(frozen=True)
class JointFindings:
    """What was found of one joint.

    Attributes
    ----------
    name : str
    folder : str
        That its own page stands in, beside the robot's.
    diagnosis : Diagnosis
        Of the joint as a machine of one axis.
    """

    name: str
    folder: str
    diagnosis: Diagnosis

    @property
    def errors(self) -> tuple[float, float] | None:
        """Error of the torque on rows that test, before and after: a share of its 2-norm.

        Before: with viscous and Coulomb friction and an offset, beside the same rigid links.
        """
        before, after = self.diagnosis.baseline, self.diagnosis.extended
        if before is None or after is None:
            return None
        if before.heldout_relative is None or after.heldout_relative is None:
            return None
        return before.heldout_relative, after.heldout_relative

    @property
    def reduction(self) -> float | None:
        """Share of the error (rms) on rows that test that is gone."""
        errors = self.errors
        return None if errors is None or not errors[0] > 0.0 else 1.0 - errors[1] / errors[0]

    def to_dict(self) -> dict[str, Any]:
        """As an entry of ``joints``."""
        found, errors = self.diagnosis, self.errors
        floor = None if found.extended is None else found.extended.noise_floor_rms
        return {
            "name": self.name,
            "folder": self.folder,
            "verdict": found.verdict,
            "sentence": found.sentence,
            "effects": [cause.to_dict() for cause in found.effects],
            "gain": None if found.gain is None else found.gain.to_dict(),
            "gap_closed": found.gap_closed,
            "noise_floor_rms": floor,
            "unit": None if found.extended is None else found.extended.unit,
            "heldout_error": None
            if errors is None
            else {"before": errors[0], "after": errors[1], "reduction": self.reduction},
        }


@dataclass(frozen=True)
class RobotDiagnosis:
    """What a simulation of a robot is missing, joint by joint.

    Attributes
    ----------
    fit : RobotFit
        Links and plain friction.
    joints : tuple of JointFindings
        From the base on; those that were finished, after Ctrl-C.
    agreement : tuple of Agreement
        The same parameter from each recording.
    success : bool
        False where it was interrupted.
    version : str
        Of the package.
    seed : int
    seconds : float
    assumed : tuple of str
        What nobody has stated and was taken for granted, a sentence each.
    """

    fit: RobotFit
    joints: tuple[JointFindings, ...]
    agreement: tuple[Agreement, ...] = ()
    success: bool = True
    version: str = ""
    seed: int = 0
    seconds: float = field(default=0.0, compare=False)
    assumed: tuple[str, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """The first of the precedence that a joint has."""
        found = {joint.diagnosis.verdict for joint in self.joints}
        return next((verdict for verdict in PRECEDENCE if verdict in found), "not_testable")

    @property
    def sentence(self) -> str:
        """The same in words."""
        lacking = [joint for joint in self.joints if joint.diagnosis.effects]
        unsaid = [j.name for j in self.joints if j.diagnosis.verdict == "unexplained"]
        untested = [
            j.name for j in self.joints if j.diagnosis.verdict in ("not_testable", "data_fault")
        ]
        said = [f"{joint.name} lacks {_names_of(joint.diagnosis.effects)}" for joint in lacking]
        if not lacking and not unsaid:
            said = ["Nothing is missing in any joint that could be tested"]
        if unsaid:
            said.append(f"something without a name is left in {commas(unsaid)}")
        if untested:
            said.append(f"{commas(untested)} could not be tested")
        return "; ".join(said) + "."

    def to_dict(self) -> dict[str, Any]:
        """The content of findings.json."""
        return {
            "schema": SCHEMA,
            "verdict": self.verdict,
            "sentence": self.sentence,
            "effects": self._of_joints("effects"),
            "gain": None,
            "candidates": self._of_joints("candidates"),
            "laws": self._of_joints("laws"),
            "baseline": None,
            "extended": None,
            "unexplained": self._of_joints("unexplained"),
            "advice": self._of_joints("advice"),
            "data": {"split": self.fit.split.to_dict(), "complete": self.success},
            "joints": [joint.to_dict() for joint in self.joints],
            "links": self._links(),
            "agreement": [row.to_dict() for row in self.agreement],
            "assumed": list(self.assumed),
            "version": self.version,
            "seed": self.seed,
            "seconds": self.seconds,
        }

    def _of_joints(self, key: str) -> list[dict[str, Any]]:
        return [
            {"joint": joint.name, **entry}
            for joint in self.joints
            for entry in joint.diagnosis.to_dict()[key]
        ]

    def _links(self) -> dict[str, Any]:
        arm = self.fit.arm
        names = self.fit.session.robot.names
        plain = zip(names, arm.friction, arm.by_load, arm.rotors, arm.left, strict=True)
        return {
            "base_parameters": arm.base,
            "could_not_exist": len(arm.impossible),
            "cost_of_existing": arm.cost,
            "masses_kg": [float(mass) for mass in arm.links[::10]],
            "payloads": [
                {"stated_kg": stated, "fitted_kg": float(found[0])}
                for stated, found in arm.payloads.items()
            ],
            "plain": [
                {
                    "joint": name,
                    "viscous": float(friction[0]),
                    "coulomb": float(friction[1]),
                    "bias": float(friction[2]),
                    "by_load": float(grows),
                    "rotor_inertia": float(rotor),
                    "left_rms": float(left),
                }
                for name, friction, grows, rotor, left in plain
            ],
        }

    def to_json(self) -> str:
        """findings.json as text."""
        from .._support.json_text import json_of

        return json_of(self.to_dict())

    def save(self, folder: str | Path) -> Path:
        """Write report.html, findings.json, robot.toml and a folder for each joint.

        Parameters
        ----------
        folder : str or Path
            Made where it is not there; files of an earlier report in it are replaced.

        Returns
        -------
        Path
            Of report.html.

        Raises
        ------
        InputError
            The folder cannot be made or written to.
        """
        from .page import write

        return write(self, given.path(folder, "RobotDiagnosis.save"))

    def __str__(self) -> str:
        lines = [self.sentence, "", *self.assumed, *([""] if self.assumed else [])]
        width = max((len(joint.name) for joint in self.joints), default=0)
        lines += [f"{joint.name:<{width}}  {_told(joint)}" for joint in self.joints]
        apart = [row for row in self.agreement if row.agrees is False]
        if self.agreement:
            lines += ["", _agreed(len(self.agreement), apart)]
        return "\n".join(lines)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return "".join(f"<p>{escape(line)}</p>" for line in str(self).splitlines() if line)


def folder_names(joints: Sequence[str]) -> Mapping[str, str]:
    """A name for the folder of each joint: its own as far as a file system bears it."""
    found: dict[str, str] = {}
    for name in joints:
        plain = re.sub(r"[^A-Za-z0-9_.-]+", "-", name).strip(".") or "joint"
        taken = {other.casefold() for other in found.values()} | {"figures"}
        number, own = 1, plain
        while own.casefold() in taken:
            number += 1
            own = f"{plain}-{number}"
        found[name] = own
    return found


def _told(joint: JointFindings) -> str:
    found = joint.diagnosis
    unexplained = found.verdict == "unexplained"
    told = "unexplained remainder" if unexplained else found.verdict.replace("_", " ")
    if found.effects:
        told += f": {_names_of(found.effects)}"
    errors, reduction = joint.errors, joint.reduction
    if errors is None or reduction is None:
        return told
    told += f"; error of held-out torque {100 * errors[0]:.3g} %"
    if not found.effects and errors[0] == errors[1]:
        return told
    return f"{told} -> {100 * errors[1]:.3g} % ({100 * reduction:.3g} % less)"


def _agreed(number: int, apart: Sequence[Agreement]) -> str:
    if not apart:
        return f"{plural(number, 'parameter')} agree between recordings."
    unknown = sum(not row.reason for row in apart)
    reasons = f"for {unknown} of them the data show no reason" if unknown else "the page says why"
    verb = "differs" if len(apart) == 1 else "differ"
    return f"{len(apart)} of {plural(number, 'parameter')} {verb} between recordings; {reasons}."


def _names_of(causes: Sequence[Cause]) -> str:
    """Names, and which of them the data leave open."""
    return commas(f"{cause.name}{'' if cause.decided else ' (undecided)'}" for cause in causes)
