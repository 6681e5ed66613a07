"""What a diagnosis returns: verdict, causes, models before and after, gain, and what to do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..._support import given
from ..._support.frozen import Frozen, freeze
from ...plant import Plant
from ..data.gain import Gain
from ..records import Advice, CandidateRow, Cause, LawRow, ModelSummary, Unexplained, Verdict
from .bets import Bets

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ...plot import Panels
    from ..data.ceiling import Ceiling
    from .pictures import Pictures

__all__ = ["Diagnosis"]

SCHEMA = 1


@dataclass(frozen=True)
class Diagnosis:
    """What a simulation of a machine is missing, and what that is worth.

    Attributes
    ----------
    verdict : str
        data_fault, not_testable, unexplained, ambiguous, missing_effect or nothing_missing.
    sentence : str
        The same in words.
    effects : tuple of Cause
        In the order in which they were added, each beside those before it.
    gain : Gain or None
        All of them beside the baseline, over rows that nobody looked at before.
    candidates : tuple of CandidateRow
        Every effect that was tried, with its score, what noise reaches, and the outcome.
    laws : tuple of LawRow
        Other laws in place of the plant's own, where they were asked for.
    baseline, extended : ModelSummary or None
        None where nothing could be fitted.
    unexplained : tuple of Unexplained
        Coordinates in which more is left than noise explains, largest share first.
    advice : tuple of Advice
        What to record next, and what that tells apart.
    data : Mapping
        ``checks``, ``split``, ``hashes``, ``noise``, ``replicates``, and in a sentence which
        ``residual`` was used and why.
    plant : Plant
        Extended, complete, ready to simulate; as given where nothing could be fitted.
    success : bool
        False where it was interrupted: what is here is the best so far.
    message : str
        How it ended, in words.
    version : str
        Of the package.
    seed : int
        It was made with.
    seconds : float
        How long it took.
    split : str
        Which rows trained, decided and tested, in words; "" where nothing was split.
    ceiling : Ceiling or None
        How much of the error could be explained, where recordings were made twice.
    better_law : str
        Friction law that alone explains clearly more than what was named, "" where none does.
    smallest : float
        Share of the friction that an effect has to contribute (rms) to be worth a name.
    alpha : float
        Level of the screening for the whole session.
    evidence : Bets
        What each recording held out says of all causes together.
    pictures : Pictures or None
        What the figures are drawn from.
    """

    verdict: Verdict
    sentence: str
    plant: Plant
    effects: tuple[Cause, ...] = ()
    gain: Gain | None = None
    candidates: tuple[CandidateRow, ...] = ()
    laws: tuple[LawRow, ...] = ()
    baseline: ModelSummary | None = None
    extended: ModelSummary | None = None
    unexplained: tuple[Unexplained, ...] = ()
    advice: tuple[Advice, ...] = ()
    data: Mapping[str, Any] = field(default_factory=dict)
    success: bool = True
    message: str = "the diagnosis is complete"
    version: str = ""
    seed: int = 0
    seconds: float = 0.0
    split: str = field(default="", repr=False)
    ceiling: Ceiling | None = None
    better_law: str = ""
    smallest: float = 0.0
    alpha: float = 0.0
    evidence: Bets = field(default_factory=Bets)
    pictures: Pictures | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        freeze(self, Frozen, "data")

    @property
    def restated(self) -> bool:
        """Whether all but ``laws`` is told of the plant with the better law."""
        return bool(self.better_law) and self.plant.friction.law == self.better_law

    @property
    def gap_closed(self) -> float | None:
        """Share of the power beyond noise that the causes explain, over the rows fitted.

        None where nothing is named, or where the baseline leaves no more than noise.
        """
        before, after = self.baseline, self.extended
        if not self.effects or before is None or after is None:
            return None
        gap = before.train_rms**2 - after.noise_floor_rms**2
        if not gap > 0.0:
            return None
        return min((before.train_rms**2 - after.train_rms**2) / gap, 1.0)

    @property
    def schema(self) -> int:
        """Version of the form of findings.json."""
        return SCHEMA

    def to_dict(self) -> dict[str, Any]:
        """The content of findings.json."""
        return {
            "schema": self.schema,
            "verdict": self.verdict,
            "sentence": self.sentence,
            "effects": [cause.to_dict() for cause in self.effects],
            "gain": None if self.gain is None else self.gain.to_dict(),
            "gap_closed": self.gap_closed,
            "evidence": self.evidence.to_dict() if self.evidence.each else None,
            "candidates": [row.to_dict() for row in self.candidates],
            "laws": [row.to_dict() for row in self.laws],
            "better_law": self.better_law or None,
            "baseline": None if self.baseline is None else self.baseline.to_dict(),
            "extended": None if self.extended is None else self.extended.to_dict(),
            "unexplained": [left.to_dict() for left in self.unexplained],
            "advice": [each.to_dict() for each in self.advice],
            "data": {**self.data, "chosen": self._chosen, "complete": self.success},
            "version": self.version,
            "seed": self.seed,
            "smallest": self.smallest,
            "alpha": self.alpha,
            "seconds": self.seconds,
        }

    @property
    def _chosen(self) -> dict[str, float]:
        """Numbers of all causes that were not fitted, by path: with the others a cause is whole."""
        return {path: value for cause in self.effects for path, value in cause.chosen.items()}

    def to_json(self) -> str:
        """findings.json as text; null stands for an end of an interval that the data leave open."""
        from ..._support.json_text import json_of

        return json_of(self.to_dict())

    def save(self, folder: str | Path) -> Path:
        """Write report.html, findings.json, plant.toml, begins.toml and figures.

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
        from ...report import write

        return write(self, given.path(folder, "Diagnosis.save"))

    def plot(self, ax: Axes | Sequence[Axes] | None = None) -> Panels:
        """Measured effort and the residual before and after, on rows held out.

        Parameters
        ----------
        ax : matplotlib Axes, or a sequence of them, optional
            To draw into, a panel each in this order; those of a new figure without it.

        Returns
        -------
        Panels
            The axes, a tuple that a notebook shows as a figure; ``.figure`` is that.

        Raises
        ------
        InputError
            Nothing could be fitted, so there is nothing to draw. ``ax`` is something else than
            axes, or too many.
        """
        from .pictures import before_and_after

        return before_and_after(self, ax)

    def __str__(self) -> str:
        from .words import summary

        return summary(self)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        from ...notebook import friction_drawing, table

        head = ("cause", "effect", "gain on held-out rows", "95 %")
        rows = [(each.name, each.what, *_per_cent(each.gain)) for each in self.effects]
        models = [("before", self.baseline), ("after", self.extended)]
        errors = table(
            ("model", "law and effects", "error held out"),
            [
                (
                    name,
                    " + ".join((model.law, *model.effects)),
                    ""
                    if model.heldout_rms is None
                    else f"{model.heldout_rms:.4g} {model.unit}".removesuffix(" 1"),
                )
                for name, model in models
                if model is not None
            ],
        )
        assumed = () if self.baseline is None else self.baseline.assumed
        curves = friction_drawing([(name, m.plant, m.unit) for name, m in models if m is not None])
        return (
            f"<p><b>{escape(self.sentence)}</b></p>"
            f"{table(head, rows) if rows else ''}{errors}"
            f"{''.join(f'<p>{escape(line)}</p>' for line in assumed)}{curves}"
        )


def _per_cent(gain: Gain | None) -> tuple[str, str]:
    if gain is None:
        return "", ""
    low, high = gain.ci95
    return f"{100.0 * gain.value:.1f} %", f"{100.0 * low:.1f} to {100.0 * high:.1f} %"
