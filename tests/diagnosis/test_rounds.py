"""Rounds of the selection: causes that pass only together, and what a named one leaves."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.diagnosis.builders import (
    EFFECTS,
    candidate,
    cells,
    evidence,
    model,
    plant,
    score,
    screening,
    search,
    trial,
)
from tests.diagnosis.builders import cause as cause_of

from stiction.diagnosis.adequacy.exact_forms import doubt_geometry
from stiction.diagnosis.data.evidence import Plan
from stiction.diagnosis.records import CandidateRow, Unexplained
from stiction.diagnosis.screening import block_gains
from stiction.diagnosis.screening.model import Model, fit_model
from stiction.diagnosis.selection import decide, rounds, together
from stiction.diagnosis.selection.beside import doubt_by_forms, stands_out
from stiction.diagnosis.selection.choose import Choice
from stiction.diagnosis.selection.decide import Trial
from stiction.diagnosis.selection.restarts import from_the_first
from stiction.diagnosis.selection.search import Search
from stiction.fitting.angular import Angular

BLOCKS = np.ones(30), np.ones(30)
# Hooks of what is late and of what swings.
KINDS = {"late": ("input delay",), "swings": ("second mass",)}


def tried(
    name: str,
    worth: float,
    reason: str = "",
    *,
    family: str = "",
    kind: str = "",
    contributed: Any = (1.0, 0.0),
    wave: bool = False,
    value: float = 0.3,
    threshold: float = 0.05,
    heldout: float = 0.2,
    power: float = 1.0,
    **stated: Any,
) -> Trial:
    """A trial of an effect of this name alone; ``power`` is what its model leaves."""
    told: dict[str, Any] = {"family": family or name}
    told |= {"hooks": KINDS[kind]} if kind else {}
    told |= {"shapes": EFFECTS["cogging"].shapes} if wave else {}
    own = score(
        candidate(name, **told),
        value,
        threshold=threshold,
        heldout=heldout,
        contributed=contributed,
    )
    refit = model(name=name, blocks=BLOCKS, power=power)
    return trial(own, worth, reason, refit=refit, **stated)


def base(power: float = 1.0) -> Model:
    return model(name="base", power=power, blocks=BLOCKS)


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
    uneven: float, beside_first: str, beside_second: str, passes: bool
) -> None:
    first, second = (
        tried(name, worth, SPREAD, by_blocks=uneven == 0.0, uneven=uneven)
        for name, worth in (("a", 1.0), ("b", 0.5))
    )
    after = {"a": [tried("b", 2.0, beside_first)], "b": [tried("a", 2.5, beside_second)]}
    bench = screening(after, fits=lambda _: model(name="b"))
    choice = together.pass_together(bench, base(), [first, second])
    assert (choice is not None) == passes
    if choice is not None:
        assert choice.winner.name == "a"
        assert choice.winner.reason == ""


@pytest.mark.parametrize("better", [False, True])
def test_what_was_accepted_beside_a_base_that_is_replaced_is_decided_again(better: bool) -> None:
    # The base alone, fitted from where a trial led, leaves less than it did, or as much.
    power = fit_model(evidence(), plant()).power
    found = Search([base(2.0 * power if better else power)])
    before = CandidateRow("stribeck", 0.1, 0.2, None, "others explain more")
    found.rows = {"stribeck": replace(before, reason="accepted")}
    found.blind = [EFFECTS["cogging"], EFFECTS["run_in"]]
    told = {"stribeck": before}, [EFFECTS["cogging"]]
    lead = tried("a", 1.0)
    assert rounds._renewed(lead.model.evidence, found, [lead], told) is better
    assert (found.rows["stribeck"] is before) is better
    assert [each.name for each in found.blind] == ["cogging", "run_in"][: 1 if better else 2]


def test_a_refit_that_freed_the_base_leads_to_a_better_one_before_any_name() -> None:
    freed = tried("a", 2.0, "the base was freed", freed=True)
    bench = screening({"base": [freed, tried("b", 1.0)]})
    choice, leads, _ = rounds._round(bench, Search([base()]), set())
    assert choice is not None
    assert choice.winner.name == "b"
    assert [lead.name for lead in leads] == ["a", "b"]


def scored(name: str, value: float, along: tuple[float, float], **kinds: Any) -> Trial:
    """A trial whose score is this, of a model that explains half of the power."""
    reason = kinds.pop("reason", "")
    known = {"contributed": along, "value": value, "power": 0.5, **kinds}
    return tried(name, 2.0 * value, reason, **known)


@pytest.mark.parametrize(
    ("along", "value", "family", "refused", "refitted"),
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
    along: tuple[float, float], value: float, family: str, refused: str, refitted: list[str]
) -> None:
    first = scored("a", 0.5, (1.0, 0.0), reason=refused)
    bench = screening({"base": [first, scored("b", value, along, family=family)]})
    found = Search([base()])
    rounds._round(bench, found, set())
    assert bench.refitted == refitted
    if refitted == ["a"]:
        assert found.rows["b"].reason == "others explain more"


@pytest.mark.parametrize(
    ("value", "kind", "simulated", "named", "refitted"),
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
    value: float, kind: str, simulated: bool, named: bool, refitted: bool
) -> None:
    little = "gains 1 % on rows held out"
    own = {"kind": kind, "threshold": 0.001, "heldout": 0.0015}
    slight = scored("b", value, (1.0, 0.0), reason=little, **own)
    bench = screening({"base": [slight]}, session=evidence(simulated=simulated))
    row = CandidateRow("b", value, 0.001, 0.0015, "others explain more")
    choices = [Choice(tried("a", 1.0), ())] if named else []
    found = Search([base()], choices, {"b": row})
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
    second = scored("b", 0.3, (1.0, 0.1), explained=explained, reason=refused)
    bench = screening()
    trials = [first, second]
    assert from_the_first(bench, base(), [t.score for t in trials], trials, first) == trials
    assert bench.begun == again


def test_what_explains_less_than_another_is_no_first_of_two() -> None:
    spread = tried("a", 0.5, SPREAD, by_blocks=True)
    bench = screening({"a": [tried("b", 2.0)]})
    assert together.pass_together(bench, base(), [spread, tried("c", 1.0, "imitates")]) is None
    assert together.pass_together(bench, base(), []) is None


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
    named = tried("a", 1.0, family="contact")
    later = tried("b", worth, family=family, contributed=along, wave=wave)
    row = CandidateRow("b", 0.3, 0.05, 0.2, "accepted")
    found = search(named, later, rows={"b": row})
    assert rounds._take_back(screening(), found) == (set() if kept else {"b"})
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
    wave, later = trial(named, 1.0), trial(score(rest, contributed=along), 0.15, reason)
    if reason:
        found = search(wave)
        later = replace(later, by_blocks=reason == SPREAD)
        rounds._doubt_single_waves(screening(), found, [later])
    else:
        row = CandidateRow(rest, 0.3, 0.05, 0.2, "accepted")
        found = search(wave, later, rows={rest: row})
        rounds._take_back(screening(), found)
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
    cause = cause_of(name, "cogging")
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
    session = evidence(cells=cells(recording, recording))

    def leaves(powers: Any) -> Model:
        return model(session, blocks=(np.ones(recordings), np.array(powers)))

    contributed = np.where(recording == 0, 0.0, 1.0)
    before, after = leaves(np.ones(recordings)), leaves(gained)
    kept = block_gains.without_the_best(before, after, contributed)
    assert (kept > 0.5 * decide.LEAST_GAIN) == passes


@pytest.mark.parametrize(
    ("other", "threshold", "asked"),
    [(0.02, 0.05, True), (0.2, 0.05, False), (0.02, 0.4, False)],
    ids=["alone", "beside as much", "no more than noise"],
)
def test_what_explains_many_times_what_others_do_is_refitted_though_it_does_harm_held_out(
    other: float, threshold: float, asked: bool
) -> None:
    sizes = {"run_in": 0.3, "warm_up": 0.28, "cogging": other}
    assert EFFECTS["run_in"].family == EFFECTS["warm_up"].family != EFFECTS["cogging"].family
    scores = [score(name, size, threshold=threshold, heldout=-0.1) for name, size in sizes.items()]
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
    hooks = {"hooks": KINDS["late"]} if late else {}
    own = score(candidate("a", family=family, **hooks), times * 0.01, threshold=0.01)
    session = evidence(loop=loop)
    families = {"waves"} if named else set()
    assert stands_out(session, own, families) == passes
    # So does what a refit gains beyond doubt on rows held out.
    for gain, z in ((0.2, 9.0), (0.5, 3.0), (0.5, 9.0)):
        surely = gain > 0.3 and z > 4.0
        doubt = doubt_by_forms(session, trial(own, gain=gain, z=z), families)
        assert (doubt == "") == (passes or surely)
    assert doubt_by_forms(session, trial(own, 1.0, "another one", z=9.0), families) == ""


@pytest.mark.parametrize(("explained", "refused"), [(0.03, True), (0.1, False)])
def test_what_finds_a_lost_machine_again_is_no_cause(explained: float, refused: bool) -> None:
    """Half of what is held out comes back by what explains next to nothing elsewhere."""
    number = 40
    block = np.arange(number)
    train = np.where(block % 2 == 0, 1.0, 0.0)
    held = 1.0 - train
    session = evidence(
        cells=cells(block, block % 4, block % 2, number=2),
        plans=[Plan(train > 0.0, train == 0.0)],
        fitted=train > 0.0,
    )
    waved = plant(effects=[{"name": "cogging", "order": 1.0, "cosine": 0.1, "sine": 0.1}])
    before = model(session, power=100.0, blocks=(train, held))
    # Every block gains, one a little more than another.
    left = 0.5 * held * (1.0 + 0.01 * block / number)
    after = model(
        session,
        waved,
        power=100.0 * (1.0 - explained),
        relative_input_power=1.0,
        blocks=((1.0 - explained) * train, left),
        columns=Angular.of_matrix(np.ones((number, 1))),
        residual=np.ones(number),
    )
    own = score("cogging", explained, threshold=0.01)
    judged = decide.judge(before, own, after, np.ones(number), 0.1)
    assert ("the base had lost the machine" in judged.reason) == refused, judged.reason
    if refused:
        assert not judged.by_blocks


def test_where_an_effect_touches_nothing_its_gain_has_no_standard_error() -> None:
    half = model(blocks=(0.5 * BLOCKS[0], 0.5 * BLOCKS[1]))
    gain, z = block_gains.heldout_gain(base(), half, np.zeros(30, dtype=bool))
    assert (gain, z) == (0.5, 0.0)
