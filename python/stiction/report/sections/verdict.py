"""The first screen: what was found, and what it is worth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from ..._support.numbers import digits, percent, percent_between
from ..._support.scale import scale_of
from ...residual.compared import comparison_of
from ..titles import headline
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.data.gain import Gain
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["build"]

ALIKE: Final = 0.005
"""Noise before and after the search is told as one where it differs by less."""


def build(diagnosis: Diagnosis, drawings: Drawings) -> Section:
    """Verdict, gain with its interval, and the picture before and after."""
    faults = [
        check
        for check in diagnosis.data.get("checks", ())
        if diagnosis.verdict == "data_fault" and check["verdict"] == "fault"
    ]
    content = {
        "sentence": diagnosis.sentence,
        "verdict": diagnosis.verdict,
        "message": "" if diagnosis.success else diagnosis.message,
        "gain": None if diagnosis.gain is None else _gain(diagnosis.gain),
        "unmeasured": bool(diagnosis.effects) and diagnosis.gain is None,
        "errors": _errors(diagnosis),
        "faults": faults,
        "picture": drawings.get("before-after"),
    }
    return Section("verdict", headline(diagnosis), content)


def _gain(gain: Gain) -> dict[str, Any]:
    low, high = gain.ci95
    # A bar from no gain to all of it; further to the left where the interval goes there.
    least = max(min(0.0, low, gain.value), -1.0)
    span = 1.0 - least

    def along(share: float) -> float:
        return round(100.0 * (min(max(share, least), 1.0) - least) / span, 2)

    return {
        "value": percent(gain.value),
        "interval": percent_between(low, high),
        "bar": {"low": along(low), "high": along(high), "at": along(gain.value)},
        "zero": along(0.0),
        "uncertain": low <= 0.0,
        "worse": high < 0.0,
    }


def _errors(diagnosis: Diagnosis) -> dict[str, Any] | None:
    before, after = diagnosis.baseline, diagnosis.extended
    if before is None or after is None:
        return None
    tested = before.heldout_rms is not None
    one = before.heldout_rms if tested else before.train_rms
    two = after.heldout_rms if tested else after.train_rms
    relative = [
        model.heldout_relative if tested else model.train_relative for model in (before, after)
    ]
    scale, by = scale_of(diagnosis), comparison_of(diagnosis.plant)
    floor, earlier = after.noise_floor_rms, before.noise_floor_rms
    return {
        "rows": "on held-out rows" if tested else "on the rows fitted",
        "both": bool(diagnosis.effects),
        "before": digits(None if one is None else scale.factor * one),
        "after": scale.text(two),
        "relative": [percent(share, 2) for share in relative],
        "error": by.error[0].upper() + by.error[1:] if by.loop else "Effort not explained",
        "whole": by.whole,
        "floor": scale.text(floor),
        # What the baseline lacks may be as fast as noise, and counted as such before it was named.
        "earlier": digits(scale.factor * earlier) if abs(earlier - floor) > ALIKE * floor else "",
        "closed": None if diagnosis.gap_closed is None else percent(diagnosis.gap_closed, 0),
        # Noise is that of the rows fitted: recordings held out may be quieter, and nothing that
        # was called unexplained lies within it.
        "within": diagnosis.verdict != "unexplained" and after.train_rms <= floor,
    }
