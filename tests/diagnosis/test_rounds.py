"""Rounds of the selection: causes that pass only together, and what a named one leaves."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from stiction.catalogue import effects
from stiction.diagnosis.adequacy.exact_forms import doubt_geometry
from stiction.diagnosis.records import CandidateRow, Cause, Unexplained
from stiction.diagnosis.screening import block_gains
from stiction.diagnosis.selection import decide, rounds, together
from stiction.diagnosis.selection.beside import doubt_by_forms, stands_out
from stiction.diagnosis.selection.choose import Choice
from stiction.diagnosis.selection.decide import Trial
from stiction.diagnosis.selection.restarts import from_the_first
from stiction.diagnosis.selection.search import Search
from stiction.diagnosis.selection.trials import Screening

BLOCKS = np.ones(30), np.ones(30)


def trial(
    name: str,
    worth: float,
    reason: str = "",
    *,
    family: str = "",
    by_blocks: bool = False,
    contributed: Any = (1.0, 0.0),
    wave: bool = False,
) -> Trial:
    shapes = (SimpleNamespace(scale="order"),) if wave else ()
    record = SimpleNamespace(family=family or name, name=name, shapes=shapes, second=(), gains=())
    record.late = record.swings = record.limits = False
    candidate: Any = SimpleNamespace(name=name, parameters=1, record=record, shape={}, form=name)
    score: Any = SimpleNamespace(
        signature=np.asarray(contributed, dtype=float),
        candidate=candidate,
        score=0.3,
        threshold=0.05,
        heldout=0.2,
        testable=True,
    )
    model: Any = SimpleNamespace(blocks=BLOCKS, plant=SimpleNamespace(effects=()), name=name)
    return Trial(score, model, 0.2, 1.0, worth, 9.0, 0.1, reason, by_blocks)


class Bench:
    """What the rounds ask of a screening: answers by the name of the model."""

    evidence = SimpleNamespace(loop=False, simulated=False)
    earlier = ()

    def __init__(self, after: dict[str, list[Trial]]) -> None:
        self.after = after

    def scores(self, model: Any) -> list[Any]:
        return [each.score for each in self.after.get(model.name, [])]

    def trial(self, model: Any, score: Any, others: Any = ()) -> Trial:
        return next(t for t in self.after[model.name] if t.name == score.candidate.name)

    def may_count(self, score: Any) -> bool:
        own: Any = self
        return Screening.may_count(own, score)

    def from_where(self, model: Any, score: Any, lead: Any) -> None:
        return None

    def contribution(self, score: Any, model: Any) -> Any:
        return score.signature

    def encompasses(self, one: Trial, other: Trial) -> bool:
        return False


SPREAD = "its held-out gain is 1.96 standard errors, below 2.00"


@pytest.mark.parametrize(
    ("uneven", "beside_first", "beside_second", "passes"),
    [
        (0.0, "", "", True),
        (0.0, SPREAD, "", False),
        (0.0, "", SPREAD, False),
        # By kind of recording as well as over blocks, but a shape out of its range passes nowhere.
        (0.4, "", "", True),
        (0.4, "", SPREAD, False),
        # However uneven they make each other.
        (1.5, "", "", True),
        (decide.OUT_OF_RANGE, "", "", False),
    ],
)
def test_causes_that_hide_each_other_pass_together(
    monkeypatch: pytest.MonkeyPatch,
    uneven: float,
    beside_first: str,
    beside_second: str,
    passes: bool,
) -> None:
    first, second = (
        replace(trial(name, worth, SPREAD, by_blocks=uneven == 0.0), uneven=uneven)
        for name, worth in (("a", 1.0), ("b", 0.5))
    )
    bench: Any = Bench(
        {"a": [trial("b", 2.0, beside_first)], "b": [trial("a", 2.5, beside_second)]}
    )
    alone = SimpleNamespace(name="b")
    monkeypatch.setattr(together, "whole_fit", lambda *_: alone)
    monkeypatch.setattr(together, "without_effect", lambda plant, _: plant)
    base: Any = SimpleNamespace(nuisances=None)
    choice = together.pass_together(bench, base, [first, second])
    assert (choice is not None) == passes
    if choice is not None:
        assert choice.winner.name == "a"
        assert choice.winner.reason == ""


@pytest.mark.parametrize("better", [False, True])
def test_what_was_accepted_beside_a_base_that_is_replaced_is_decided_again(
    monkeypatch: pytest.MonkeyPatch, better: bool
) -> None:
    monkeypatch.setattr(rounds, "_renew", lambda evidence, found, lead: better)
    before = CandidateRow("stribeck", 0.1, 0.2, None, "others explain more")
    later = {"stribeck": replace(before, reason="accepted")}
    found: Any = SimpleNamespace(rows=later, blind=[1, 2])
    lead: Any = None
    assert rounds._renewed(lead, found, [lead], ({"stribeck": before}, [1])) is better
    assert (found.rows["stribeck"] is before) is better
    assert found.blind == ([1] if better else [1, 2])


def test_a_refit_that_freed_the_base_leads_to_a_better_one_before_any_name() -> None:
    freed = replace(trial("a", 2.0, "the base was freed"), freed=True)
    bench: Any = Bench({"base": [freed, trial("b", 1.0)]})
    base: Any = SimpleNamespace(name="base")
    choice, leads, _ = rounds._round(bench, Search([base]), set())
    assert choice is not None
    assert choice.winner.name == "b"
    assert [lead.name for lead in leads] == ["a", "b"]


class Asked(Bench):
    """Tells which candidates were refitted."""

    def __init__(self, after: dict[str, list[Trial]]) -> None:
        super().__init__(after)
        self.refitted: list[str] = []

    def trial(self, model: Any, score: Any, others: Any = ()) -> Trial:
        self.refitted.append(score.candidate.name)
        return super().trial(model, score, others)


def scored(name: str, score: float, along: tuple[float, float], **kinds: Any) -> Trial:
    """A trial whose score is this, of a model that explains half of the power."""
    one = trial(name, 2.0 * score, contributed=along, **kinds)
    one.score.score = score
    one.model.power = 0.5
    return one


@pytest.mark.parametrize(
    ("along", "score", "family", "refused", "refitted"),
    [
        ((0.0, 1.0), 0.3, "", "", ["a"]),
        # It may be the same cause, a relative of it, or more of one than what passed.
        ((1.0, 0.1), 0.3, "", "", ["a", "b"]),
        ((0.0, 1.0), 0.3, "a", "", ["a", "b"]),
        ((0.0, 1.0), 0.4, "", "", ["a", "b"]),
        # Where nothing passes there is no next round.
        ((0.0, 1.0), 0.3, "", SPREAD, ["a", "b"]),
    ],
)
def test_what_explains_another_part_and_less_waits_for_the_next_round(
    along: tuple[float, float], score: float, family: str, refused: str, refitted: list[str]
) -> None:
    first = replace(scored("a", 0.5, (1.0, 0.0)), reason=refused)
    bench: Any = Asked({"base": [first, scored("b", score, along, family=family)]})
    base: Any = SimpleNamespace(name="base", power=1.0)
    found = Search([base])
    rounds._round(bench, found, set())
    assert bench.refitted == refitted
    if refitted == ["a"]:
        assert found.rows["b"].reason == "others explain more"


@pytest.mark.parametrize(
    ("score", "kind", "simulated", "named", "refitted"),
    [
        (0.004, "", False, True, False),
        (0.007, "", False, True, True),
        # What is late or swings comes to more than its slope tells, what is simulated to anything.
        (0.004, "late", False, True, True),
        (0.004, "swings", False, True, True),
        (0.002, "late", False, True, False),
        (0.002, "", True, True, True),
        # What is tried in the first round is asked elsewhere.
        (0.002, "", False, False, True),
    ],
)
def test_what_cannot_come_to_what_counts_is_not_refitted(
    score: float,
    kind: str,
    simulated: bool,
    named: bool,
    refitted: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    slight = replace(scored("b", score, (1.0, 0.0)), reason="gains 1 % on rows held out")
    slight.score.threshold, slight.score.heldout = 0.001, 0.0015
    record: Any = slight.candidate.record
    record.late, record.swings = kind == "late", kind == "swings"
    bench: Any = Asked({"base": [slight]})
    bench.evidence = SimpleNamespace(loop=False, simulated=simulated)
    monkeypatch.setattr(rounds, "pass_together", lambda *_: None)
    monkeypatch.setattr(rounds, "doubt_by_forms", lambda *_: "")
    base: Any = SimpleNamespace(name="base", power=1.0)
    row = CandidateRow("b", score, 0.001, 0.0015, "others explain more")
    choices = [Choice(trial("a", 1.0), ())] if named else []
    found = Search([base], choices, {"b": row})
    choice, _, _ = rounds._round(bench, found, set())
    assert choice is None
    assert bench.refitted == (["b"] if refitted else [])
    assert (found.rows["b"].reason == rounds.TOO_LITTLE) is not refitted


@pytest.mark.parametrize(
    ("explained", "refused", "again"),
    [(0.28, "", []), (0.1, "", ["b"]), (0.28, SPREAD, ["b"])],
)
def test_what_passes_with_all_that_it_promised_begins_nowhere_else(
    explained: float, refused: str, again: list[str]
) -> None:
    first = scored("a", 0.4, (1.0, 0.0))
    second = replace(scored("b", 0.3, (1.0, 0.1)), explained=explained, reason=refused)
    begun: list[str] = []
    bench: Any = SimpleNamespace(
        from_where=lambda base, score, lead: begun.append(score.candidate.name)
    )
    trials = [first, second]
    base: Any = None
    assert from_the_first(bench, base, [t.score for t in trials], trials, first) == trials
    assert begun == again


def test_what_explains_less_than_another_is_no_first_of_two() -> None:
    spread = trial("a", 0.5, SPREAD, by_blocks=True)
    base: Any = SimpleNamespace(nuisances=None)
    bench: Any = Bench({"a": [trial("b", 2.0)]})
    assert together.pass_together(bench, base, [spread, trial("c", 1.0, "imitates")]) is None
    assert together.pass_together(bench, base, []) is None


@pytest.mark.parametrize(
    ("family", "worth", "along", "wave", "kept"),
    [
        ("contact", 0.15, (1.0, 0.5), False, False),
        ("contact", 0.15, (1.0, 0.5), True, False),
        # What a form leaves need not resemble it.
        ("contact", 0.15, (0.1, 1.0), False, False),
        # Large enough to be a cause of its own, of another kind, or a wave of another order.
        ("contact", 0.25, (1.0, 0.5), False, True),
        ("other", 0.15, (1.0, 0.5), False, True),
        ("contact", 0.15, (0.1, 1.0), True, True),
    ],
)
def test_a_small_relative_of_a_named_cause_may_be_its_rest(
    family: str, worth: float, along: tuple[float, float], wave: bool, kept: bool
) -> None:
    named = trial("a", 1.0, family="contact")
    later = trial("b", worth, family=family, contributed=along, wave=wave)
    row = CandidateRow("b", 0.3, 0.05, 0.2, "accepted")
    models: list[Any] = ["base", "with a", "with both"]
    found = Search(models, [Choice(named, ()), Choice(later, ())], {"b": row})
    bench: Any = Bench({})
    assert rounds._take_back(bench, found) == (set() if kept else {"b"})
    assert len(found.choices) == len(found.models) - 1 == (2 if kept else 1)
    assert found.rows["b"].reason.startswith("accepted" if kept else "small beside a,")


@pytest.mark.parametrize(
    ("named", "rest", "along", "reason", "open_"),
    [
        ("gravity_unbalance", "cogging", (1.0, 0.5), "", True),
        ("gravity_unbalance", "cogging", (1.0, 0.5), SPREAD, True),
        # Refused for more than its spread, a wave of another order, or one that is no single wave.
        ("gravity_unbalance", "cogging", (1.0, 0.5), "does not help on rows held out", False),
        ("gravity_unbalance", "cogging", (0.1, 1.0), SPREAD, False),
        ("cogging", "gravity_unbalance", (1.0, 0.5), "", False),
        ("torque_bias", "direction_asymmetry", (1.0, 0.5), "", False),
    ],
)
def test_a_single_wave_that_leaves_a_rest_may_be_the_first_of_several(
    named: str, rest: str, along: tuple[float, float], reason: str, open_: bool
) -> None:
    records = {record.name: record for record in effects()}
    wave, later = (
        replace(
            made,
            score=SimpleNamespace(
                signature=made.score.signature,
                candidate=SimpleNamespace(name=made.name, record=records[made.name]),
            ),
        )
        for made in (
            trial(named, 1.0),
            trial(rest, 0.15, reason, by_blocks=reason == SPREAD, contributed=along),
        )
    )
    bench: Any = Bench({})
    models: list[Any] = ["base", "with one"]
    found = Search(models, [Choice(wave, ())])
    if reason:
        rounds._doubt_single_waves(bench, found, [later])
    else:
        found = Search([*models, "with both"], [Choice(wave, ()), Choice(later, ())])
        found.rows[rest] = CandidateRow(rest, 0.3, 0.05, 0.2, "accepted")
        rounds._take_back(bench, found)
    assert [rival.name for rival in found.choices[0].rivals] == ([rest] if open_ else [])


@pytest.mark.parametrize(
    ("name", "coordinate", "decided"),
    [
        ("gravity_unbalance", "angle", False),
        ("gravity_unbalance", "velocity", True),
        ("cogging", "angle", True),
        ("encoder_eccentricity", "order over position, times acceleration", False),
        ("cogging", "order over position, times squared speed", False),
        ("encoder_eccentricity", "velocity", True),
        ("direction_asymmetry", "effort", False),
        ("direction_asymmetry", "velocity", True),
    ],
)
def test_what_geometry_leaves_no_rest_of_speaks_against_a_name(
    name: str, coordinate: str, decided: bool
) -> None:
    cause = Cause(name, "cogging", True, (), {}, None, "", "", "", "")
    left = [Unexplained(coordinate, 0.1)]
    after = doubt_geometry(cause, left, left)
    assert after.decided is decided
    twins = () if decided or coordinate != "angle" else ("cogging",)
    assert after.look_alikes == twins


@pytest.mark.parametrize(
    ("gained", "passes"),
    [
        # A recording in which it does nothing got worse, and two in which it acts got better.
        ((1.4, 0.5, 0.6, 1.0), True),
        # What it acts in got worse; and only one recording got better.
        ((1.0, 0.5, 0.9, 1.4), False),
        ((1.0, 0.3, 1.0, 1.0), False),
        ((1.0, 0.3, 1.0, 1.0, 1.0), False),
        # Of many it may lose the machine in one.
        ((1.0, 0.5, 0.9, 0.9, 1.8), True),
    ],
)
def test_a_recording_in_which_an_effect_does_nothing_does_not_judge_it(
    gained: tuple[float, ...], passes: bool
) -> None:
    rows, recordings = 40, len(gained)
    recording = np.repeat(np.arange(recordings), rows)
    cells = SimpleNamespace(block=recording, recording=recording)

    def model(*powers: float) -> Any:
        blocks = np.ones(recordings), np.array(powers)
        return SimpleNamespace(blocks=blocks, evidence=SimpleNamespace(cells=cells))

    contributed = np.where(recording == 0, 0.0, 1.0)
    kept = block_gains.without_the_best(model(*np.ones(recordings)), model(*gained), contributed)
    assert (kept > 0.5 * decide.LEAST_GAIN) == passes


@pytest.mark.parametrize(
    ("other", "threshold", "asked"),
    [(0.02, 0.05, True), (0.2, 0.05, False), (0.02, 0.4, False)],
    ids=["alone", "beside as much", "no more than noise"],
)
def test_what_explains_many_times_what_others_do_is_refitted_though_it_does_harm_held_out(
    other: float, threshold: float, asked: bool
) -> None:
    scores = [trial("run_in", 0.5).score, trial("warm_up", 0.4).score, trial("cogging", 0.1).score]
    slow: Any = SimpleNamespace(family="slow", name="slow")
    for score, size in zip(scores, (0.3, 0.28, other), strict=True):
        score.score, score.threshold, score.heldout = size, threshold, -0.1
    scores[0].candidate.record = scores[1].candidate.record = slow
    # A relative that explains as much is the same thing by another name, or by its right one.
    assert rounds._outstanding(scores) == (scores[:2] if asked else [])
    assert rounds._outstanding([]) == []


@pytest.mark.parametrize(
    ("times", "family", "late", "loop", "named", "passes"),
    [
        (1.1, "creep", False, False, False, True),
        (1.1, "creep", False, False, True, False),
        (2.5, "creep", False, False, True, True),
        # What may be the rest of a wave, and of what a slope tells too little.
        (1.1, "waves", False, False, True, True),
        (1.1, "lag", True, False, True, True),
        (1.1, "goal", False, True, True, True),
        (1.1, "goal", False, False, True, False),
    ],
)
def test_beside_a_name_a_further_one_has_to_stand_out(
    times: float, family: str, late: bool, loop: bool, named: bool, passes: bool
) -> None:
    record = SimpleNamespace(family=family, late=late)
    score: Any = SimpleNamespace(
        score=times * 0.01, threshold=0.01, candidate=SimpleNamespace(record=record)
    )
    evidence: Any = SimpleNamespace(loop=loop)
    families = {"waves"} if named else set()
    assert stands_out(evidence, score, families) == passes
    # So does what a refit gains beyond doubt on rows held out.
    for gain, z in ((0.2, 9.0), (0.5, 3.0), (0.5, 9.0)):
        tried: Any = SimpleNamespace(score=score, reason="", gain=gain, z=z)
        surely = gain > 0.3 and z > 4.0
        assert (doubt_by_forms(evidence, tried, families) == "") == (passes or surely)
    refused: Any = SimpleNamespace(score=score, reason="another one", gain=0.2, z=9.0)
    assert doubt_by_forms(evidence, refused, families) == ""


@pytest.mark.parametrize(("explained", "refused"), [(0.03, True), (0.1, False)])
def test_what_finds_a_lost_machine_again_is_no_cause(explained: float, refused: bool) -> None:
    """Half of what is held out comes back by what explains next to nothing elsewhere."""
    number = 40
    block = np.arange(number)
    train = np.where(block % 2 == 0, 1.0, 0.0)
    held = 1.0 - train
    cells = SimpleNamespace(block=block, recording=block % 4, kind=block % 2, kinds=("a", "b"))
    evidence = SimpleNamespace(cells=cells, loop=False, simulated=False, fitted=train > 0.0)
    plant = SimpleNamespace(inertia=1.0, effects=(SimpleNamespace(name="cogging", parameters={}),))
    base: Any = SimpleNamespace(evidence=evidence, power=100.0, plant=plant, blocks=(train, held))
    # Every block gains, one a little more than another.
    left = 0.5 * held * (1.0 + 0.01 * block / number)
    model: Any = SimpleNamespace(
        power=100.0 * (1.0 - explained),
        relative_input_power=1.0,
        plant=plant,
        blocks=((1.0 - explained) * train, left),
        strength=lambda _: 9.0,
        columns=np.ones((number, 1)),
        residual=np.ones(number),
    )
    record = SimpleNamespace(
        late=False,
        limits=False,
        slope_misleads=lambda loop: False,
        shapes=(),
        family="angle",
        parameters=(),
    )
    candidate = SimpleNamespace(name="cogging", record=record, parameters=2, gains=())
    score: Any = SimpleNamespace(score=explained, threshold=0.01, candidate=candidate)
    judged = decide.judge(base, score, model, np.ones(number), 0.1)
    assert ("the base had lost the machine" in judged.reason) == refused, judged.reason
    if refused:
        assert not judged.by_blocks


def test_where_an_effect_touches_nothing_its_gain_has_no_standard_error() -> None:
    base: Any = SimpleNamespace(blocks=BLOCKS)
    model: Any = SimpleNamespace(blocks=(0.5 * BLOCKS[0], 0.5 * BLOCKS[1]))
    gain, z = block_gains.heldout_gain(base, model, np.zeros(30, dtype=bool))
    assert (gain, z) == (0.5, 0.0)
