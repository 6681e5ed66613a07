"""What repeats: over position, order by order, and over time, frequency by frequency."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..data.evidence import Cells, Plan
from .coordinates import Coordinate, Look
from .view import View, limit, means

__all__ = [
    "COUPLED",
    "FREQUENCY",
    "ORDERS",
    "WITH_ACCELERATION",
    "WITH_SQUARED_SPEED",
    "Asked",
    "frequency_view",
    "order_views",
    "waves_of",
]

PHASES: Final = 24
"""Stretches of a period."""
AT_ONCE: Final = 4096
"""Rows of which the waves of all orders are there at once."""
LOWEST_LINE: Final = 10
"""Hz; what is slower comes with the motion, not with time."""
NEIGHBOURS: Final = (2, 8)
"""A line stands above the frequencies this many Hz from it."""


def _phase(_: Look) -> FloatArray:
    raise NotImplementedError("an order has its own phase")


ORDERS: Final = (
    Coordinate("order over position", "phase of the best order, rad", False, _phase),
    Coordinate(
        "order along the motion",
        "phase of the best order, rad",
        True,
        _phase,
    ),
)
"""Residual that repeats with position, however many times a turn, and the same along the motion."""
WITH_ACCELERATION: Final = Coordinate(
    "order over position, times acceleration",
    "phase of the best order, rad",
    False,
    lambda look: look.acceleration,
)
WITH_EFFORT: Final = Coordinate(
    "order over position, times effort",
    "phase of the best order, rad",
    False,
    lambda look: look.effort,
)
WITH_SQUARED_SPEED: Final = Coordinate(
    "order over position, times squared speed",
    "phase of the best order, rad",
    False,
    lambda look: look.velocity**2,
)
COUPLED: Final = (WITH_ACCELERATION, WITH_EFFORT, WITH_SQUARED_SPEED)
"""Residual that repeats with position and grows with something else: what errs is a sensor or a
gain. Their values are what it grows with."""
FREQUENCY: Final = Coordinate("frequency", "frequency, Hz", False, _phase)
"""Residual that repeats with time."""


def waves_of(orders: Sequence[float], position: FloatArray) -> FloatArray:
    """Cosine and sine of each order at each position; shape (2, orders, n)."""
    if list(orders) != [orders[0] * k for k in range(1, len(orders) + 1)]:
        angle = np.outer(orders, position)
        return np.stack([np.cos(angle), np.sin(angle)])
    # Multiples of the first one: each is the one before, turned on by it.
    waves = np.empty((2, len(orders), len(position)))
    turn = np.exp(1j * orders[0] * position)
    turned = np.ones_like(turn)
    for k in range(len(orders)):
        turned = turned * turn
        waves[0, k], waves[1, k] = turned.real, turned.imag
    return waves


@dataclass(frozen=True)
class Asked:
    """A residual that is asked for orders over position.

    Attributes
    ----------
    coordinate : Coordinate
    both : numpy.ndarray, shape (n, 1 + surrogates)
        Weighted residual, then those of the surrogates; each chooses its own best order.
    factor : numpy.ndarray, shape (n,), optional
        What the wave grows with.
    """

    coordinate: Coordinate
    both: FloatArray
    factor: FloatArray | None = None


def order_views(
    asked: Sequence[Asked],
    orders: Sequence[float],
    position: FloatArray,
    plans: Sequence[Plan],
    weights: FloatArray,
    friction: float,
) -> list[View]:
    """The best order over position for each: fitted rows choose it, those held out judge it.

    Parameters
    ----------
    asked : sequence of Asked
    orders : sequence of float
        Tried, 1/rad or 1/m.
    position : numpy.ndarray, shape (n,)
    plans : sequence of Plan
    weights : numpy.ndarray, shape (n,)
    friction : float
        Weighted rms of the friction.
    """
    scans = [_Scan(each, orders, weights, len(plans)) for each in asked]
    pieces = [slice(at, at + AT_ONCE) for at in range(0, len(position), AT_ONCE)]
    for rows in pieces:
        waves = waves_of(orders, position[rows])
        for k, plan in enumerate(plans):
            for role, mask in enumerate((plan.fit, plan.held)):
                within = mask[rows]
                if np.any(within):
                    some = _Waves(waves[:, :, within])
                    for scan in scans:
                        scan.add(k, role, some, rows.start + np.flatnonzero(within))
    for scan in scans:
        scan.judge()
    phases = np.empty((len(scans), len(position)), dtype=np.int64)
    wanted = orders[: max(max(scan.best for scan in scans) + 1, 2)]
    for rows in pieces:
        waves = waves_of(wanted, position[rows])
        for own, scan in zip(phases, scans, strict=True):
            cosine, sine = waves[:, scan.best]
            phase = np.mod(np.arctan2(sine, cosine), 2.0 * np.pi)
            own[rows] = np.minimum((phase / (2.0 * np.pi) * PHASES).astype(np.int64), PHASES - 1)
    return [scan.view(own, weights, friction) for own, scan in zip(phases, scans, strict=True)]


class _Waves:
    """Waves over some rows, and their products."""

    def __init__(self, waves: FloatArray) -> None:
        self.waves = waves
        self.squared, self.crossed = waves[0] ** 2, waves[0] * waves[1]

    def products(self, grown: FloatArray, both: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Normal matrices of each order, shape (orders, 2, 2), and products with the residuals."""
        moved = grown[:, None] * both
        pushed = np.stack([wave @ moved for wave in self.waves], axis=1)
        square = grown**2
        normal = np.empty((self.waves.shape[1], 2, 2))
        normal[:, 0, 0] = self.squared @ square
        normal[:, 1, 1] = np.sum(square) - normal[:, 0, 0]
        normal[:, 0, 1] = normal[:, 1, 0] = self.crossed @ square
        return normal, pushed


class _Scan:
    """What each order explains of a residual and its surrogates."""

    def __init__(
        self, asked: Asked, orders: Sequence[float], weights: FloatArray, plans: int
    ) -> None:
        self.asked = asked
        factor = asked.factor
        self.grown = weights
        if factor is not None:
            self.grown = weights * factor / np.sqrt(np.mean(factor**2) + 1e-300)
        number = asked.both.shape[1]
        # Of each plan the rows that it fits, and those that it holds out.
        self.normal = np.zeros((plans, 2, len(orders), 2, 2))
        self.pushed = np.zeros((plans, 2, len(orders), 2, number))
        self.explained = np.zeros((len(orders), number))
        self.removed = np.zeros_like(self.explained)
        self.total = np.zeros(number)
        self.rows = 0

    def add(self, plan: int, role: int, waves: _Waves, rows: np.ndarray) -> None:
        """Adds what some rows tell a plan, which fits them (0) or holds them out (1)."""
        both = self.asked.both[rows]
        normal, pushed = waves.products(self.grown[rows], both)
        self.normal[plan, role] += normal
        self.pushed[plan, role] += pushed
        if role == 1:
            self.total += np.sum(both**2, axis=0)
            self.rows += len(rows)

    def judge(self) -> None:
        """What each order explains where it is fitted, and takes off where it is not."""
        for normal, pushed in zip(self.normal, self.pushed, strict=True):
            gains = np.linalg.pinv(normal[0], rcond=1e-10, hermitian=True) @ pushed[0]
            self.explained += np.sum(gains * pushed[0], axis=1)
            self.removed += np.sum(gains * (2.0 * pushed[1] - normal[1] @ gains), axis=1)

    @property
    def best(self) -> int:
        """The order that explains most of the residual."""
        return int(np.argmax(self.explained[:, 0]))

    def view(self, index: np.ndarray, weights: FloatArray, friction: float) -> View:
        """The order that explains most, over its phase; ``index`` tells the part of each row."""
        both = self.asked.both
        best = np.argmax(self.explained, axis=0)
        own = self.removed[best, np.arange(both.shape[1])]
        shares = own / np.maximum(self.total, 1e-300)
        # In units of effort: of what grows with something, at its usual size.
        curves = means(index, both * (_sign_of(self.asked.factor) / weights)[:, None], PHASES)
        low, high = np.quantile(curves[:, 1:], [0.025, 0.975], axis=1)
        at = (np.arange(PHASES) + 0.5) * 2.0 * np.pi / PHASES
        size = float(np.sqrt(max(own[0], 0.0) / max(self.rows, 1))) / max(friction, 1e-300)
        mean, threshold = curves[:, 0], limit(shares[1:])
        coordinate = self.asked.coordinate
        return View(coordinate, at, mean, low, high, float(shares[0]), threshold, size)


def _sign_of(factor: FloatArray | None) -> FloatArray:
    return np.ones(1) if factor is None else np.sign(factor)


def frequency_view(
    cells: Cells, spacings: FloatArray, both: FloatArray, weights: FloatArray, friction: float
) -> View | None:
    """The frequency that stands out of its neighbours most; None where no block is whole.

    Spectra of blocks of 1 s, averaged. A line's share is what it holds above its neighbours.
    Recordings whose rows lie apart differently have the same lines, 1 Hz from one to the next; what
    is faster than the slowest of them shows is left out.

    Parameters
    ----------
    cells : Cells
    spacings : numpy.ndarray, shape (n,)
        Of the rows of the recording that each row is of, s.
    both : numpy.ndarray, shape (n, 1 + surrogates)
        Weighted residual, then those of the surrogates.
    weights : numpy.ndarray, shape (n,)
    friction : float
        Weighted rms of the friction.
    """
    lengths = np.rint(1.0 / spacings).astype(np.int64)
    starts = [
        rows[0]
        for rows in np.split(np.arange(len(cells.block)), np.flatnonzero(np.diff(cells.block)) + 1)
        if len(rows) >= lengths[rows[0]]
    ]
    shortest = int(min((lengths[start] for start in starts), default=0))
    if shortest < 4 * NEIGHBOURS[1]:
        return None
    spectrum = np.zeros((shortest // 2 + 1, both.shape[1]))
    effort = np.zeros_like(spectrum)
    for start in starts:
        rows = slice(start, start + int(lengths[start]))
        window = np.hanning(lengths[start])[:, None]
        lines_of = np.fft.rfft(window * both[rows], axis=0)[: len(spectrum)]
        held = np.abs(lines_of / float(window.sum())) ** 2
        spectrum += held
        # In units of effort for the eye; the weight is one number within a recording.
        effort += held / weights[start] ** 2
    spectrum /= len(starts)
    total = np.maximum(spectrum.sum(axis=0), 1e-300)
    near, far = NEIGHBOURS
    lines = np.zeros_like(spectrum)
    for k in range(LOWEST_LINE, len(spectrum) - 1):
        around = [j for d in range(near, far + 1) for j in (k - d, k + d) if 1 <= j < len(spectrum)]
        floor = np.median(spectrum[around], axis=0)
        lines[k] = np.sum(spectrum[k - 1 : k + 2] - floor, axis=0)
    shares = np.max(lines, axis=0) / total
    amplitudes = 2.0 * np.sqrt(effort / len(starts))
    low, high = np.quantile(amplitudes[:, 1:], [0.025, 0.975], axis=1)
    power = float(np.mean(both[:, 0] ** 2))
    size = float(np.sqrt(max(shares[0], 0.0) * power)) / max(friction, 1e-300)
    return View(
        FREQUENCY,
        np.arange(len(spectrum)) / (shortest * float(np.max(spacings[starts]))),
        amplitudes[:, 0],
        low,
        high,
        float(shares[0]),
        limit(shares[1:]),
        size,
    )
