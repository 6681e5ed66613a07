"""The way of a diagnosis: checks, base, surrogates, selection, rest, gain, verdict."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from .. import __version__
from .._support import given
from .._support.arrays import FloatArray
from .._support.given import instance, share, whole
from .._support.keywords import explain_keywords
from .._support.products import on_one_thread
from .._support.progress import phase
from .._support.wording import plural
from .._support.workers import with_workers
from ..catalogue import effects
from ..errors import InputError, NotEnoughData
from ..fitting.noise import Noise
from ..plant import Plant
from ..recording import Check, Recording
from ..recording.checks import DOUBTED, without_failures
from ..recording.names import names_of
from ..recording.recording import recordings_of
from ..recording.session_clock import subset
from ..recording.usable import checks_of, usable
from ..session import Session, both_of
from .data.evidence import Evidence
from .defaults import ALPHA, SMALLEST, SURROGATES
from .findings.advice import advise
from .findings.conclude import Conclusion, base_alone
from .findings.result import Diagnosis
from .findings.verdict import all_blind
from .otherwise import look_otherwise
from .restated import diagnose_again_at_the_end, diagnose_again_early, is_outdone
from .screening.base import (
    fit_baseline,
    fit_joint_baseline,
    fit_simulated_baseline,
    fit_wider_baseline,
)
from .screening.candidates import excluded_names
from .screening.model import Known, Model
from .screening.sampling import (
    AsRead,
    fit_baseline_as_read,
    fit_baseline_read,
    reading_words,
)
from .searched import Asked, Searched, replay_base, search_again
from .selection.laws import law_names
from .selection.search import Search
from .selection.seconds import acts_for_seconds, holds_more, tried_names, with_rows_of

__all__ = ["diagnose"]

MOST_SURROGATES: Final = 1000
"""They are all kept; a threshold has settled long before."""

NOT_DRIVEN: Final = (
    "The data cannot be used: input is 0 in every row of all recordings, so that no effort is "
    "known to which anything could be compared; add a recording that is driven, or the column that "
    "drives."
)

LATE: Final = frozenset(record.name for record in effects() if record.late)
"""Effects by which an input acts later than its rows say."""

_Shot = tuple[Evidence, Model, list[Known]]
"""Windows, the base over them, and whence effects are begun as well."""

_logger = logging.getLogger(__name__)


@on_one_thread
@explain_keywords
def diagnose(
    plant: Plant | Session | None,
    session: Session | Sequence[Recording] | Recording | None = None,
    *,
    without: Sequence[str] = (),
    laws: Sequence[str] = (),
    surrogates: int = SURROGATES,
    smallest: float = SMALLEST,
    alpha: float = ALPHA,
    seed: int = 0,
    threads: int | None = None,
) -> Diagnosis:
    """Find out what a simulation of a machine is missing.

    The base is fitted to the rows of train, every effect of the catalogue is screened by its
    efficient score against surrogates of this very data set, the best are refitted and accepted on
    rows held out, until nothing passes. The gain is then measured once on rows that test.

    Parameters
    ----------
    plant : Plant, or Session, or None
        Naming the law is enough; a session alone, or None, takes the plant of the session.
    session : Session, sequence of Recording, or Recording
    without : sequence of str
        Effects that are not tried.
    laws : sequence of str
        Other laws to compare with the plant's, or ``("all",)``.
    surrogates : int
        Replays of the base with noise alone, from 4 to 1000.
    smallest : float
        Share of the friction, above 0 and below 1: what contributes less (rms) gets no name.
    alpha : float
        Level of the screening, above 0 and below 1: the probability that noise passes it in any
        form in a session that lacks nothing, within a few times as long as ``surrogates`` are a few
        dozen. Rows held out decide after it.
    seed : int
        Same data and seed, same findings, at any number of threads.
    threads : int, optional
        Recordings looked at side by side; as many as there are processors without it.

    Returns
    -------
    Diagnosis
        After Ctrl-C the best so far, with ``success`` False; a second one ends at once.

    Raises
    ------
    InputError
        An unknown effect or law, a number out of its bounds, no plant, no recordings, the same
        recording fitted and judged on.
    KeyboardInterrupt
        Ctrl-C before there is anything, or for the second time.
    """
    began = time.perf_counter()
    machine, session = both_of(plant, session, "diagnose")
    entire = _session(session)
    instance(machine, Plant, "diagnose: plant", "a Plant, as Plant.load returns it")
    surrogates = whole(surrogates, "surrogates", least=4, most=MOST_SURROGATES)
    smallest = share(smallest, "smallest")
    alpha = share(alpha, "alpha")
    seed = whole(seed, "seed", least=0)
    threads = None if threads is None else whole(threads, "threads", least=1)
    asked = Asked(
        without=excluded_names(_names("without", without)),
        laws=law_names(_names("laws", laws), machine.friction.law),
        surrogates=surrogates,
        smallest=smallest,
        alpha=alpha,
    )
    checks = checks_of(entire.recordings)
    data: dict[str, Any] = {
        "checks": [
            *({"recording": name, **c.to_dict()} for name, c in _repairs(entire)),
            *({"recording": name, **c.to_dict()} for name, c in checks),
        ],
        "split": None,
        "hashes": list(entire.hashes),
        "noise": [],
        "replicates": None,
        "residual": None,
        "input_ahead": 0.0,
    }
    found = Diagnosis(
        verdict="not_testable",
        sentence="",
        plant=machine,
        data=data,
        version=__version__,
        seed=seed,
        smallest=smallest,
        alpha=alpha,
    )
    usable, fault = _usable(checks, entire, machine)
    # What is missing, and whether anything is, hangs on it.
    doubt = next((f"{n}: {c.what}; {c.try_}." for n, c in checks if c.name == DOUBTED), "")
    if usable is None:
        found = replace(
            found, verdict="data_fault", sentence=fault, advice=advise((), (), (), checks, machine)
        )
    else:
        try:
            with with_workers(threads):
                found = _testable(found, usable, asked, checks)
            read = reading_words(found.data["input_ahead"])
            sentences = filter(None, (found.sentence, read, fault, doubt))
            found = replace(found, sentence=" ".join(sentences))
        except NotEnoughData as error:
            told = str(error)
            found = replace(found, sentence=f"These data cannot be tested: {told}.")
    return replace(found, seconds=time.perf_counter() - began)


def _names(argument: str, asked: Sequence[str]) -> Sequence[str]:
    if isinstance(asked, str):
        raise InputError(f'{argument} = "{asked}" is a word; give a sequence: ("{asked}",)')
    return given.names(asked, argument)


def _session(session: Session | Sequence[Recording] | Recording) -> Session:
    if isinstance(session, Session):
        return session
    recordings = recordings_of(session, "diagnose")
    if not recordings:
        raise InputError("session: there are no recordings to diagnose; give at least one")
    return Session(recordings)


def _repairs(session: Session) -> list[tuple[str, Check]]:
    """What was mended on reading."""
    means = "these rows were filled in from their neighbours"
    return [
        (name, Check("repair", "note", str(repair), means, ""))
        for name, recording in zip(names_of(list(session)), session, strict=True)
        for repair in recording.quality
    ]


def _usable(
    checks: Sequence[tuple[str, Check]], session: Session, plant: Plant
) -> tuple[Session | None, str]:
    """The recordings without a fault, None where too few are left, and in words what is wrong."""
    kept, told = usable(session.recordings, checks)
    if kept is None:
        return None, told
    recordings = without_failures(subset(session.recordings, kept))
    if not (plant.prescribed_motion or plant.hangs or any(map(_is_driven, recordings))):
        return None, NOT_DRIVEN
    places = {k: j for j, k in enumerate(kept)}
    repeats = {
        places[k]: places[of]
        for k, of in session.replicates.items()
        if k in places and of in places
    }
    return Session(recordings, session.plant, repeats), told


def _is_driven(recording: Recording) -> bool:
    """Whether anything that is known acts on the machine."""
    acted = (recording.input, recording.channels.get("load"))
    return any(values is not None and bool(np.any(values)) for values in acted)


def _testable(
    found: Diagnosis,
    session: Session,
    asked: Asked,
    checks: Sequence[tuple[str, Check]],
    *,
    restated: bool = False,
    ahead: float | None = None,
) -> Diagnosis:
    """The diagnosis of data that can be used; ``restated`` with another law than was stated.

    ``ahead`` is by how many samples the input is read ahead, 0 where it is taken as it stands in
    the recordings; as the base says without it.
    """
    number = plural(len(session), "recording")
    phase(_logger, "looking through %s and fitting the base", number)
    evidence, base = fit_baseline(found.plant, session.recordings)
    as_given = found, session
    read = None
    if ahead is None:
        read = fit_baseline_as_read(found.plant, session.recordings, base)
    elif ahead:
        read = fit_baseline_read(found.plant, session.recordings, ahead)
    if read is not None:
        taken, recordings, evidence, base = read
        session = Session(recordings, session.plant, session.replicates)
        found = replace(found, data={**found.data, "input_ahead": taken})
    whole = found
    found, replays = replay_base(found, evidence, base, asked.surrogates)
    if replays is None:
        return base_alone(found, evidence, base)
    phase(_logger, "screening the effects")

    def concluded(look: Searched, *, outdone: bool = False) -> Conclusion:
        return Conclusion(
            look.found,
            session,
            look.evidence.sealed_copy() if outdone else look.evidence,
            look.base,
            look.selection,
            look.null,
            look.noises,
            asked.laws,
            checks,
            asked.smallest,
            restated,
            outdone,
            interrupted=look.selection.interrupted,
            brief=look.selection.interrupted,
        )

    def of(plant: Plant) -> Diagnosis | None:
        began = replace(whole, plant=plant)
        try:
            return _testable(
                began,
                session,
                asked._replace(laws=()),
                checks,
                restated=True,
                # What was read ahead is in these recordings already.
                ahead=None if read is None else 0.0,
            )
        except InputError as error:
            # Nothing is broken: these data do not suffice for a diagnosis with that law.
            _logger.info("with %s: %s", plant.friction.law, error)
            return None

    # Who asks for laws wants them beside all that is named, and what is restated has been.
    asks = not (restated or asked.laws)
    followed: list[Model] = []
    look, shot, outdone = _first_look(
        found, evidence, base, replays, session, asked, followed=followed, asks=asks
    )
    # A look that takes the place of this one is all that is held from then on.
    del evidence, base, replays
    if outdone:
        other = diagnose_again_early(concluded(look, outdone=True), of)
        if other is not None:
            return other
        phase(_logger, "going on with law %s", found.plant.friction.law)
        look = look._replace(selection=asked.search(look.evidence, look.base, look.null))
    if not look.selection.interrupted and shot is None:
        final = look.selection.models[-1]
        wider = fit_wider_baseline(found.plant, session.recordings, look.base, final)
        if wider is not None:
            phase(_logger, "screening the effects again, through wider kernels")
            look = search_again(look, wider, asked=asked) or look
    if not look.selection.interrupted:
        look = _simulated(look, shot, session, asked, followed)
    del shot, followed
    if acts_for_seconds(look.evidence, look.selection, look.null):
        phase(_logger, "screening limits again, over the rows that decide as well")
        joined = fit_joint_baseline(found.plant, session.recordings, look.evidence)
        before = look.selection
        others = asked._replace(without=(*asked.without, *tried_names(before)))
        second = joined and search_again(look, joined, asked=others)
        if second and holds_more(second.selection, before):
            look = second._replace(selection=with_rows_of(second.selection, before))

    # Every decision is taken: now, and once, the rows that test.
    conclusion = look_otherwise(concluded(look), look, asked, concluded)
    told = conclusion.diagnosis()
    if ahead is None and told.success:
        by = _read_otherwise(session, read, told, conclusion)
        if by is not None:
            return _testable(*as_given, asked, checks, restated=restated, ahead=by)
    if restated or not told.better_law or not told.success:
        return told
    return diagnose_again_at_the_end(told, conclusion, of)


def _read_otherwise(
    session: Session, read: AsRead | None, told: Diagnosis, conclusion: Conclusion
) -> float | None:
    """By how many samples the input is to be read ahead, beside what was found; None for as it was.

    A base that lacks a cause bends its clock: it may seem ahead, and then something late is named
    beside that, or hide that the log is.
    """
    if read is not None:
        # Ahead and late is neither.
        return 0.0 if any(each.name in LATE for each in told.effects) else None
    if not told.effects:
        return None
    final = conclusion.final_selection.models[-1]
    found = fit_baseline_as_read(final.plant, session.recordings, final)
    return None if found is None else found.ahead


def _first_look(
    found: Diagnosis,
    evidence: Evidence,
    base: Model,
    replays: tuple[FloatArray, Mapping[int, Noise]],
    session: Session,
    asked: Asked,
    *,
    followed: list[Model],
    asks: bool,
) -> tuple[Searched, _Shot | None, bool]:
    """The first search; windows for another one, and whether that is made with another law.

    Windows are those over which to search again where readings lead astray. Elsewhere, and only
    where it ``asks``, another law may leave so little beside the first cause that the search is to
    be made with that.
    """
    shots: list[_Shot] = []
    others: list[bool] = []

    def led_astray(first: Search) -> bool:
        last = first.models[-1]
        shot = fit_simulated_baseline(
            found.plant, session.recordings, base, last, followed, first.tried
        )
        shots.extend([] if shot is None else [shot])
        return bool(shots)

    def stops(first: Search) -> bool:
        if led_astray(first):
            return True
        others.append(asks and is_outdone(first))
        return others[-1]

    # What is added to a first cause along readings that lead astray only follows these, and beside
    # a law that another one outdoes it stands for that.
    first = asked.search(evidence, base, replays[0], stops=stops)
    outdone = any(others) and not first.interrupted
    return Searched(found, evidence, base, *replays, first), shots[0] if shots else None, outdone


def _simulated(
    look: Searched,
    shot: _Shot | None,
    session: Session,
    asked: Asked,
    followed: list[Model],
) -> Searched:
    """The search over windows where readings lead astray: as ``shot`` tells, or at its end."""
    last = look.selection.models[-1]
    cut_short = shot is not None
    if shot is None:
        shot = fit_simulated_baseline(
            look.found.plant, session.recordings, look.base, last, followed
        )
    if shot is None:
        return look
    phase(_logger, "screening the effects again, with the plant simulated over windows")
    windows, base, earlier = shot
    other = search_again(look, (windows, base), asked=asked, earlier=earlier)
    if other is not None and not all_blind(other.selection):
        return other
    if not cut_short or other is None:
        return look
    # Few windows may show nothing of any effect: that takes no name away.
    return look._replace(selection=asked.search(look.evidence, look.base, look.null))
