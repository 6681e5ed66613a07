"""The pieces of a diagnosis, each alone: seal, projection, scores, gain, verdict in words."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.diagnosis import builders

import stiction as st
from stiction.catalogue import EffectRecord
from stiction.cli import run
from stiction.diagnosis.adequacy.periodic import waves_of
from stiction.diagnosis.data.evidence import Evidence, Plan, SealedError
from stiction.diagnosis.data.gain import HeldOut, gain_of
from stiction.diagnosis.data.surrogates import centre, surrogate_residuals
from stiction.diagnosis.findings.result import Diagnosis
from stiction.diagnosis.findings.verdict import relatives
from stiction.diagnosis.findings.words import value_words
from stiction.diagnosis.records import Cause
from stiction.diagnosis.screening.candidates import (
    Scales,
    candidates,
    excluded_names,
    present,
    scales_of,
)
from stiction.diagnosis.screening.model import LEAST_GIVEN, Model, fit_model, with_effect
from stiction.diagnosis.screening.regression import project
from stiction.diagnosis.screening.screen import Score
from stiction.diagnosis.selection import listing
from stiction.diagnosis.selection.choose import Choice, choose, strangers
from stiction.diagnosis.selection.decide import OUT_OF_RANGE, Trial
from stiction.diagnosis.selection.trials import Screening
from stiction.fitting.angular import Angular
from stiction.fitting.levenberg import escape, levenberg_marquardt
from stiction.fitting.replay import noise_of
from stiction.fitting.result import FitParameter
from stiction.fitting.rows import Nuisances
from stiction.fitting.statistics import interval_width
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect
from stiction.residual.finite import finite

DT = 1e-3
COUNT = 2.0 * math.pi / 2**18


def recorded(
    seed: int,
    *,
    seconds: float = 7.0,
    noise: float = 0.004,
    stiffness: float = 3000.0,
    **labels: object,
):
    """A machine of the core, moved by sines: pieces are looked at here, not what they find."""
    source = np.random.default_rng(seed)
    time = np.arange(round(seconds / DT)) * DT
    waves = [0.3 * np.sin(w * time + source.uniform(0, 6)) for w in (2.0, 5.3, 13.0)]
    effort = np.sum(waves, axis=0)
    friction = st.FrictionModel(
        "maxwell_slip", coulomb=0.25, viscous=0.02, initial_stiffness=stiffness
    )
    motor = st.Motor(0.006, friction=friction)
    position = np.concatenate([[0.0], motor.simulate(effort[:-1], DT).position])
    measured = effort + noise * source.standard_normal(len(time))
    return st.Recording(time, measured, np.round(position / COUNT) * COUNT, **labels)


def true_plant(stiffness: float = 3000.0) -> st.Plant:
    return st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm"},
            "body": {"inertia": 0.006},
            "friction": {
                "law": "maxwell_slip",
                "coulomb": 0.25,
                "initial_stiffness": stiffness,
                "viscous": 0.02,
            },
        }
    )


@pytest.fixture(scope="module")
def evidence() -> Evidence:
    roles = ("train", "select", "test")
    return Evidence(true_plant(), [recorded(k, role=role) for k, role in enumerate(roles)])


def test_the_rows_that_test_are_opened_once() -> None:
    sealed = Evidence(
        true_plant(), [recorded(k, role=r) for k, r in enumerate(("train", "select", "test"))]
    )
    assert all(rows.index != 2 for rows in sealed.shown)
    sealed.weigh()
    assert [rows.index for rows in sealed.open_test()] == [2]
    with pytest.raises(SealedError):
        sealed.open_test()


def test_without_select_the_recordings_of_train_are_left_out_in_turn() -> None:
    several = [recorded(k, role="train", kind="sines") for k in range(3)]
    folds = Evidence(true_plant(), [*several, recorded(9, role="test")]).plans
    assert len(folds) == 3
    for plan in folds:
        assert not np.any(plan.fit & plan.held)
    assert np.all(np.sum([plan.held for plan in folds], axis=0) == 1)


def test_surrogates_hold_the_noise_that_the_recording_holds() -> None:
    # 35 counts within the reach F_c/k. Where there are 4 the contact rings faster than the sensor
    # shows, and what that leaves no surrogate holds: there shooting takes over.
    plant, none = true_plant(300.0), Nuisances()
    recordings = [recorded(k, role=r, stiffness=300.0) for k, r in enumerate(("train", "select"))]
    evidence = Evidence(plant, recordings)
    evidence.weigh()
    for rows in evidence.shown:
        # Counts that the contact feels look like noise of the effort too: never less than it is.
        assert 0.0036 < noise_of(rows, plant, none).effort < 0.0056
        assert noise_of(rows, plant, none).count == pytest.approx(COUNT, rel=1e-6)
    null, noises = surrogate_residuals(evidence, plant, none, 8, 3)
    again, _ = surrogate_residuals(evidence, plant, none, 8, 3)
    assert np.array_equal(null, again)
    assert sorted(noises) == [0, 1]
    real = evidence.residual(plant, none)
    assert np.std(null) == pytest.approx(np.std(real), rel=0.25)
    bias, centred = centre(null)
    assert np.allclose(centred.sum(axis=1), 0.0, atol=1e-12)
    assert bias.shape == real.shape


def test_a_fold_leaves_alone_what_its_rows_do_not_tell() -> None:
    source = np.random.default_rng(0)
    base, residual = source.standard_normal((200, 3)), source.standard_normal(200)
    whole = np.arange(200) < 160
    fit = np.arange(200) < 80
    held = whole & ~fit
    # The last column is all but 0 in the rows that the fold fits: they would make a jump of it.
    base[fit, 2] = 1e-5 * source.standard_normal(80)
    residual -= base @ np.linalg.lstsq(base[whole], residual[whole])[0]
    columns = Angular.of_matrix(base)
    jumped = project(columns, Plan(fit, held)).project(residual).held
    assert np.linalg.norm(jumped) > 100.0 * np.linalg.norm(residual[held])
    left = project(columns, Plan(fit, held, whole)).project(residual).held
    expected = project(Angular.of_matrix(base[:, :2]), Plan(fit, held)).project(residual).held
    assert np.allclose(left, expected, atol=0.2)
    assert np.linalg.norm(left) < 1.1 * np.linalg.norm(residual[held])
    # What its rows do tell is fitted as ever.
    told = Angular.of_matrix(source.standard_normal((200, 3)))
    both = [project(told, Plan(fit, held, w)).project(residual).held for w in (None, whole)]
    assert np.allclose(*both, atol=1e-10)


def test_a_fold_does_not_go_where_the_fit_to_all_rows_may_not() -> None:
    source = np.random.default_rng(3)
    columns = source.standard_normal((200, 2))
    noise = source.standard_normal(200)
    whole = np.arange(200) < 160
    fit = whole & (np.arange(200) % 2 == 0)
    plan = Plan(fit, whole & ~fit, whole)

    def held(residual: np.ndarray) -> np.ndarray:
        session = builders.evidence(fitted=whole)
        model = builders.model(session, residual=residual, columns=Angular.of_matrix(columns))
        (found,) = model.holdout_residuals([plan])
        return found

    # A parameter at its bound leaves a slope that no fit may take: nor may a fold.
    free = noise - columns @ np.linalg.lstsq(columns[whole], noise[whole])[0]
    bound = free + 2.0 * columns[:, 1]
    assert np.allclose(held(bound) - held(free), 2.0 * columns[plan.held, 1], atol=1e-9)
    assert np.linalg.norm(held(free)) > np.linalg.norm(free[plan.held])


def test_waves_of_multiples_of_an_order_are_those_of_each_alone() -> None:
    position = np.linspace(-7.0, 9.0, 301)
    orders = [0.35 * k for k in range(1, 81)]
    together = waves_of(orders, position)
    each = np.stack([waves_of([0.1, order], position)[:, 1] for order in orders], axis=1)
    assert np.abs(together - each).max() < 1e-12


def test_numbers_stay_and_what_ran_away_becomes_numbers() -> None:
    whole = np.array([1.0, -2.0])
    assert finite(whole) is whole
    assert whole.tolist() == [1.0, -2.0]
    ran = np.array([np.nan, np.inf, -np.inf, 3.0])
    assert finite(ran.copy(), 1e6).tolist() == [1e6, 1e6, -1e6, 3.0]
    assert np.all(np.isfinite(finite(ran)))
    assert ran[0] == 0.0


def test_every_effect_has_candidates_within_its_bounds(evidence: Evidence) -> None:
    scales = scales_of(evidence, evidence.plant)
    assert scales.speeds[0] < scales.speeds[1]
    for record in st.effects():
        found = candidates(record, scales)
        assert found, record.name
        for each in found:
            assert set(each.shape) == {shape.parameter for shape in record.shapes}
            for parameter in record.parameters:
                if parameter.name in each.shape:
                    low, high = parameter.bounds
                    assert low <= each.shape[parameter.name] <= high


@pytest.mark.parametrize("record", st.effects(), ids=lambda record: record.name)
def test_an_effect_is_drawn_within_its_bounds_however_strong_its_estimate_is(
    evidence: Evidence, record: EffectRecord
) -> None:
    candidate = candidates(record, scales_of(evidence, evidence.plant))[0]
    bounds = {p.name: p.bounds for p in record.parameters}
    waves = [candidate, replace(candidate, second=True)] if record.second else [candidate]
    plant = true_plant()
    for wave in waves:
        for gain in (3.0, -3.0, 1e12, -1e12, math.inf, math.nan):
            strong = with_effect(plant, wave, [gain] * len(record.gains))
            strong.motor()
            effect = next(each for each in strong.effects if each.name == record.name)
            for name, parameter in effect.parameters.items():
                low, high = bounds[name]
                assert low <= parameter.value <= high
        plant = with_effect(plant, wave, [0.01] * len(record.gains))


def test_findings_hold_null_where_an_interval_is_open() -> None:
    unknown = FitParameter(0.1, math.inf, (-math.inf, math.inf), "N·m", "", 0.0)
    known = replace(unknown, stderr=0.01, ci95=(0.08, 0.12))
    values = {"effects.cogging.cosine": unknown, "effects.cogging.sine": known}
    cause = Cause("cogging", "cogging", True, (), values, None, "", "", "", "position")
    found = Diagnosis("missing_effect", "", true_plant(), effects=(cause,))
    text = found.to_json()
    (entry,) = json.loads(text, parse_constant=pytest.fail)["effects"]
    assert entry["parameters"]["effects.cogging.cosine"]["ci95"] == [None, None]
    assert entry["parameters"]["effects.cogging.sine"]["ci95"] == [0.08, 0.12]
    assert "inf" not in text
    assert value_words("cosine", unknown) == "cosine 0.1 N·m (not determined)"
    assert value_words("sine", known) == "sine 0.1 N·m (0.08 to 0.12)"
    ended = replace(known, at_bound="lower")
    assert value_words("sine", ended) == "sine 0.1 N·m (0.08 to 0.12, at its lower bound)"


def test_an_effect_that_the_law_holds_is_not_offered_again() -> None:
    stribeck = next(record for record in st.effects() if record.name == "stribeck")
    table = {"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb", "coulomb": 0.3}}
    assert not present(st.Plant.from_dict(table), stribeck)
    table["friction"] |= {"breakaway": 0.4, "stribeck_velocity": 0.1}
    assert present(st.Plant.from_dict(table), stribeck)


def test_unknown_names_are_refused_with_the_nearest_one() -> None:
    with pytest.raises(st.InputError, match="did you mean 'cogging'"):
        excluded_names(("coging",))
    with pytest.raises(st.InputError, match="did you mean 'coulomb'"):
        st.diagnose(true_plant(), recorded(0), laws=("coulom",))
    for wrong in ({"surrogates": 2}, {"seed": -1}, {"threads": 0}):
        with pytest.raises(st.InputError, match=next(iter(wrong))):
            st.diagnose(true_plant(), recorded(0), **wrong)


def test_a_gain_is_the_share_of_power_removed_with_an_interval_that_holds_it() -> None:
    source = np.random.default_rng(1)
    before = source.standard_normal(4000)
    blocks = np.repeat(np.arange(20), 200)
    from stiction.diagnosis.data.evidence import Cells

    cells = Cells(blocks, blocks * 0, blocks * 0, ("",))
    test = HeldOut((before, 0.5 * before), np.ones(4000), before, cells, ())
    gain = gain_of(test, 0, 1, seed=0)
    assert gain.value == pytest.approx(0.75)
    assert gain.ci95 == pytest.approx((0.75, 0.75))
    assert gain_of(test, 0, 0, seed=0).value == 0.0


def test_the_minimum_is_found_within_bounds_and_beyond_a_kink() -> None:
    def residual(x: np.ndarray) -> np.ndarray:
        return np.array([10.0 * (x[1] - x[0] ** 2), 1.0 - x[0]])

    def jacobian(x: np.ndarray) -> np.ndarray:
        return np.array([[-20.0 * x[0], 10.0], [-1.0, 0.0]])

    wide = (np.full(2, -np.inf), np.full(2, np.inf))
    keywords = {"most": 200, "tolerance": 1e-12}
    start, scale = np.array([-1.2, 1.0]), np.ones(2)
    found = levenberg_marquardt(residual, jacobian, start, wide, scale, **keywords)
    assert found.converged
    assert found.x == pytest.approx([1.0, 1.0], abs=1e-6)
    tight = (np.array([-2.0, -2.0]), np.array([0.5, 2.0]))
    found = levenberg_marquardt(residual, jacobian, start, tight, scale, **keywords)
    assert found.x == pytest.approx([0.5, 0.25], abs=1e-6)

    def kinked(x: np.ndarray) -> np.ndarray:
        return np.array([x[0] - 2.0, 0.3 if x[0] < 1.0 else 0.0, 3.0])

    caught = levenberg_marquardt(
        kinked, lambda x: np.array([[0.0], [0.0], [1e-9]]), np.zeros(1),
        (np.full(1, -9.0), np.full(1, 9.0)), np.ones(1), **keywords,
    )  # fmt: skip
    beyond = escape(
        lambda x: float(kinked(x) @ kinked(x)),
        np.ones((1, 1)),
        caught,
        (np.full(1, -9.0), np.full(1, 9.0)),
    )
    assert beyond is not None
    assert beyond[0] > 1.0


def test_intervals_are_students() -> None:
    assert interval_width(2) == pytest.approx(12.706, abs=1e-3)
    assert interval_width(10_000) == pytest.approx(1.960, abs=1e-3)


def tried(
    worth: float,
    parameters: int,
    reason: str = "",
    *,
    by_blocks: bool = False,
    family: str = "alone",
    uneven: float = 0.0,
    gain: float = 0.3,
) -> Trial:
    """A trial that explains what all others explain."""
    own = builders.score(
        builders.candidate(f"{worth}", parameters=parameters, family=family),
        0.1,
        heldout=0.1,
        contributed=np.ones(5),
    )
    refit = builders.model(blocks=(np.linspace(1.0, 2.0, 30), np.linspace(2.0, 1.0, 30)))
    told = {"gain": gain, "z": 3.0, "by_blocks": by_blocks, "uneven": uneven}
    return builders.trial(own, worth, reason, refit=refit, **told)


def test_no_stranger_is_named_where_what_explains_most_imitates() -> None:
    imitates = tried(1.0, 1, "imitates something else", family="offset", uneven=0.6)
    relative, stranger = tried(0.5, 1, family="offset"), tried(0.5, 1, family="angle")
    assert choose([imitates, stranger]) is None
    assert strangers([imitates, stranger, relative], stranger) == [imitates]
    assert strangers([imitates, stranger, relative], relative) == []
    # What a relative of the winner explains as well, in another form, is no stranger.
    form = tried(0.95, 1, "imitates something else", family="angle", uneven=OUT_OF_RANGE)
    assert strangers([imitates, stranger, form], stranger) == []
    chosen = choose([imitates, relative])
    assert chosen is not None
    # A member of its family that explains far more keeps it undecided, even if it does so unevenly.
    assert (chosen.winner, chosen.rivals) == (relative, (imitates,))
    chosen = choose([replace(imitates, worth=0.55), relative])
    assert chosen is not None
    assert chosen.decided


def test_rows_that_do_not_excite_an_effect_do_not_tell_it_from_the_winner() -> None:
    winner, relative = tried(1.0, 1), tried(0.95, 2, "hardly excited", by_blocks=True, gain=-0.01)
    chosen = choose([winner, relative])
    assert chosen is not None
    assert (chosen.winner, chosen.rivals) == (winner, (relative,))
    # Whose gain would have to be whole and is not is the winner in another form.
    chosen = choose([winner, replace(tried(0.95, 2, "partly"), uneven=OUT_OF_RANGE, partly=True)])
    assert chosen is not None
    assert chosen.decided
    # What the rows held out do speak about and against is no rival.
    chosen = choose([winner, tried(0.95, 2, "does not help on rows held out", gain=-0.01)])
    assert chosen is not None
    assert chosen.decided


def test_what_leaves_nothing_for_another_and_much_in_its_place_is_told_from_it() -> None:
    winner, relative = tried(1.0, 1, family="a"), tried(0.9, 1, family="a")
    for encompasses in (True, False):
        chosen = choose([winner, relative], lambda *_, told=encompasses: told)
        assert chosen is not None
        assert (chosen.winner, chosen.decided) == (winner, encompasses)
    # Within 4 % it may be the same cause in another form, and nothing tells them apart.
    chosen = choose([winner, tried(0.97, 1, family="a")], lambda *_: True)
    assert chosen is not None
    assert not chosen.decided


@pytest.mark.parametrize(
    ("left", "more", "told"),
    [((0.2, 0.1), (0.01, 0.1), True), ((0.2, 0.1), (0.06, -0.1), True),
     ((0.2, 0.1), (0.06, 0.1), False), ((0.06, 0.1), (0.01, 0.1), False),
     ((0.2, -0.1), (0.01, 0.1), False)],
)  # fmt: skip
def test_a_candidate_encompasses_another_where_only_one_has_something_left_for_the_other(
    left: tuple[float, float], more: tuple[float, float], told: bool
) -> None:
    one, other = tried(1.0, 1), tried(0.9, 1)

    def score(of: Trial, value: float, heldout: float) -> Score:
        return builders.score(of.candidate, value, threshold=0.02, heldout=heldout)

    # What each model leaves for the other candidate.
    kept = [(other.model, [score(one, *left)]), (one.model, [score(other, *more)])]
    assert Screening.encompasses(replace(builders.screening(), kept=kept), one, other) is told


def test_only_what_passed_by_itself_leaves_waves_aside() -> None:
    """Of a name that was itself refused, or that stands for its family, nothing is left aside."""
    one = np.ones(5)
    blocks = np.linspace(1.0, 2.0, 30), np.linspace(2.0, 1.0, 30)
    # A cogging of one period a turn, as near as few orders are, is an unbalance with an order.
    waved = builders.plant(effects=[{"name": "cogging", "order": 1.0, "cosine": 0.1, "sine": 0.1}])
    told = builders.fitted(cogging__order=builders.number(1.0, stderr=1e-4))
    own = builders.model(blocks=blocks)
    of_any_order = builders.model(fitted=waved, blocks=blocks, fit_result=told)

    def unbalance(worth: float, reason: str = "", **stated: Any) -> Trial:
        score = builders.score("gravity_unbalance", contributed=one)
        return builders.trial(score, worth, reason, refit=own, **stated)

    def cogging(worth: float) -> Trial:
        any_order = replace(builders.candidate("cogging"), free=("order",))
        score = builders.score(any_order, contributed=one)
        return builders.trial(score, worth, refit=of_any_order)

    winner, other = unbalance(1.0), cogging(0.97)
    chosen = choose([winner, other])
    assert chosen is not None
    assert (chosen.decided, chosen.rivals, chosen.aside) == (True, (), (other,))
    assert "by chance" in listing.row_of_trial(other, chosen).reason
    refused = unbalance(1.0, "its held-out gain is 1.80 standard errors", by_blocks=True)
    chosen = choose([other, refused])
    assert chosen is not None
    assert (chosen.winner, chosen.decided) == (refused, False)
    chosen = choose([replace(winner, uneven=0.2), other])
    assert chosen is not None
    assert not chosen.decided


def test_a_rest_of_a_contact_without_a_spring_is_looked_for_in_two_lengths() -> None:
    units = dict.fromkeys(("presliding", "resting", "loading"), 1.0)
    own, none = (Scales((0.1, 1.0), (1.0,), True, units, finer) for finer in (1.0, 0.1))
    records = {record.name: record for record in st.effects()}
    for name in ("dwell_strengthening", "rate_dependent_breakaway"):
        one, two = (candidates(records[name], scales) for scales in (own, none))
        assert len(two) == 2 * len(one)
        assert {each.shape["window"] for each in two} == {1.0, 0.1}
    # From anywhere a refit finds the length of others.
    gap = records["backlash"]
    assert len(candidates(gap, none)) == len(candidates(gap, own))


def test_every_row_has_a_reason() -> None:
    passes, refused = tried(0.5, 1), tried(1.0, 1, "imitates something else", family="offset")
    for choice in (None, choose([passes])):
        for trial in (passes, refused):
            assert listing.row_of_trial(trial, choice).reason
    assert "imitate" in listing.row_of_trial(passes, None).reason


def test_a_strength_that_is_not_quite_even_stands_for_its_family() -> None:
    winner, relative = tried(1.0, 1, family="slow", uneven=0.2), tried(0.2, 1, family="slow")
    chosen = choose([winner, relative, tried(0.2, 1, family="angle")])
    assert chosen is not None
    assert any(trial is relative for trial in chosen.rivals)
    assert not chosen.decided


@pytest.mark.parametrize("uneven", [0.0, 0.2])
def test_twins_are_one_thing_unless_its_strength_differs(uneven: float) -> None:
    # Cogging once a turn is an unbalance; what is uneven as both may be neither.
    winner, twin = (tried(1.0, n, family="wave", uneven=uneven) for n in (1, 2))
    chosen = choose([winner, twin])
    assert chosen is not None
    assert chosen.decided == (uneven == 0.0)


def test_a_cause_that_is_not_told_stands_under_the_simplest_of_the_best() -> None:
    simple, flexible = tried(0.95, 1), tried(1.0, 3)
    chosen = choose([flexible, simple])
    assert chosen is not None
    assert (chosen.winner, chosen.rivals) == (simple, (flexible,))
    assert not chosen.decided
    spread, lesser = tried(1.0, 1, "spread over blocks", by_blocks=True), tried(0.3, 1)
    chosen = choose([spread, lesser])
    assert chosen is not None
    assert chosen.winner is spread
    # Refused for anything else it may keep another undecided, and never stands for a cause.
    chosen = choose([tried(1.0, 1, "explains no more than noise"), lesser])
    assert chosen is not None
    assert chosen.winner is lesser
    assert not chosen.decided
    assert choose([spread]) is None


@pytest.mark.parametrize(
    ("worth", "more", "decided"),
    [
        # Power that the other leaves more of in each block, against a scatter of 0.3.
        pytest.param(0.7, 0.20, True, id="far and sure"),
        pytest.param(0.7, 0.05, False, id="far, but it varies from block to block"),
        pytest.param(0.9, 0.20, True, id="near, but every block says so"),
        pytest.param(0.9, 0.135, False, id="near, and sure enough for one that is far"),
        pytest.param(0.98, 0.9, False, id="the same but for what another form may do"),
    ],
)
def test_blocks_have_to_be_certain_of_what_is_near(
    worth: float, more: float, decided: bool
) -> None:
    scatter = np.tile([-0.3, 0.3], 15)
    winner, other = tried(1.0, 1), tried(worth, 1)
    left = tuple(block + more + scatter for block in winner.model.blocks)
    other = replace(other, model=builders.model(blocks=(left[0], winner.model.blocks[1])))
    chosen = choose([winner, other])
    assert chosen is not None
    assert (chosen.winner, chosen.decided) == (winner, decided)


def test_relatives_named_beside_each_other_are_not_decided() -> None:
    trials = [tried(1.0, 1, family=family) for family in ("angle", "slow", "angle")]
    selection = builders.search(*trials)
    assert [len(relatives(selection, k)) for k in range(3)] == [1, 0, 1]


def test_what_may_be_a_relative_instead_leaves_a_name_undecided() -> None:
    """A weight was told as a constant, or itself, and a sure cogging beside it."""
    constant, weight, cogging, slow = (
        tried(worth, 1, family=family)
        for worth, family in ((1.0, "offset"), (0.9, "wave"), (0.8, "wave"), (0.7, "slow"))
    )
    choices = [Choice(constant, (weight,)), Choice(cogging, ()), Choice(slow, ())]
    selection = replace(builders.search(), choices=choices)
    assert [relatives(selection, k) for k in range(3)] == [[], ["0.9"], []]


@pytest.mark.slow
def test_an_interrupted_refit_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*given: Any, **named: Any) -> Model:
        model = fit_model(*given, **named)
        return replace(model, solution=replace(model.solution, interrupted=True))

    # An effort that nobody logged: something to be found.
    recordings = [
        st.Recording(whole.time, whole.input - 0.03, whole.position, role=role)
        for role, whole in (
            (role, recorded(k)) for k, role in enumerate(("train", "select", "test"))
        )
    ]
    plant = true_plant()
    assert st.diagnose(plant, recordings, surrogates=4).effects
    monkeypatch.setattr("stiction.diagnosis.selection.trials.fit_model", interrupted)
    found = st.diagnose(plant, recordings, surrogates=4)
    assert not found.success
    assert found.effects == ()
    assert found.baseline is not None


def test_an_interrupted_diagnosis_keeps_the_best_so_far(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("stiction.diagnosis.selection.trials.screen", interrupted)
    recordings = [recorded(k, role=role) for k, role in enumerate(("train", "select", "test"))]
    found = st.diagnose(true_plant(), recordings, surrogates=4)
    assert not found.success
    assert "interrupted" in found.message
    assert found.baseline is not None
    true_plant().save(tmp_path / "plant.toml")
    lines = ['plant = "plant.toml"']
    for k, recording in enumerate(recordings):
        columns = {"time_s": recording.time, "torque_nm": recording.input}
        np.savez(tmp_path / f"{k}.npz", **columns, position_rad=recording.position)
        lines.append(f'[[recordings]]\nfile = "{k}.npz"\nrole = "{recording.role}"')
    (tmp_path / "session.toml").write_text("\n".join(lines))
    arguments = ["diagnose", str(tmp_path / "session.toml"), "--surrogates", "4"]
    assert run([*arguments, "-o", str(tmp_path / "out")]) == 130
    assert "interrupted" in capsys.readouterr().err
    written = json.loads((tmp_path / "out" / "findings.json").read_text("utf-8"))
    assert written["baseline"]["law"] == "maxwell_slip"
    assert (tmp_path / "out" / "report.html").exists()


def test_findings_hold_every_field_that_others_build_on() -> None:
    recordings = [recorded(k, role=role) for k, role in enumerate(("train", "select", "test"))]
    found = st.diagnose(true_plant(), recordings, surrogates=4, laws=("coulomb",)).to_dict()
    assert list(found) == [
        "schema", "verdict", "sentence", "effects", "gain", "gap_closed", "evidence", "candidates",
        "laws", "better_law", "baseline", "extended", "unexplained", "advice", "data", "version",
        "seed", "smallest", "alpha", "seconds",
    ]  # fmt: skip
    assert found["schema"] == 1
    assert {row["name"] for row in found["candidates"]} == {e.name for e in st.effects()}
    for row in found["candidates"]:
        assert set(row) == {"name", "score", "threshold", "select_gain", "reason"}
        assert row["reason"]
    assert [set(row) for row in found["laws"]] == [
        {"law", "heldout_gain", "heldout_gain_ci95", "reason"}
    ]
    for model in (found["baseline"], found["extended"]):
        assert set(model) == {
            "law", "effects", "parameters", "unit", "train_rms", "select_rms", "heldout_rms",
            "noise_floor_rms", "replay", "begins",
        }  # fmt: skip
        for parameter in model["parameters"].values():
            assert set(parameter) == {"value", "ci95", "unit", "at_bound"}
    assert set(found["data"]) == {
        "checks", "split", "replicates", "residual", "hashes", "noise", "chosen", "complete",
        "input_ahead",
        "through",
    }  # fmt: skip
    assert [each["recording"] for each in found["data"]["noise"]] == ["recording 1", "recording 2"]
    assert all(each["effort"] > 0.0 for each in found["data"]["noise"])
    assert found["data"]["complete"]
    if not found["effects"]:
        assert found["extended"] == found["baseline"]


def test_a_drive_that_gives_nothing_leaves_nothing_to_explain() -> None:
    evidence = Evidence(true_plant(), [recorded(1, role="train"), recorded(2, role="select")])

    def given(deadband: float) -> float:
        plant = replace(
            true_plant(),
            effects=(Effect("drive_deadband", {"deadband": Parameter(deadband)}),),
        )
        return builders.model(evidence, plant).relative_input_power

    assert given(0.01) == 1.0
    assert 0.0 < given(0.4) < 0.5
    assert given(5.0) == LEAST_GIVEN
