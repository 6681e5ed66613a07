"""The sentence that a page is headed by, with effects as they are called in the field."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from .._support.numbers import NO_BREAK, percent, plain
from .._support.wording import join_words
from ..diagnosis.findings.presentation import PRESENTATIONS
from ..residual.compared import comparison_of

if TYPE_CHECKING:
    from ..diagnosis.findings.result import Diagnosis

__all__ = ["effect_title", "headline"]

VERDICTS: Final = {
    "data_fault": "The data cannot be used",
    "not_testable": "These data cannot be tested",
    "unexplained": "Something is missing that no known effect explains",
    "ambiguous": "Something is missing, and these data leave more than one name for it",
    "nothing_missing": "Nothing is missing from the simulation",
}
INTERRUPTED: Final = "Interrupted before anything was named"
NAMED_IN_PART: Final = "The simulation lacks {}, and something that has no name"
UNCONFIRMED: Final = "Something is missing, and what was named does not help on held-out rows"
LAW: Final = "The friction law of the simulation lacks something"
LAW_AND_EFFECTS: Final = f"{LAW}, and effects beside it may only stand for that"
"""Where another law explains more than what was named the sentence begins with the law as well."""
UNSURE: Final = "Something is missing, and not every name for it is sure"
MISSING: Final = "Missing: {}"
OR: Final = "Missing: {} or {}, which these data do not tell apart"
MOST: Final = 0.99
"""However often names were right, a title does not say 100 %."""
FINE: Final = 0.1
"""Shares below this have one more digit."""


def effect_title(name: str) -> str:
    """An effect as an engineer would call it; an unknown one by its own words."""
    entry = PRESENTATIONS.get(name)
    return plain(name) if entry is None or not entry.title else entry.title


def headline(diagnosis: Diagnosis) -> str:
    """What was found, and what became of the error, as the title of a page."""
    found = _found(diagnosis)
    # What is doubtful is not followed by a number that looks like a proof.
    sure = found.startswith("Missing") or diagnosis.verdict == "nothing_missing"
    return f"{found}. {_error(diagnosis)}" if sure and _error(diagnosis) else found


def _found(diagnosis: Diagnosis) -> str:
    if not diagnosis.success and not diagnosis.effects:
        return INTERRUPTED
    if diagnosis.better_law:
        return LAW_AND_EFFECTS if diagnosis.effects else LAW
    if diagnosis.gain is not None and diagnosis.gain.value <= 0.0:
        return UNCONFIRMED
    if diagnosis.verdict == "unexplained" and diagnosis.effects:
        several = len(diagnosis.effects) > 1
        return NAMED_IN_PART.format("known effects" if several else "a known effect")
    alike = any(effect.look_alikes for effect in diagnosis.effects)
    if diagnosis.verdict == "ambiguous" and not alike:
        return UNSURE
    if diagnosis.verdict == "ambiguous" and len(diagnosis.effects) == 1:
        *others, last = (diagnosis.effects[0].name, *diagnosis.effects[0].look_alikes)
        return OR.format(", ".join(effect_title(each) for each in others), effect_title(last))
    if diagnosis.verdict == "missing_effect":
        names = join_words([effect_title(each.name) for each in diagnosis.effects])
        return MISSING.format(f"{names}{_probability(diagnosis)}")
    return VERDICTS[diagnosis.verdict]


def _probability(diagnosis: Diagnosis) -> str:
    """How often such names were right where the truth was known; "" where none was counted."""
    held = [effect.reliability for effect in diagnosis.effects]
    least = min((each.probability for each in held if each is not None and each.told), default=None)
    if least is None or None in held:
        return ""
    several = " of each" if len(held) > 1 else ""
    return f", {percent(min(least, MOST), 0)} sure{several}"


def _error(diagnosis: Diagnosis) -> str:
    """The residual as a share of what it is a part of, "" where it is not known."""
    models = (diagnosis.baseline, diagnosis.extended)
    if any(model is None for model in models):
        return ""
    held_out = [model.heldout_relative for model in models if model is not None]
    fitted = [model.train_relative for model in models if model is not None]
    tested = None not in held_out
    before, after = (
        percent(share, 2 if (share or 0.0) < FINE else 1)
        for share in (held_out if tested else fitted)
    )
    what = "Held-out error" if tested else "Error on the rows fitted"
    whole = comparison_of(diagnosis.plant).whole
    if not before or not after:
        return ""
    number = before.removesuffix(f"{NO_BREAK}%")
    return f"{what} {f'{number} → ' if diagnosis.effects else ''}{after} of {whole}"
