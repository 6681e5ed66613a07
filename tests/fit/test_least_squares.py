"""Least squares in the core: recordings with columns of their own, threads, what goes wrong."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction._native import least_squares
from stiction.fitting.levenberg import Minimum, descend, levenberg_marquardt, normal_matrix

ROWS = (30_000, 50_000)
"""Of two recordings; so many that they are divided among threads."""
TRUE = np.array([1.5, 0.7, -0.2, 0.4])
"""Two numbers that both recordings share, one of each alone."""
COLUMNS = ([0, 1, 2], [0, 1, 3])
FREE = (np.full(4, -np.inf), np.full(4, np.inf))


class Bent:
    """y = a·sin(b·x) + c of two recordings, a and b shared, with noise; b by its logarithm."""

    def __init__(self) -> None:
        rng = np.random.default_rng(4)
        self.x = [rng.uniform(-2.0, 2.0, rows) for rows in ROWS]
        self.y = [self.model(x, *TRUE[[0, 1, 2 + k]]) for k, x in enumerate(self.x)]
        self.y = [y + 0.1 * rng.standard_normal(len(y)) for y in self.y]

    @staticmethod
    def model(x: np.ndarray, a: float, b: float, c: float) -> np.ndarray:
        return a * np.sin(b * x) + c

    def residual(self, u: np.ndarray) -> list[np.ndarray]:
        a, b, *c = u[0], np.exp(u[1]), *u[2:]
        recordings = zip(self.x, self.y, c, strict=True)
        return [self.model(x, a, b, own) - y for x, y, own in recordings]

    def slopes(self, u: np.ndarray) -> Any:
        a, b = u[0], np.exp(u[1])
        blocks = [
            (columns, np.array([np.sin(b * x), a * x * np.cos(b * x), np.ones_like(x)]))
            for columns, x in zip(COLUMNS, self.x, strict=True)
        ]
        return blocks, np.diag([1.0, b, 1.0, 1.0])

    def jacobian(self, u: np.ndarray) -> np.ndarray:
        blocks, chain = self.slopes(u)
        whole = np.zeros((sum(ROWS), 4))
        whole[: ROWS[0], COLUMNS[0]], whole[ROWS[0] :, COLUMNS[1]] = (b.T for _, b in blocks)
        return whole @ chain


BEGIN = np.array([1.0, 0.0, 0.0, 0.0])


def found(bent: Bent, **named: Any) -> Minimum:
    usual = {"most": 60, "tolerance": 1e-12}
    return descend(bent.residual, bent.slopes, BEGIN, FREE, np.ones(4), **{**usual, **named})


def test_recordings_with_starts_of_their_own_have_the_minimum_of_the_whole_matrix() -> None:
    bent = Bent()
    own = found(bent)
    assert own.converged
    assert own.x == pytest.approx([TRUE[0], np.log(TRUE[1]), *TRUE[2:]], abs=0.01)
    whole = levenberg_marquardt(
        lambda u: np.concatenate(bent.residual(u)),
        bent.jacobian, BEGIN, FREE, np.ones(4), most=60, tolerance=1e-12,
    )  # fmt: skip
    assert own.x == pytest.approx(whole.x, abs=1e-9)
    assert own.cost == pytest.approx(whole.cost, rel=1e-12)
    jacobian = bent.jacobian(own.x)
    pulls = [(1, 0.0, 3.0)]
    normal = jacobian.T @ jacobian + np.diag([0.0, 9.0, 0.0, 0.0])
    assert normal_matrix(bent.slopes(own.x), pulls, 4) == pytest.approx(normal, rel=1e-9)


def test_a_pull_holds_a_variable_near_its_centre() -> None:
    held = found(Bent(), pulls=[(3, -1.0, 1e4)])
    assert held.x[3] == pytest.approx(-1.0, abs=0.01)


def test_threads_change_no_bit() -> None:
    bent = Bent()

    def bits(threads: int) -> tuple[bytes, float]:
        x, cost, *_ = least_squares(
            bent.residual, bent.slopes, BEGIN, *FREE, np.ones(4), pulls=[], most=60,
            tolerance=1e-12, nothing=0.0, straight=False, damping=0.1, threads=threads,
        )  # fmt: skip
        return x.tobytes(), cost

    assert bits(1) == bits(2) == bits(5)


def _raises(error: BaseException) -> Callable[[np.ndarray], Any]:
    def work(_: np.ndarray) -> Any:
        raise error

    return work


@pytest.mark.parametrize("error", [KeyboardInterrupt(), ZeroDivisionError("in the model")])
def test_what_is_raised_on_the_way_comes_out(error: BaseException) -> None:
    bent = Bent()
    for residual, slopes in ((_raises(error), bent.slopes), (bent.residual, _raises(error))):
        with pytest.raises(type(error)):
            descend(residual, slopes, BEGIN, FREE, np.ones(4), most=9, tolerance=1e-9)


def test_arrays_that_do_not_fit_are_refused() -> None:
    bent = Bent()
    rows = bent.residual(BEGIN)

    def refused(told: str, residual: Any = bent.residual, slopes: Any = bent.slopes) -> None:
        with pytest.raises(st.InputError, match=told):
            descend(residual, slopes, BEGIN, FREE, np.ones(4), most=9, tolerance=1e-9)

    blocks, chain = bent.slopes(BEGIN)
    refused("do not fit the residual", residual=lambda _: rows[:1])
    refused("do not fit the residual", slopes=lambda _: (blocks[::-1], chain))
    refused(
        "do not fit the residual", slopes=lambda _: ([([0, 2, 1], blocks[0][1]), *blocks[1:]], None)
    )
    refused(
        "do not fit the residual", slopes=lambda _: ([([0, 1, 4], blocks[0][1]), *blocks[1:]], None)
    )
    refused("chain has shape", slopes=lambda _: (blocks, np.eye(3)))
    turns = iter((rows, rows[::-1], rows))
    refused("other rows than before", residual=lambda _: next(turns))
    with pytest.raises(st.InputError, match="high has shape"):
        descend(
            bent.residual,
            bent.slopes,
            BEGIN,
            (FREE[0], np.ones(3)),
            np.ones(4),
            most=9,
            tolerance=1e-9,
        )
    with pytest.raises(st.InputError, match="pulls name variable 4"):
        found(bent, pulls=[(4, 0.0, 1.0)])
