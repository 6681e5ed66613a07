"""The page of a robot: the arm as a row of joints, and whether recordings agree."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from .._support.atomic_files import write_text
from .._support.best_effort import Failure, attempt
from .._support.numbers import digits, percent
from .._support.wording import commas
from ..report import REPORT
from ..report.files import folder_error, make_folder
from .extended import extended_text

if TYPE_CHECKING:
    from .agreement import Agreement
    from .result import JointFindings, RobotDiagnosis

__all__ = ["write"]

_WORDS: Final = {
    "data_fault": "data cannot be used",
    "not_testable": "cannot be tested",
    "unexplained": "something without a name",
    "ambiguous": "a name, not sure",
    "missing_effect": "lacks an effect",
    "nothing_missing": "nothing missing",
}


def write(diagnosis: RobotDiagnosis, folder: Path) -> Path:
    """Write report.html, findings.json, robot.toml, and a folder for each joint.

    Parameters
    ----------
    diagnosis : RobotDiagnosis
    folder : Path

    Returns
    -------
    Path
        Of report.html.

    Raises
    ------
    InputError
        The folder cannot be made or written to.
    """
    folder = make_folder(folder)
    try:
        write_text(folder / "findings.json", diagnosis.to_json() + "\n")
        write_text(folder / "robot.toml", extended_text(diagnosis, folder))
        for joint in diagnosis.joints:
            joint.diagnosis.save(folder / joint.folder)
        page = attempt("the page", lambda: _rendered(diagnosis))
        write_text(folder / REPORT, _bare(diagnosis, page) if isinstance(page, Failure) else page)
    except OSError as error:
        raise folder_error(folder, "cannot be written to", error) from None
    return folder / REPORT


def _rendered(diagnosis: RobotDiagnosis) -> str:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from ..report.page import label_cells

    environment = Environment(
        loader=PackageLoader("stiction.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    arm = diagnosis.fit.arm
    rows = diagnosis.agreement
    page: str = environment.get_template("robot.html").render(
        diagnosis=diagnosis,
        robot=diagnosis.fit.session.robot,
        joints=[_joint(joint) for joint in diagnosis.joints],
        links=zip(diagnosis.fit.session.robot.names, _links(diagnosis), strict=True),
        base=arm.base,
        impossible=len(arm.impossible),
        cost=percent(arm.cost),
        payloads=[(f"{stated:g}", digits(own[0])) for stated, own in arm.payloads.items()],
        agreement=[_agreement(row) for row in rows],
        apart=sum(row.agrees is False for row in rows),
        compared=sum(row.agrees is not None for row in rows),
        report=REPORT,
    )
    return label_cells(page)


def _joint(joint: JointFindings) -> dict[str, Any]:
    found, errors, reduction = joint.diagnosis, joint.errors, joint.reduction
    floor = "" if found.extended is None else digits(found.extended.noise_floor_rms)
    return {
        "name": joint.name,
        "folder": joint.folder,
        "verdict": found.verdict,
        "words": _WORDS[found.verdict],
        "sentence": found.sentence,
        "names": [(cause.name, cause.decided) for cause in found.effects],
        "gain": "" if found.gain is None else percent(found.gain.value),
        "interval": ""
        if found.gain is None
        else f"{percent(found.gain.ci95[0])} to {percent(found.gain.ci95[1])}",
        "before": "" if errors is None else percent(errors[0]),
        "after": "" if errors is None else percent(errors[1]),
        "reduction": "" if reduction is None else percent(reduction),
        "left": "" if found.extended is None else digits(found.extended.heldout_rms or 0.0),
        "floor": floor,
        "unit": "" if found.extended is None else found.extended.unit,
    }


def _links(diagnosis: RobotDiagnosis) -> list[dict[str, str]]:
    arm = diagnosis.fit.arm
    return [
        {
            "viscous": digits(float(friction[0])),
            "coulomb": digits(float(friction[1])),
            "bias": digits(float(friction[2])),
            "by_load": digits(float(grows)),
            "rotor": digits(float(rotor)),
            "left": digits(float(left)),
        }
        for friction, grows, rotor, left in zip(
            arm.friction, arm.by_load, arm.rotors, arm.left, strict=True
        )
    ]


def _agreement(row: Agreement) -> dict[str, Any]:
    if row.agrees is None:
        told = "only one recording tells"
    elif row.agrees:
        told = "agree"
    else:
        told = f"differ: {row.reason}" if row.reason else "differ, and no reason is known"
    return {
        "joint": row.joint,
        "parameter": row.parameter,
        "unit": row.unit,
        "told": told,
        "values": [
            (
                value.recording,
                digits(value.value),
                f"{digits(value.ci95[0])} to {digits(value.ci95[1])}",
            )
            for value in row.values
        ],
    }


def _bare(diagnosis: RobotDiagnosis, failure: Failure) -> str:
    names = commas(joint.folder for joint in diagnosis.joints)
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>stiction diagnosis'
        f"</title></head><body><h1>stiction diagnosis</h1><p>{escape(diagnosis.sentence)}</p>"
        f'<p role="note">{escape(failure.sentence)}</p><p>All numbers are in '
        f'<a href="findings.json">findings.json</a>; the joints in {escape(names)}.</p>'
        "</body></html>\n"
    )
