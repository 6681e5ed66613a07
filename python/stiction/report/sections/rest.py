"""What is left when everything that has a name is added."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..._support.numbers import percent
from ..._support.scale import scale_of
from ...diagnosis.phrases import THE_LAW
from ...residual.compared import comparison_of
from ..views import hint
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section | None:
    """The residual in every coordinate; None where nothing was fitted."""
    pictures = diagnosis.pictures
    if pictures is None and not diagnosis.unexplained:
        return None
    before = {} if pictures is None else {v.coordinate.name: v for v in pictures.before.views}
    views = () if pictures is None else pictures.after.views
    limits = {view.coordinate.name: max(view.threshold, 0.0) for view in views}
    left = [
        {
            "coordinate": each.coordinate,
            "share": percent(each.share),
            "limit": percent(limits.get(each.coordinate)),
            "hint": hint(each.coordinate, diagnosis.plant),
        }
        for each in diagnosis.unexplained
        # What the stated law lacked is no rest beside the one that has taken its place.
        if not (diagnosis.restated and each.coordinate == THE_LAW)
    ]
    rows = [
        {
            "coordinate": view.coordinate.name,
            "before": percent(max(before.get(view.coordinate.name, view).share, 0.0)),
            "after": percent(max(view.share, 0.0)),
            "limit": percent(max(view.threshold, 0.0)),
            "flagged": view.is_flagged(),
        }
        for view in views
    ]
    content = {
        "left": left,
        "rows": rows,
        "small": any(view.is_flagged(0.0) for view in views),
        "both": bool(diagnosis.effects),
        "level": _level(diagnosis),
        "ceiling": _ceiling(diagnosis),
        "picture": drawings.get("coordinates"),
    }
    return Section("rest", "What is left", content)


def _ceiling(diagnosis: Diagnosis) -> str:
    """What repeats tell of how much could be explained."""
    if diagnosis.ceiling is None:
        return ""
    told = diagnosis.ceiling.words(bool(diagnosis.effects))
    return f"{told[0].upper()}{told[1:]} (rms, share of {comparison_of(diagnosis.plant).whole})."


def _level(diagnosis: Diagnosis) -> dict[str, Any] | None:
    """How large the rest is beside the noise."""
    model = diagnosis.extended
    if model is None:
        return None
    held_out = model.heldout_rms is not None
    rms = model.heldout_rms if model.heldout_rms is not None else model.train_rms
    noise = model.noise_floor_rms
    share = (noise / model.train_rms) ** 2 if model.train_rms > 0.0 else 1.0
    return {
        "rms": scale_of(diagnosis).text(rms),
        "noise": scale_of(diagnosis).text(noise),
        "rows": "on held-out rows" if held_out else "on the rows fitted",
        "where": "on the rows fitted " if held_out else "",
        "share": percent(share, 0) if share < 0.995 else "",
    }
