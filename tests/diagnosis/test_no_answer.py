"""Where there is no answer: what test rows speak against, what happens once, what is no machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.diagnosis import builders

import stiction as st
from stiction.diagnosis.data.evidence import Cells
from stiction.diagnosis.data.gain import HeldOut
from stiction.diagnosis.findings.words import no_machine
from stiction.diagnosis.records import CandidateRow
from stiction.diagnosis.selection import trials
from stiction.diagnosis.selection.confirm import (
    AGAINST,
    NO_BETTER,
    NO_MACHINE,
    NOT_KNOWN,
    confirm_on_test,
    reject_without_machine,
)
from stiction.diagnosis.selection.search import Search
from stiction.errors import NotEnoughData

BLOCKS, ROWS = 40, 50


def opened(*sizes: float) -> HeldOut:
    """Residuals of these sizes, one of each model, over rows that test."""
    source = np.random.default_rng(0)
    one = source.standard_normal(BLOCKS * ROWS)
    block = np.repeat(np.arange(BLOCKS), ROWS)
    cells = Cells(block, block * 0, block * 0, ("",))
    return HeldOut(tuple(size * one for size in sizes), np.ones(len(one)), one, cells, ())


def selected(*names: str, known: bool = True) -> Search:
    rows = {name: CandidateRow(name, 0.5, 0.1, 0.2, "accepted") for name in names}
    models = [builders.model(surely=known) for _ in ("", *names)]
    return builders.search(*names, models=models, rows=rows)


@pytest.mark.parametrize(
    ("sizes", "kept"),
    [
        ((1.0, 0.7), 1),
        ((1.0, 1.3), 0),
        ((1.0, 0.7, 0.8), 1),
        ((1.0, 1.2, 1.3), 0),
        # What comes after it bears the first one out, or not: together they are no worse.
        ((1.0, 1.2, 0.5), 2),
    ],
)
def test_names_that_test_rows_speak_against_are_taken_away(
    sizes: tuple[float, ...], kept: int
) -> None:
    names = ("first", "second")[: len(sizes) - 1]
    selection = selected(*names)
    found = confirm_on_test(selection, opened(*sizes), 0)
    assert [choice.winner.name for choice in found.choices] == list(names[:kept])
    assert found.models == selection.models[: kept + 1]
    reasons = [found.rows[name].reason for name in names]
    assert reasons == ["accepted"] * kept + [AGAINST] * (len(names) - kept)


def test_without_rows_that_test_nothing_is_taken_away() -> None:
    assert len(confirm_on_test(selected("first"), None, 0).choices) == 1


@pytest.mark.parametrize(
    ("size", "known", "kept"), [(1.0, False, 0), (1.0, True, 1), (0.9, False, 1)]
)
def test_a_name_needs_a_strength_or_a_gain_that_is_not_nothing(
    size: float, known: bool, kept: int
) -> None:
    found = confirm_on_test(selected("first", known=known), opened(1.0, size), 0)
    assert len(found.choices) == kept
    assert found.rows["first"].reason == ("accepted" if kept else NOT_KNOWN)


def moved(bumps: tuple[float, ...]) -> st.Recording:
    """A contact moved to and fro for 60 s, with a bump of its force at these times."""
    time = np.arange(6000) * 0.01
    position = 0.02 * np.sin(0.9 * time)
    velocity = 0.018 * np.cos(0.9 * time)
    source = np.random.default_rng(5)
    effort = 40.0 * np.sign(velocity) + 300.0 * velocity + 0.4 * source.standard_normal(len(time))
    for at in bumps:
        effort += 12.0 * np.exp(-(((time - at) / 0.3) ** 2))
    return st.Recording(time, None, position, effort=effort)


def plant() -> st.Plant:
    return st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"kind": "prescribed_motion"},
            "friction": {"law": "coulomb"},
        }
    )


def test_what_happened_once_cannot_be_tested() -> None:
    dealt = st.diagnose(plant(), moved(())).data["split"]
    for role, words in (("train", "were fitted"), ("select", "decide"), ("test", "test")):
        # The middle of a block: nothing of the event reaches into those of other roles.
        begin, end = dealt[role][len(dealt[role]) // 2]["seconds"]
        found = st.diagnose(plant(), moved((0.5 * (begin + end),)))
        assert found.verdict == "not_testable", (role, found.sentence)
        assert f"rows that {words}" in found.sentence
        assert not found.effects
        assert any(advice.experiment.startswith("repeat what happens") for advice in found.advice)


def test_what_happened_in_rows_of_every_role_can_be_tested() -> None:
    found = st.diagnose(plant(), moved(tuple(np.arange(2.0, 58.0, 3.1))))
    assert found.verdict == "unexplained", found.sentence


def test_motion_that_the_input_does_not_make_cannot_be_tested() -> None:
    source = np.random.default_rng(2)
    time = np.arange(12_000) * 1e-3
    position = 0.4 * np.sin(6.0 * time) + 0.2 * np.sin(11.0 * time)
    acceleration = -14.4 * np.sin(6.0 * time) - 24.2 * np.sin(11.0 * time)
    # A sensor the other way round.
    effort = -0.06 * acceleration + 0.02 * source.standard_normal(len(time))
    lone = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.06},
            "friction": {"law": "coulomb"},
        }
    )
    found = st.diagnose(lone, st.Recording(time, effort, position))
    assert found.verdict == "not_testable", found.sentence
    assert "do not belong together" in found.sentence


@pytest.mark.parametrize(
    ("sizes", "reason"),
    [((1.0, 0.6), "accepted"), ((1.0, 0.9), NO_MACHINE), ((0.4, 0.5), NO_BETTER)],
)
def test_a_name_needs_a_plant_that_describes_the_machine(
    sizes: tuple[float, float], reason: str
) -> None:
    evidence = builders.evidence()
    one = effort()
    selection = selected("first")
    models = [builders.model(residual=size * one) for size in sizes]
    # Noise alone leaves as little everywhere.
    null = np.repeat(0.1 * one[:, None], 4, axis=1)
    found = reject_without_machine(replace(selection, models=models), evidence, null)
    assert found.rows["first"].reason == reason
    assert len(found.choices) == (reason == "accepted")
    assert len(found.models) == 1 + len(found.choices)


def effort() -> np.ndarray:
    """What was measured of it in all rows."""
    return builders.evidence().stack(lambda rows: rows.form.whole(builders.plant()))


def test_one_block_takes_no_name_away() -> None:
    number, source = len(effort()), np.random.default_rng(0)
    # Many blocks, of 30 rows each.
    evidence = builders.evidence(cells=builders.cells(np.arange(number) // 30))
    before = 0.03 * float(np.std(effort())) * source.standard_normal(number)
    after = 0.5 * before
    # One break-away that comes too early leaves more than all that was gained elsewhere.
    held = evidence.plans[0].held
    after[np.flatnonzero(held)[:30]] += 10.0 * float(np.std(before))
    assert np.sum(after[held] ** 2) > np.sum(before[held] ** 2)

    def left(*residuals: np.ndarray) -> Search:
        models = [builders.model(evidence, residual=each) for each in residuals]
        return replace(selected("first"), models=models)

    null = np.repeat(0.1 * before[:, None], 4, axis=1)
    assert reject_without_machine(left(before, after), evidence, null).choices
    astray = left(before, 1.2 * before)
    assert not reject_without_machine(astray, evidence, null).choices


def alone(*, bias: float, follows: bool) -> st.Diagnosis:
    """A machine of known inertia, whose input makes its motion or has nothing to do with it."""
    source = np.random.default_rng(4)
    time = np.arange(24_000) * 1e-3
    needed = np.zeros_like(time)
    position = np.zeros_like(time)
    for k, rate in enumerate((2.3, 4.1, 7.3, 11.9)):
        position += 0.3 / rate * np.sin(rate * time + k)
        needed -= 0.06 * 0.3 * rate * np.sin(rate * time + k)
        needed += 0.01 * 0.3 * np.cos(rate * time + k)
    other = sum(0.3 * np.sin(rate * time) for rate in (1.7, 3.1, 5.7))
    effort = (needed if follows else other) + bias + 0.005 * source.standard_normal(len(time))
    lone = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": {"value": 0.06, "fixed": True}},
            "friction": {"law": "coulomb"},
        }
    )
    return st.diagnose(lone, st.Recording(time, effort, position), surrogates=6)


@pytest.mark.slow
def test_a_plant_that_leaves_most_of_the_effort_has_no_causes() -> None:
    found = alone(bias=0.0, follows=False)
    assert found.verdict == "unexplained", found.sentence
    assert not found.effects
    assert "before any cause counts, check columns" in found.sentence


def test_a_cause_that_is_most_of_the_effort_keeps_its_name() -> None:
    found = alone(bias=0.4, follows=True)
    assert found.effects[0].name == "torque_bias", found.sentence
    assert "check columns" not in found.sentence


@pytest.mark.parametrize(
    ("left", "words"), [(0.0, ""), (0.74, "leaves 74 % of"), (2.7, "leaves more than the power")]
)
def test_what_a_plant_leaves_of_the_effort_is_said_where_it_is_most(
    left: float, words: str
) -> None:
    told = no_machine(left, False, "unexplained")
    assert words in told
    assert bool(told) is bool(left)
    assert no_machine(left, False, "not_testable") == ""


def lone(current: np.ndarray, position: np.ndarray) -> st.Recording:
    return st.Recording(np.arange(len(position)) * 1e-3, current, position)


@pytest.mark.parametrize("law", ["coulomb", "dahl"])
def test_readings_that_are_noise_alone_are_no_machine(law: str) -> None:
    """A contact that rests in all rows holds every effort, and one that yields is led by noise."""
    source = np.random.default_rng(3)
    noise = lone(source.standard_normal(20_000), source.standard_normal(20_000))
    drive = {"input": "current_a", "gain": 0.5}
    machine = st.Plant.from_dict({"drive": drive, "friction": {"law": law}})
    found = st.diagnose(machine, noise, surrogates=4)
    assert found.verdict == "not_testable"
    assert "nothing moves beyond the noise" in found.sentence
    with pytest.raises(NotEnoughData, match="nothing moves beyond the noise"):
        st.fit(machine, noise)


def test_a_contact_that_rests_in_all_rows_is_no_better_law() -> None:
    """It holds every effort, so that it would leave nothing of what another law has to explain."""
    time = np.arange(20_000) * 1e-3
    source = np.random.default_rng(5)
    current = np.sin(2.0 * np.pi * 0.7 * time)
    # Within one count of the encoder: a spring, and nothing that a contact with true stick shows.
    noise = 0.3 * source.standard_normal(len(time))
    readings = np.round(0.3 * np.sin(2.0 * np.pi * 0.05 * time) + noise)
    drive = {"input": "current_a", "gain": 0.5}
    machine = st.Plant.from_dict({"drive": drive, "friction": {"law": "dahl"}})
    found = st.diagnose(machine, lone(current, 1e-3 * readings), laws=["coulomb"], surrogates=4)
    row = next(row for row in found.laws if row.law == "coulomb")
    assert "nothing moves beyond the noise" in row.reason
    assert found.better_law == ""


def test_a_machine_that_nothing_drives_cannot_be_used() -> None:
    time = np.arange(20_000) * 1e-3
    swung = lone(np.zeros(len(time)), np.sin(7.0 * time) * np.exp(-0.2 * time))
    drive = {"input": "current_a", "gain": 0.5}
    machine = {"drive": drive, "friction": {"law": "coulomb"}}
    found = st.diagnose(st.Plant.from_dict(machine), swung, surrogates=4)
    assert found.verdict == "data_fault"
    assert "input is 0 in every row of all recordings" in found.sentence
    # Weight drives as well.
    hung = {**machine, "body": {"inertia": 0.01, "gravity_amplitude": 0.5}}
    assert st.diagnose(st.Plant.from_dict(hung), swung, surrogates=4).verdict != "data_fault"
    assert "the effort is 0" in str(st.fit(st.Plant.from_dict(machine), swung))


@pytest.mark.parametrize(("left", "taken"), [(0.5, True), (1e-9, False)])
def test_a_plant_of_which_nothing_is_left_is_no_better_one(left: float, taken: bool) -> None:
    """A deadband wider than any input left nothing to drive, and nothing that was unexplained."""
    found = builders.model()
    # Of what the other fit came to noise alone leaves less than twice as much, or far more.
    session = builders.evidence(floor=0.4 / left * found.power)
    model = builders.model(session)
    other = builders.solution(model.plant, power=0.5)
    assert (trials.better_of(model, other) is not model) == taken
    gone = replace(other, power=1.0)
    assert trials.better_of(model, gone) is model
