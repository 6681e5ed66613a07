"""Real records of a diagnosis from few arguments.

What a test does not state is as a small session of a real machine has it. A record whose numbers
are found by minutes of work takes them as stated: it is of the class that the product uses, and all
else that is asked of it the product computes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, fields, replace
from functools import cache, cached_property
from typing import Any

import numpy as np

import stiction as st
from stiction.catalogue import EffectRecord
from stiction.diagnosis.adequacy.coordinates import COORDINATES, UNJUDGED, Look
from stiction.diagnosis.adequacy.view import View
from stiction.diagnosis.data.contact import Slides
from stiction.diagnosis.data.evidence import Cells, Evidence
from stiction.diagnosis.records import Cause
from stiction.diagnosis.screening.candidates import Candidate, Scales, candidates
from stiction.diagnosis.screening.model import Model, fit_model
from stiction.diagnosis.screening.screen import Score
from stiction.diagnosis.screening.signatures import Signatures
from stiction.diagnosis.selection.choose import Choice
from stiction.diagnosis.selection.decide import Trial
from stiction.diagnosis.selection.search import Search
from stiction.diagnosis.selection.trials import Screening
from stiction.fitting.forms import KERNELS, Through
from stiction.fitting.minimise import Solution
from stiction.fitting.result import FitParameter, FitResult
from stiction.fitting.rows import Nuisances, Rows
from stiction.fitting.start import free_paths
from stiction.fitting.variables import Variables
from stiction.residual.weak_form import WeakForm

DT = 4e-3
EFFECTS = {record.name: record for record in st.effects()}
SCALES = Scales(
    (0.1, 10.0),
    tuple(float(k) for k in range(1, 11)),
    True,
    dict.fromkeys(("presliding", "resting", "loading", "session", "path"), 1.0),
)


def plant(**tables: Any) -> st.Plant:
    """A dry contact on a known inertia; tables of a plant file in place of its own."""
    known: dict[str, Any] = {
        "drive": {"input": "torque_nm"},
        "body": {"inertia": 0.006},
        "friction": {"law": "coulomb", "coulomb": 0.2, "viscous": 0.02},
    }
    return st.Plant.from_dict({**known, **tables})


@cache
def recordings() -> tuple[st.Recording, ...]:
    """The machine moved by sines, one recording of each role."""
    source = np.random.default_rng(5)
    time = np.arange(1500) * DT
    found = []
    for role in ("train", "select", "test"):
        waves = [0.3 * np.sin(w * time + source.uniform(0.0, 6.0)) for w in (2.0, 5.3, 13.0)]
        effort = np.sum(waves, axis=0)
        moved = plant().motor().simulate(effort[:-1], DT).position
        noise = 0.004 * source.standard_normal(len(time))
        position = np.concatenate([[0.0], moved])
        found.append(st.Recording(time, effort + noise, position, role=role))
    return tuple(found)


@cache
def _session(through: Through) -> Evidence:
    return Evidence(plant(), recordings(), through=through)


def evidence(*, simulated: bool = False, **stated: Any) -> Evidence:
    """The session of ``recordings``, with other attributes where they are stated."""
    found = copy(_session(Through(horizon=0.3) if simulated else KERNELS))
    for name, value in stated.items():
        if name not in vars(found):
            raise AttributeError(f"no session has {name}")
        setattr(found, name, value)
    return found


def cells(block: Any, recording: Any = None, kind: Any = None, number: int = 1) -> Cells:
    """Rows of these blocks; of one recording and one kind unless stated otherwise."""
    none = np.zeros(len(block), dtype=int)
    kinds = tuple(f"kind {k + 1}" for k in range(number))
    return Cells(
        np.asarray(block),
        none if recording is None else recording,
        none if kind is None else kind,
        kinds,
    )


def solution(fitted: st.Plant, paths: Sequence[str] | None = None, **stated: Any) -> Solution:
    """Where a fit ended that began there; ``paths`` are what it varied, all by default."""
    own = free_paths(fitted) if paths is None else list(paths)
    variables = Variables.of(fitted, own)
    vector = variables.vector(np.array([fitted.parameters[path].value for path in own]))
    known: dict[str, Any] = {"message": "", "evaluations": 1, "power": 1.0}
    known |= {"success": True, "interrupted": False, "nuisances": Nuisances()}
    return Solution(fitted, variables, vector, vector, **{**known, **stated})


def rows(position: Any, counted: Callable[[Any], Any], *, index: int = 0) -> Rows:
    """A recording of 1 ms that moves so, and which of its rows count by where the machine is."""
    time = np.arange(len(position)) * 1e-3
    form = WeakForm(plant(), st.Recording(time, np.zeros(len(time)), position))
    return Rows(plant(), form, index, counted(form.mean(form.position[1:])))


def look(**stated: Any) -> Look:
    """What rows are looked at by; 0 where nothing is stated."""
    none = np.zeros(len(next(iter(stated.values()))))
    known = {each.name: none for each in fields(Look)}
    slides = Slides(**{each.name: none for each in fields(Slides)})
    return Look(**{**known, "slides": slides, **stated})


Strength = float | Mapping[str, float]


@dataclass(frozen=True)
class StatedModel(Model):
    """A model of which it is stated how surely the gains of its effects are known.

    Attributes
    ----------
    strengths : float or Mapping of str to float
        Of every effect, or by name.
    surely : bool
        Whether they differ from 0.
    """

    strengths: Strength = 9.0
    surely: bool = True

    def strength(self, candidate: Candidate) -> float:
        """As it is stated."""
        own = self.strengths
        return own if isinstance(own, (int, float)) else own[candidate.name]

    def knows(self, candidate: Candidate, *, whatever_shape: bool) -> bool:
        """As it is stated."""
        return self.surely


def model(
    session: Evidence | None = None,
    fitted: st.Plant | None = None,
    *,
    name: str = "",
    strength: Strength = 9.0,
    surely: bool = True,
    paths: Sequence[str] | None = None,
    **found: Any,
) -> StatedModel:
    """A fitted plant; ``found`` are numbers that a model computes once, as ``blocks``.

    ``name`` is what `KnownRefits` knows it by.
    """
    own = StatedModel(
        evidence() if session is None else session,
        solution(plant() if fitted is None else fitted, paths, message=name),
        strengths=strength,
        surely=surely,
    )
    for each, value in {"nuisances": Nuisances(), **found}.items():
        if not isinstance(getattr(Model, each, None), cached_property):
            raise AttributeError(f"no model computes {each}")
        own.__dict__[each] = value
    return own


def effect(name: str, *, parameters: int = 1, **stated: Any) -> EffectRecord:
    """The record of an effect: of the catalogue, or of a constant effort by another name.

    ``parameters`` is the number of gains of the latter.
    """
    if name in EFFECTS:
        return replace(EFFECTS[name], **stated)
    constant = EFFECTS["torque_bias"]
    gains = tuple(f"gain {k + 1}" for k in range(parameters))
    bounds = tuple(replace(constant.parameters[0], name=gain) for gain in gains)
    own = {"name": name, "family": name, "gains": gains, "parameters": bounds, "look_alikes": ()}
    return replace(constant, **{**own, **stated})


def candidate(name: str, *, parameters: int = 1, **stated: Any) -> Candidate:
    """An effect at the first point of the grid of its shapes."""
    record = effect(name, parameters=parameters, **stated)
    return candidates(record, SCALES)[0] if name in EFFECTS else Candidate(record, {}, ())


def score(
    of: Candidate | str,
    value: float = 0.3,
    *,
    threshold: float = 0.05,
    heldout: float = 0.2,
    left: float = 1.0,
    visible: float = 1.0,
    contributed: Any = (1.0, 0.0),
) -> Score:
    """What a candidate would explain; far more than noise unless stated otherwise."""
    own = candidate(of) if isinstance(of, str) else of
    gains = np.ones(len(own.gains))
    return Score(
        own, gains, value, threshold, heldout, left, visible, np.asarray(contributed, dtype=float)
    )


def trial(
    of: Score | Candidate | str,
    worth: float = 1.0,
    reason: str = "",
    *,
    refit: Model | None = None,
    gain: float = 0.2,
    z: float = 1.0,
    strength: float = 9.0,
    size: float = 0.1,
    **stated: Any,
) -> Trial:
    """A candidate that was refitted; it passes unless a reason is given."""
    own = of if isinstance(of, Score) else score(of)
    known = model(name=own.candidate.name) if refit is None else refit
    return Trial(own, known, gain, z, worth, strength, size, reason, **stated)


def choice(of: Trial | str, *rivals: Trial) -> Choice:
    """A cause that was accepted, and what else may be it."""
    return Choice(trial(of) if isinstance(of, str) else of, rivals)


def search(*names: Trial | str, models: Sequence[Model] | None = None, **stated: Any) -> Search:
    """What a search found: these causes, one after the other."""
    choices = [choice(each) for each in names]
    found = [model(name="base"), *(each.winner.model for each in choices)]
    return Search(list(found if models is None else models), choices, **stated)


def cause(name: str, family: str = "", **stated: Any) -> Cause:
    """A cause that is decided unless stated otherwise."""
    known: dict[str, Any] = {"decided": True, "look_alikes": (), "parameters": {}, "gain": None}
    known |= dict.fromkeys(("what", "means", "try_", "coordinate"), "")
    return Cause(name, family or name, **{**known, **stated})


def number(value: float = 1.0, *, ci95: tuple[float, float] | None = None, **stated: Any) -> Any:
    """A fitted parameter; its interval is a tenth of it about it unless stated otherwise."""
    low, high = ci95 or (0.9 * value, 1.1 * value)
    known: dict[str, Any] = {"stderr": (high - low) / 4.0, "unit": "", "at_bound": ""}
    return FitParameter(value=value, ci95=(low, high), start=value, **{**known, **stated})


def fitted(**numbers: FitParameter) -> FitResult:
    """What a fit says of a real session; of the effects of these names other numbers."""
    parameters = {f"effects.{name.replace('__', '.')}": each for name, each in numbers.items()}
    return replace(_fit(), parameters={**_fit().parameters, **parameters})


@cache
def _fit() -> FitResult:
    return fit_model(evidence(), plant()).fit_result


def view(name: str, share: float, *, threshold: float = 0.02, size: float = 0.01) -> View:
    """What a model leaves over a coordinate that is looked at."""
    known = {each.name: each for each in (*COORDINATES, *UNJUDGED)}
    flat = np.zeros(2)
    return View(known[name], flat, flat, flat, flat, share, threshold, size)


@dataclass(frozen=True)
class KnownRefits(Screening):
    """A screening whose scores and refits are known, by the name of the model they are asked of.

    Attributes
    ----------
    after : Mapping of str to sequence of Trial
    fits : callable, optional
        What a plant comes to that is fitted anew.
    refitted, begun : list of str
        Candidates that were refitted, and those that were begun where another one led.
    """

    after: Mapping[str, Sequence[Trial]] = field(default_factory=dict)
    fits: Callable[[st.Plant], Model] | None = None
    refitted: list[str] = field(default_factory=list)
    begun: list[str] = field(default_factory=list)

    def scores(self, model: Model) -> list[Score]:
        """Those of the trials."""
        return [each.score for each in self._trials(model)]

    def trial(self, base: Model, score: Score, others: Sequence[Trial] = ()) -> Trial:
        """The known one."""
        self.refitted.append(score.candidate.name)
        return next(t for t in self._trials(base) if t.name == score.candidate.name)

    def from_where(self, base: Model, score: Score, lead: Trial) -> None:
        """Nothing is left there."""
        self.begun.append(score.candidate.name)

    def contribution(self, score: Score, model: Model) -> Any:
        """What the score tells."""
        return score.signature

    def encompasses(self, one: Trial, other: Trial) -> bool:
        """No candidate is told from another."""
        return False

    def fit(self, plant: st.Plant, nuisances: Nuisances) -> Model:
        """The known one."""
        assert self.fits is not None
        return self.fits(plant)

    def _trials(self, model: Model) -> Sequence[Trial]:
        return self.after.get(model.solution.message, ())


def screening(
    after: Mapping[str, Sequence[Trial]] | None = None,
    *,
    session: Evidence | None = None,
    fits: Callable[[st.Plant], Model] | None = None,
) -> KnownRefits:
    """A screening with these refits after each model."""
    own = evidence() if session is None else session
    rows = len(own.fitted)
    empty = Signatures.from_columns([], np.zeros((rows, 0)), own.fitted)
    none, bias = np.zeros((int(own.fitted.sum()), 2)), np.zeros(rows)
    return KnownRefits(own, empty, none, bias, friction=1.0, after=after or {}, fits=fits)
