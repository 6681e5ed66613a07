"""The screening, on made-up columns: it must be the regression that it stands for."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st
from stiction.diagnosis.data.evidence import Plan
from stiction.diagnosis.defaults import ALPHA
from stiction.diagnosis.screening.candidates import Candidate, Scales, candidates
from stiction.diagnosis.screening.regression import project
from stiction.diagnosis.screening.screen import FORMS, Problem, Score, _threshold, screen
from stiction.diagnosis.screening.signatures import Signatures
from stiction.fitting.angular import Angular
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect

ROWS, FITTED, SURROGATES = 600, 400, 8
NAMES = ("cogging", "torque_bias", "input_delay")


def test_projection_takes_off_what_the_base_explains_and_the_same_from_held_rows() -> None:
    source = np.random.default_rng(0)
    base = source.standard_normal((200, 3))
    columns, fit = Angular.of_matrix(base), np.arange(200) < 120
    projected = project(columns, Plan(fit, ~fit)).project(base @ np.array([1.0, -2.0, 3.0]))
    assert np.allclose(projected.fit, 0.0, atol=1e-10)
    assert np.allclose(projected.held, 0.0, atol=1e-10)
    other_base = project(columns, Plan(fit, ~fit))
    other = other_base.project(source.standard_normal(200))
    assert np.allclose(base[fit].T @ other.fit, 0.0, atol=1e-10)
    many = source.standard_normal((70, 120)).T
    left, share = other_base.off(many), other_base.directions.products(many)
    assert np.allclose(left.T @ left, many.T @ many - share.T @ share, rtol=0.0, atol=1e-12)


def test_a_second_wave_has_another_order() -> None:
    (record,) = (each for each in st.effects() if each.name == "cogging")
    scales = Scales((0.1, 1.0), (1.0, 2.0, 3.0), True, {})
    whole = tuple(candidates(record, scales))
    columns, every = np.zeros((4, 2 * len(whole))), np.ones(4, dtype=bool)
    effect = Effect("cogging", {"order": Parameter(2.0, fixed=True)})
    second = Signatures.from_columns(whole, columns, every).second_of(effect)
    assert [each.shape["order"] for each in second.candidates] == [1.0, 3.0]
    assert all(each.second for each in second.candidates)
    # Where an order is free a neighbour may come to it as well.
    free = tuple(candidates(record, Scales((0.1, 1.0), (1.0, 2.0, 3.0, 4.0, 5.0), False, {})))
    second = Signatures.from_columns(free, np.zeros((4, 10)), every).second_of(effect)
    assert [each.shape["order"] for each in second.candidates] == [4.0, 5.0]


def tried() -> tuple[Candidate, ...]:
    records = {record.name: record for record in st.effects()}
    scales = Scales((0.1, 1.0), (1.0, 2.0, 3.0), True, {})
    return tuple(each for name in NAMES for each in candidates(records[name], scales))


def screened(
    columns: np.ndarray, base: np.ndarray, residual: np.ndarray, alpha: float = ALPHA
) -> dict[str, Score]:
    """Scores of all candidates, of which each has as many of the columns as it has gains."""
    every = tried()
    gains = sum(len(each.gains) for each in every)
    fit = np.arange(ROWS) < FITTED
    null = np.random.default_rng(3).standard_normal((ROWS, SURROGATES))
    block = np.arange(ROWS) // 20
    problem = Problem(residual, Angular.of_matrix(base), null[fit], block, fit, [Plan(fit, ~fit)])
    signatures = Signatures.from_columns(every, columns[:, :gains], fit)
    return {score.candidate.name: score for score in screen(problem, signatures, 1.0, alpha)}


@pytest.mark.parametrize("alpha", [0.01, 0.1])
def test_noise_passes_within_a_few_times_of_the_level(alpha: float) -> None:
    # The greatest of a grid of a dozen squares of noise, in each of eleven independent forms;
    # two dozen replays know their own spread no better.
    rng = np.random.default_rng(8)
    passed = 0
    for _ in range(400):
        noise = rng.chisquare(1.0, (12, 24))
        limit = _threshold(noise, np.zeros_like(noise), alpha)
        passed += int(np.sum(np.max(rng.chisquare(1.0, (12, 100)), axis=0) > limit))
    assert FORMS * passed / 40_000 < 5.0 * alpha


def test_a_stricter_level_asks_for_more() -> None:
    rng = np.random.default_rng(9)
    columns, base = rng.standard_normal((ROWS, 40)), rng.standard_normal((ROWS, 3))
    residual = rng.standard_normal(ROWS)
    strict, loose = (screened(columns, base, residual, alpha) for alpha in (1e-9, 0.1))
    assert all(strict[name].threshold > loose[name].threshold for name in strict)


def explained(columns: np.ndarray, base: np.ndarray, residual: np.ndarray) -> float:
    """Share of what the base leaves over the fitted rows that columns explain beside it."""

    def left(by: np.ndarray) -> float:
        by, of = by[:FITTED], residual[:FITTED]
        return float(np.sum((of - by @ np.linalg.lstsq(by, of, rcond=None)[0]) ** 2))

    return 1.0 - left(np.hstack([base, columns])) / left(base)


@pytest.fixture
def source() -> np.random.Generator:
    return np.random.default_rng(7)


def test_a_score_is_what_a_regression_beside_the_base_explains(source: np.random.Generator) -> None:
    columns, base = source.standard_normal((ROWS, 12)), source.standard_normal((ROWS, 4))
    # Nearly within the base: what is left of it must not drown in rounding.
    columns[:, 2:4] = base[:, :2] + 1e-3 * columns[:, 2:4]
    residual = source.standard_normal(ROWS) + 0.3 * columns[:, 2] - 0.3 * base[:, 0]
    found = screened(columns, base, residual)
    every, at = tried(), 0
    best = dict.fromkeys(NAMES, 0.0)
    for each in every:
        own = columns[:, at : at + len(each.gains)]
        best[each.name] = max(best[each.name], explained(own, base, residual))
        at += len(each.gains)
    for name in ("cogging", "torque_bias"):
        assert found[name].score == pytest.approx(best[name], rel=1e-6), name
    # A delay is not negative.
    assert found["input_delay"].score <= best["input_delay"] + 1e-12
    assert np.all(found["input_delay"].gains >= 0.0)


def test_what_the_base_imitates_explains_nothing(source: np.random.Generator) -> None:
    base = source.standard_normal((ROWS, 4))
    columns = base @ source.standard_normal((4, 12))
    found = screened(columns, base, source.standard_normal(ROWS))
    for score in found.values():
        assert score.score == 0.0
        assert score.left == 0.0
        assert not score.testable


def test_columns_that_are_one_and_the_same_explain_nothing_together(
    source: np.random.Generator,
) -> None:
    columns, base = source.standard_normal((ROWS, 12)), source.standard_normal((ROWS, 4))
    columns[:, 1::2] = 2.0 * columns[:, ::2]
    assert screened(columns, base, columns[:, 0])["cogging"].score == 0.0
