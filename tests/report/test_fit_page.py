"""The page of a fit says how its parameters hang together, and where a simulation would go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.reference.coulomb_reference import simulate_coulomb

import stiction as st
from stiction.fitting.result import FitResult
from stiction.report.fit_page import fit_page


@pytest.fixture(scope="module")
def recording() -> st.Recording:
    time = np.arange(6000) * 1e-3
    effort = sum(0.45 * np.sin(2 * np.pi * f * time + f) for f in (0.4, 1.1, 2.3))
    run = simulate_coulomb(effort[:-1], 1e-3, inertia=0.0076, coulomb=0.3, breakaway=0.3)
    position = np.round(np.concatenate([[0.0], run["position"]]) / 2e-5) * 2e-5
    return st.Recording(time, effort, position)


@pytest.fixture(scope="module")
def found(recording: st.Recording) -> FitResult:
    table = {"body": {"inertia": 0.007}, "friction": {"law": "coulomb"}}
    return st.fit(st.Plant.from_dict(table), recording)


@pytest.mark.long
def test_the_pairs_that_hang_together_most_stand_first(
    found: FitResult, recording: st.Recording
) -> None:
    page = fit_page(found, [recording], "Fit")
    names = list(found.parameters)
    values = np.abs(np.asarray(found.correlations))
    np.fill_diagonal(values, 0.0)
    strongest = np.unravel_index(int(np.argmax(values)), values.shape)
    first = page[page.index("<tbody>", page.index("Correlations")) :].split("</tr>")[0]
    assert all(f"<code>{names[k]}</code>" in first for k in strongest)


def test_a_pair_that_the_data_do_not_tell_apart_is_said(
    found: FitResult, recording: st.Recording
) -> None:
    size = len(found.parameters)
    apart = replace(found, correlations=np.eye(size))
    assert "No two parameters hang together strongly" in fit_page(apart, [recording], "Fit")
    together = np.eye(size)
    together[0, 1] = together[1, 0] = -0.99
    page = fit_page(replace(found, correlations=together), [recording], "Fit")
    assert f"1 of {size * (size - 1) // 2} pairs hang together strongly" in page
    assert "−0.99" in page


def test_the_free_run_is_drawn_beside_the_effort(found: FitResult, recording: st.Recording) -> None:
    page = fit_page(found, [recording], "Fit")
    assert page.count("<figure>") == 2
    assert "by the recorded input alone (free run)" in page
