"""Quantiles against those of SciPy."""

from __future__ import annotations

import pytest
from scipy.special import fdtri, stdtrit

from stiction.fitting.quantiles import f_quantile, t_quantile

DEGREES = (1, 2, 3, 5, 10, 33, 234, 3600, 100_000)


@pytest.mark.parametrize("degrees", DEGREES)
@pytest.mark.parametrize("share", [0.6, 0.95, 0.975, 0.9999])
def test_quantiles_of_t(degrees: int, share: float) -> None:
    assert t_quantile(degrees, share) == pytest.approx(stdtrit(degrees, share), rel=1e-8)


@pytest.mark.parametrize("under", DEGREES)
@pytest.mark.parametrize("over", [1, 2, 5, 40])
def test_quantiles_of_f(over: int, under: int) -> None:
    assert f_quantile(over, under, 0.95) == pytest.approx(fdtri(over, under, 0.95), rel=1e-8)
