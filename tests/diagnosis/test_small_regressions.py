"""Pieces that go without data: gains within bounds, spectra of unlike rows, data that hide all."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import lsq_linear
from tests.diagnosis.builders import EFFECTS, search

from stiction.diagnosis.adequacy.periodic import frequency_view
from stiction.diagnosis.data.evidence import Cells
from stiction.diagnosis.findings.verdict import verdict_of
from stiction.diagnosis.records import CandidateRow
from stiction.diagnosis.screening.regression import bounded_gains


def test_gains_within_bounds_are_those_of_the_bounded_least_squares() -> None:
    source = np.random.default_rng(3)
    columns = source.standard_normal((40, 50, 2)) @ np.array([[1.0, 0.8], [0.0, 0.4]])
    wanted = source.standard_normal((40, 50))
    low = np.tile([0.0, -0.05], (40, 1))
    high = np.tile([np.inf, 0.1], (40, 1))
    normal = columns.transpose(0, 2, 1) @ columns
    product = np.einsum("mnq,mn->mq", columns, wanted)
    best = np.linalg.solve(normal, product[:, :, None])[:, :, 0]
    gains = bounded_gains(normal, product, best, low, high)
    assert np.any(gains != np.clip(best, low, high))
    for k in range(40):
        right = lsq_linear(columns[k], wanted[k], (low[k], high[k]), tol=1e-13).x
        np.testing.assert_allclose(gains[k], right, atol=1e-6)
        # 0 is within the bounds, so that no gains take less than nothing.
        assert 2.0 * gains[k] @ product[k] - gains[k] @ normal[k] @ gains[k] >= -1e-12


@pytest.mark.parametrize("order", [(0, 1), (1, 0)])
def test_a_line_is_where_it_is_in_recordings_of_unlike_rows(order: tuple[int, int]) -> None:
    parts, blocks, spacings, places = [], [], [], []
    for place, k in enumerate(order):
        spacing = (0.005, 1.0 / 150.0)[k]
        time = np.arange(round(30.0 / spacing)) * spacing
        noise = np.random.default_rng(k).standard_normal(len(time))
        parts.append(np.sin(2 * np.pi * 30.0 * time) + 0.5 * noise)
        blocks.append(np.floor(time + 1e-9).astype(int) + 100 * place)
        spacings.append(np.full(len(time), spacing))
        places.append(np.full(len(time), place))
    place, left = np.concatenate(places), np.concatenate(parts)
    null = 0.5 * np.random.default_rng(9).standard_normal((len(left), 24))
    view = frequency_view(
        Cells(np.concatenate(blocks), place, place, ("a",)),
        np.concatenate(spacings),
        np.column_stack([left, null]),
        np.ones(len(left)),
        1.0,
    )
    assert view is not None
    assert view.at[np.argmax(view.mean)] == pytest.approx(30.0, abs=0.1)
    assert np.max(view.mean) == pytest.approx(1.0, rel=0.1)
    # Of 75 and of 100 Hz of noise only the lines that both have are looked at.
    assert view.share == pytest.approx(0.5 / (0.5 + 0.25 * 0.875), abs=0.02)


@pytest.mark.parametrize(("hidden", "verdict"), [(2, "not_testable"), (1, "nothing_missing")])
def test_data_that_hide_every_effect_that_was_asked_tell_nothing(hidden: int, verdict: str) -> None:
    """Effects that this plant cannot have were never asked."""
    asked = {name: CandidateRow(name, 0.01, 0.02, None, "") for name in ("stribeck", "cogging")}
    refused = {"goal_rate_limit": CandidateRow("goal_rate_limit", None, None, None, "no servo")}
    blind = [EFFECTS[name] for name in list(asked)[:hidden]]
    selection = search(rows={**asked, **refused}, blind=blind)
    assert verdict_of(selection, (), True) == verdict
