"""What was selected, and how a name is taken back."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from ...catalogue import EffectRecord
from ..defaults import SMALLEST
from ..records import CandidateRow
from ..screening.model import Model
from .choose import Choice

if TYPE_CHECKING:
    from .laws import Rival

__all__ = ["Search"]


@dataclass
class Search:
    """What a search for effects found, and what is left of it.

    Attributes
    ----------
    models : list of Model
        The baseline, then the model after each accepted effect.
    choices : list of Choice
        One for each accepted effect.
    rows : dict of str to CandidateRow
        Every effect that was looked at.
    blind : list of EffectRecord
        Effects that these data could not show.
    imitated : float
        Held-out gain of the best of those that were refused last because they imitate something
        else, or because the motion comes no nearer: so much is left that has no name.
    unseen : dict of str to float
        Effects of which what was fitted leaves no doubt and what decides tells nothing, with the
        share that they explain of what is left there; likeliest first.
    spread : bool
        Whether the last round refused a limit that helps, for where or how unevenly it does so.
    rests : list of (str, Model)
        Effects that may be what the form of a named one leaves, each with the model that has it.
    smallest : float
        Share of the friction that a cause has to contribute to be worth a name.
    interrupted : bool
    lesser : list of (Model, str, Model)
        Models, an effect of each, and the model fitted without it.
    rivals : list of (Model, Model, Rival)
        Other laws that were compared, each with the baseline and the last model then.
    """

    models: list[Model]
    choices: list[Choice] = field(default_factory=list)
    rows: dict[str, CandidateRow] = field(default_factory=dict)
    blind: list[EffectRecord] = field(default_factory=list)
    imitated: float = 0.0
    unseen: dict[str, float] = field(default_factory=dict)
    spread: bool = False
    tried: list[Model] = field(default_factory=list)
    rests: list[tuple[str, Model]] = field(default_factory=list)
    smallest: float = SMALLEST
    interrupted: bool = False
    lesser: list[tuple[Model, str, Model]] = field(default_factory=list)
    rivals: list[tuple[Model, Model, Rival]] = field(default_factory=list)

    @property
    def families(self) -> set[str]:
        """Families of the causes that are named."""
        return {choice.winner.candidate.record.family for choice in self.choices}

    def take_back(self, reason: str) -> None:
        """Takes the last cause back while the search goes on."""
        less = self.without_last(reason)
        self.models, self.choices, self.rows = less.models, less.choices, less.rows

    def without_last(self, reason: str) -> Search:
        """The same without the last cause, which is refused for this reason."""
        name = self.choices[-1].winner.name
        rows = dict(self.rows)
        if name in rows:
            rows[name] = replace(rows[name], reason=reason)
        choices = self.choices[:-1]
        models = self.models[: len(choices) + 1]
        # What was told beside it was told of another model.
        return replace(self, models=models, choices=choices, rows=rows, unseen={})
