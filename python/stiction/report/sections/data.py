"""The data: what was checked, which rows were used for what, and how noisy they are."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

from ..._support.numbers import duration, quantity
from ..._support.scale import effort_unit_of, scale_for
from ..._support.wording import plural
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]

PURPOSES: Final = (
    ("train", "fits the parameters"),
    ("select", "decides which effects are added"),
    ("test", "held out: opened once, after the last decision"),
)
SHOWN: Final = 6
"""Recordings that a line lists before it counts the others."""


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """Checks, split, residual, noise and hashes."""
    data = diagnosis.data
    checks = data.get("checks") or ()
    names = list(dict.fromkeys(check["recording"] for check in checks))
    hashes = list(data.get("hashes") or ())
    if len(names) != len(hashes):
        names = [f"recording {k + 1}" for k in range(len(hashes))]
    plant = diagnosis.plant
    # Faults that make the data useless stand on the first screen already.
    hidden = {"fine", "fault"} if diagnosis.verdict == "data_fault" else {"fine"}
    content = {
        "remarkable": _grouped([c for c in checks if c["verdict"] not in hidden]),
        "above": diagnosis.verdict == "data_fault" and any(c["verdict"] == "fault" for c in checks),
        "fine": _grouped([check for check in checks if check["verdict"] == "fine"]),
        "passed": _passed(checks),
        "split": _split(data.get("split")),
        "residual": " ".join(filter(None, (data.get("residual"), _through(data.get("through"))))),
        "noise": [
            _noise(entry, plant.position_unit, effort_unit_of(diagnosis)) for entry in data["noise"]
        ]
        if data.get("noise")
        else [],
        "hashes": list(zip(names, hashes, strict=True)),
    }
    return Section("data", "The data", content) if any(content.values()) else None


def _passed(checks: Sequence[Mapping[str, str]]) -> str:
    if not checks:
        return ""
    fine = sum(check["verdict"] == "fine" for check in checks)
    if fine == len(checks):
        return f"All {plural(fine, 'check')} passed."
    return f"{fine} of {plural(len(checks), 'check')} passed."


def _grouped(checks: Sequence[Mapping[str, str]]) -> list[dict[str, Any]]:
    """Checks that say the same of several recordings, together; faults first."""
    groups: dict[tuple[str, ...], list[dict[str, str]]] = {}
    for check in checks:
        key = (check["name"], check["verdict"], check["means"], check["try"])
        groups.setdefault(key, []).append({"recording": check["recording"], "what": check["what"]})
    rows = [
        {"name": name, "verdict": verdict, "means": means, "try": remedy, "found": found}
        for (name, verdict, means, remedy), found in groups.items()
    ]
    return sorted(rows, key=lambda row: row["verdict"] != "fault")


def _split(split: Mapping[str, Any] | None) -> dict[str, Any] | None:
    if not split:
        return None
    roles = []
    for role, purpose in PURPOSES:
        parts = split.get(role) or ()
        if not parts:
            folds = split.get("folds") or ()
            if role == "select" and folds:
                what = f"{plural(len(folds), 'fold')} over train, each left out in turn"
                roles.append({"role": role, "purpose": purpose, "what": what, "lasting": ""})
            continue
        lasting = sum(part["seconds"][1] - part["seconds"][0] for part in parts)
        roles.append(
            {
                "role": role,
                "purpose": purpose,
                "what": _pieces([part["name"] for part in parts]),
                "lasting": duration(lasting),
            }
        )
    return {"rules": list(split.get("rules") or ()), "roles": roles}


def _through(through: Mapping[str, Any] | None) -> str:
    """Kernel or horizon that was chosen, and by how much the input is stamped early."""
    if not through:
        return ""
    told = []
    if through.get("support"):
        told.append(
            f"The kernel is {scale_for([through['support']], 's').text(through['support'])} wide."
        )
    if through.get("horizon"):
        horizon = scale_for([through["horizon"]], "s").text(through["horizon"])
        told.append(f"Each simulation lasts {horizon}.")
    before, after = through.get("timing_s") or (0.0, 0.0)
    if before or after:
        told.append(
            f"By the fit the time stamps of the input are {_too(before)} before and {_too(after)} "
            "after what was found is added."
        )
    return " ".join(told)


def _too(early: float) -> str:
    """By how much stamps are early, s, in words."""
    way = "early" if early > 0.0 else "late"
    return f"{1e3 * abs(early):.3g}\N{NO-BREAK SPACE}ms {way}" if early else "right"


def _pieces(names: Sequence[str]) -> str:
    pieces = Counter(names)
    words = [
        name if number == 1 else f"{number} blocks of {name}" for name, number in pieces.items()
    ]
    more = len(words) - SHOWN
    return ", ".join(words[:SHOWN]) + (f" and {plural(more, 'other')}" if more > 0 else "")


def _noise(entry: Mapping[str, Any], position: str, effort: str) -> dict[str, str]:
    count, noise = entry["count"], entry["effort"]
    return {
        "recording": entry["recording"],
        "position": quantity(entry["position"], position, 2) if entry["position"] else "none seen",
        "count": quantity(count, position, 3) if count else "none seen",
        "effort": scale_for([noise], effort).text(noise, 2) if noise else "none seen",
    }
