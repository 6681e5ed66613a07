"""Pieces of the sentences that errors and notes are made of."""

from __future__ import annotations

import difflib
import re
import unicodedata
from collections.abc import Iterable, Sequence
from pathlib import PurePath

# Below this similarity a suggestion misleads more often than it helps.
_ALIKE = 0.55
# A shorter part of a name is a part of many.
_A_PART = 4
# A longer list than this hides what the reader looks for.
_LISTED = 24

_LONGEST = 4000

_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")

NO_POSITION = (
    "there is no measured position to compare with; name its column under [columns], as in "
    'position = "...", or call it position_rad or position_m'
)
"""Of a recording without one, where a model is compared with it."""


def commas(words: Iterable[str]) -> str:
    """Words joined by commas, at most 24 of them, or "nothing"."""
    all_words = list(words)
    text = ", ".join(all_words[:_LISTED])
    if len(all_words) > _LISTED:
        text += f" and {len(all_words) - _LISTED} more"
    return text or "nothing"


def join_words(words: Sequence[str], last: str = "and") -> str:
    """``"a"``, ``"a and b"``, ``"a, b and c"``."""
    if len(words) < 2:
        return "".join(words)
    return f"{', '.join(words[:-1])} {last} {words[-1]}"


def printable(text: str) -> str:
    """Foreign text, with what no terminal and no file can show escaped.

    Control characters would act on the terminal that a sentence is shown on, and halves of a
    character (lone surrogates) cannot be written at all.
    """
    if text.isprintable():
        return text
    return "".join(
        letter.encode("unicode_escape").decode()
        if unicodedata.category(letter) in ("Cc", "Cs") and letter != "\t"
        else letter
        for letter in text
    )


def sentence(text: str) -> str:
    """A sentence that holds foreign text: printable, and short enough to be read.

    What it begins and ends with is kept: where the fault is, and what to do. Where in memory an
    object lies, as some show it, is left out: that says nothing, and differs from run to run.
    """
    # Cut again, for what is escaped is longer.
    return _cut(printable(_ADDRESS.sub("", _cut(text))))


def _cut(text: str) -> str:
    if len(text) <= _LONGEST:
        return text
    return f"{text[: _LONGEST // 2]} ... {text[-_LONGEST // 4 :]}"


def nearest(word: object, words: Iterable[str]) -> str | None:
    """The one of ``words`` that looks most like ``word``, whatever the case, or None."""
    # Whatever was given in the place of a word, nothing is like it.
    if not isinstance(word, str):
        return None
    by_fold: dict[str, str] = {}
    for candidate in words:
        by_fold.setdefault(candidate.casefold(), candidate)
    folded = word.casefold()
    hits = difflib.get_close_matches(folded, by_fold, n=1, cutoff=_ALIKE)
    if not hits and len(folded) >= _A_PART:
        # "bias" is a word of torque_bias alone.
        hits = [each for each in by_fold if folded in each.split("_")]
    return by_fold[hits[0]] if len(hits) == 1 else None


def nearest_file(name: str, names: Iterable[str]) -> str | None:
    """The file whose name is near, whatever it ends in: of files that end alike all are near."""
    ending = PurePath(name).suffix
    by_stem: dict[str, str] = {}
    for each in sorted(names, key=lambda each: PurePath(each).suffix != ending):
        by_stem.setdefault(PurePath(each).stem, each)
    near = nearest(PurePath(name).stem, by_stem)
    return None if near is None else by_stem[near]


def did_you_mean(word: object, words: Iterable[str]) -> str:
    """``" (did you mean 'x'?)"``, or nothing where no word is near."""
    near = nearest(word, words)
    return f" (did you mean '{near}'?)" if near is not None else ""


def plural(number: int, singular: str, plural: str | None = None) -> str:
    """``"1 row"``, ``"3 rows"``."""
    return f"{number} {singular if number == 1 else plural or singular + 's'}"
