"""Columns of recordings beside shared ones, and folds over them, against the matrix written out."""

from __future__ import annotations

import numpy as np
import pytest

from stiction.diagnosis.data.evidence import Plan
from stiction.diagnosis.screening.folds import over_plans
from stiction.diagnosis.screening.regression import project
from stiction.fitting.angular import FLAT, Angular

RECORDINGS, EACH, SHARED = 6, 80, 4
ROWS = RECORDINGS * EACH
OF = np.repeat(np.arange(RECORDINGS), EACH)


def columns(seed: int = 0) -> tuple[Angular, np.ndarray]:
    """Slow columns of all, and of every recording but the third two that fade; written out, too."""
    source = np.random.default_rng(seed)
    blocks, size, row = [], SHARED, 0
    whole = np.zeros((ROWS, SHARED + 2 * (RECORDINGS - 1)))
    for recording in range(RECORDINGS):
        own = np.cumsum(source.standard_normal((SHARED, EACH)), axis=1)
        own[-1] = 2.0 * own[0]
        places = list(range(SHARED))
        if recording != 2:
            faded = np.exp(-np.outer([1.0, 3.0], np.linspace(0.0, 2.0, EACH)))
            own, places = np.vstack([own, faded]), [*places, size, size + 1]
            size += 2
        whole[row : row + EACH, places] = own.T
        blocks.append((places, own))
        row += EACH
    return Angular.of_blocks(blocks, SHARED, size), whole


def targets(seed: int = 1) -> np.ndarray:
    """What is regressed."""
    return np.cumsum(np.random.default_rng(seed).standard_normal((ROWS, 3)), axis=0)


def plans() -> list[Plan]:
    """Recordings left out, parts of recordings left out, and all rows fitted."""
    whole = OF < 5
    found = [Plan(whole & (k != OF), np.equal(OF, k), whole) for k in (0, 2, 4)]
    parts = np.arange(ROWS) // 30 % 3
    found += [Plan(whole & (parts != k), whole & np.equal(parts, k), whole) for k in range(3)]
    return [*found, Plan(whole, np.ones(ROWS, dtype=bool)), Plan(OF < 3, OF >= 3)]


def test_it_is_the_matrix_written_out() -> None:
    angular, whole = columns()
    some, gains = OF % 2 == 1, np.random.default_rng(2).standard_normal((angular.size, 2))
    assert np.array_equal(angular.matrix(), whole)
    assert np.array_equal(angular.of_rows(some).matrix(), whole[some])
    assert angular.times(gains) == pytest.approx(whole @ gains, abs=1e-12)
    assert angular.products(targets()) == pytest.approx(whole.T @ targets(), rel=1e-12)
    assert angular.normal() == pytest.approx(whole.T @ whole, rel=1e-12)
    assert angular.sizes == pytest.approx(np.linalg.norm(whole, axis=0), rel=1e-12)
    chosen, factor = np.array([1, 5, 7]), np.arange(1.0, angular.size + 1.0)
    assert angular.scale(chosen, factor).matrix() == pytest.approx((whole * factor)[:, chosen])
    piece, weight = np.arange(ROWS) // 7, targets()[:, 0]
    by_hand = np.array([weight[piece == k] @ whole[piece == k] for k in range(piece[-1] + 1)])
    assert angular.sums_by(piece, weight) == pytest.approx(by_hand, abs=1e-9)
    assert np.array_equal(angular.with_column(1, weight).matrix()[:, 1], weight)


def test_directions_span_what_columns_do_and_drop_what_depends() -> None:
    angular, whole = columns()
    directions, made = angular.orthogonal_basis()
    found = directions.matrix()
    assert found.T @ found == pytest.approx(np.eye(directions.size), abs=1e-12)
    assert directions.size == angular.size - 1 == np.linalg.matrix_rank(whole)
    assert whole @ made == pytest.approx(found, abs=1e-10)


@pytest.mark.parametrize("number", range(8))
def test_a_base_of_recordings_projects_as_the_matrix_does(number: int) -> None:
    angular, whole = columns()
    plan = plans()[number]
    own = project(angular, plan).project(targets())
    written = project(Angular.of_matrix(whole), plan).project(targets())
    assert own.fit == pytest.approx(written.fit, abs=1e-9)
    assert own.held == pytest.approx(written.held, abs=1e-8)


def test_without_folds_held_rows_are_predicted_by_least_squares() -> None:
    angular, whole = columns()
    plan, y = plans()[-1], targets()
    used = np.any(whole[plan.fit] != 0.0, axis=0)
    gains = np.linalg.lstsq(whole[plan.fit][:, used], y[plan.fit], rcond=FLAT)[0]
    held = project(angular, plan).project(y).held
    assert held == pytest.approx(y[plan.held] - whole[plan.held][:, used] @ gains, abs=1e-8)


def test_all_plans_at_once_are_each_by_itself() -> None:
    angular, _ = columns()
    together = list(over_plans(angular, targets(), plans()))
    for plan, found in zip(plans(), together, strict=True):
        alone = project(angular, plan).project(targets())
        assert found.held == pytest.approx(alone.held, abs=1e-8)
        assert len(found.fit) < len(alone.fit)
        assert found.fit.T @ found.fit == pytest.approx(alone.fit.T @ alone.fit, rel=1e-9)
