"""The model before and after: parameters and errors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..._support.numbers import percent, plain
from ..._support.scale import Scale, scale_of
from ...residual.compared import comparison_of
from .parameters import meanings_of, row
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ...diagnosis.records import ModelSummary
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """Parameters with intervals and errors; None where nothing was fitted."""
    before, after = diagnosis.baseline, diagnosis.extended
    if before is None or after is None:
        return None
    both, scale = bool(diagnosis.effects), scale_of(diagnosis)
    meanings = meanings_of(after.plant)
    paths = [*after.parameters, *(p for p in before.parameters if p not in after.parameters)]
    parameters = []
    for path in paths:
        rows = [
            row(
                path,
                model.parameters[path],
                meanings.get(path, ""),
                model.parameters,
            )
            if path in model.parameters
            else None
            for model in (before, after)
        ]
        shown = rows[1] or rows[0]
        assert shown is not None
        parameters.append({**shown, "before": rows[0], "after": rows[1]})
    content = {
        "both": both,
        "law": after.plant.friction.law,
        "effects": [plain(effect.name) for effect in after.plant.effects],
        "parameters": parameters,
        "errors": _errors(before, after, scale),
        "noise": scale.text(after.noise_floor_rms),
        "remarks": _remarks(before, after, both=both),
        "whole": comparison_of(after.plant).whole,
        "picture": drawings.get("errors"),
    }
    return Section("models", "The model before and after" if both else "The model", content)


def _errors(before: ModelSummary, after: ModelSummary, scale: Scale) -> list[dict[str, Any]]:
    rows = []
    for name, role, one, two, relative in (
        (
            "fitted",
            "train",
            before.train_rms,
            after.train_rms,
            (before.train_relative, after.train_relative),
        ),
        ("decided on", "select", before.select_rms, after.select_rms, (None, None)),
        (
            "held out",
            "test",
            before.heldout_rms,
            after.heldout_rms,
            (before.heldout_relative, after.heldout_relative),
        ),
    ):
        if one is None or two is None:
            continue
        rows.append(
            {
                "name": name,
                "role": role,
                "before": scale.text(one),
                "after": scale.text(two),
                "relative": [percent(share, 2) for share in relative],
            }
        )
    return rows


def _remarks(before: ModelSummary, after: ModelSummary, *, both: bool) -> list[dict[str, Any]]:
    groups = [("Before", before.remarks), ("After", after.remarks)] if both else [
        ("", after.remarks)
    ]  # fmt: skip
    return [{"name": name, "sentences": sentences} for name, sentences in groups if sentences]
