"""A search for effects beside a base: what is asked, what it was made with, and made again."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

from .._support.arrays import FloatArray
from .._support.progress import phase
from ..fitting.forms import residual_sentence
from ..fitting.noise import Noise
from .data.evidence import Evidence
from .findings.conclude import surrogates_of
from .findings.result import Diagnosis
from .screening.model import Known, Model
from .selection.rounds import search
from .selection.search import Search

__all__ = ["Asked", "Searched", "replay_base", "search_again"]

TRAIN_IS_FITTED: Final = (
    "Parameters are fitted to the rows of train alone; stiction fit takes those of select as well "
    "and may end at values a little different."
)
"""Where a fit of the same session and the base differ; everything else they do alike."""

_logger = logging.getLogger(__name__)


class Asked(NamedTuple):
    """What a diagnosis is to look for."""

    without: Sequence[str]
    """Effects that are not tried."""
    laws: Sequence[str]
    """Others to compare."""
    surrogates: int
    smallest: float
    alpha: float

    def search(
        self,
        evidence: Evidence,
        base: Model,
        null: FloatArray,
        earlier: Sequence[Known | Model] = (),
        stops: Callable[[Search], bool] | None = None,
    ) -> Search:
        """The search for effects beside a base, after an earlier one; see ``search``."""
        return search(
            evidence,
            base,
            null,
            without=self.without,
            smallest=self.smallest,
            alpha=self.alpha,
            earlier=earlier,
            stops=stops,
        )


class Searched(NamedTuple):
    """A search for effects, and what it was made with."""

    found: Diagnosis
    evidence: Evidence
    base: Model
    null: FloatArray
    noises: Mapping[int, Noise]
    selection: Search


def search_again(
    look: Searched,
    seen: tuple[Evidence, Model],
    *,
    asked: Asked,
    earlier: Sequence[Known | Model] = (),
) -> Searched | None:
    """The same search with another base; None after Ctrl-C: what was found is the best so far."""
    found, replays = replay_base(look.found, *seen, asked.surrogates)
    selection = None if replays is None else asked.search(*seen, replays[0], earlier)
    if replays is None or selection is None or selection.interrupted:
        look.selection.interrupted = True
        return None
    return Searched(found, *seen, *replays, selection)


def replay_base(
    found: Diagnosis, evidence: Evidence, base: Model, surrogates: int
) -> tuple[Diagnosis, tuple[FloatArray, Mapping[int, Noise]] | None]:
    """What is known with a base, and what noise would leave of it; None where Ctrl-C ended it."""
    dealt = evidence.split.to_dict()
    told = [TRAIN_IS_FITTED] if evidence.split.select else []
    dealt["rules"] = [*dealt["rules"], *told]
    data = {
        **found.data,
        "split": dealt,
        "residual": residual_sentence([rows.form for rows in evidence.shown], base.plant),
    }
    words = "\n".join([evidence.split.describe(), *told])
    found = replace(found, split=words, data=data)
    try:
        if base.solution.interrupted:
            raise KeyboardInterrupt
        phase(_logger, "replaying it with noise, %d times", surrogates)
        return found, surrogates_of(evidence, base, surrogates, found.seed)
    except KeyboardInterrupt:
        return found, None
