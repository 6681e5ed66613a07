"""The least squares of fits and diagnoses against certified values, from both certified starts.

NIST Statistical Reference Datasets, nonlinear regression (https://www.itl.nist.gov/div898/strd/):
values and standard errors with eleven digits. Files as they are published, in the public domain.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from stiction.fitting.levenberg import levenberg_marquardt
from stiction.fitting.statistics import normal_inverse

FILES = Path(__file__).parent / "nist"
WITHIN = 1e-6
FAR = 1e100
ELSEWHERE = {("BoxBOD", 0), ("MGH10", 0), ("MGH17", 0)}
"""Starts from which the slopes lead into another valley."""
ROUNDING = {"Lanczos1"}
"""Problems whose residual is the rounding of the data: so is their standard error."""
Array = np.ndarray
Model = Callable[[Array, Array], Array]


def rational(top: int, bottom: int) -> Model:
    """Σ b_k·x^k over 1 + Σ b_k·x^k, with so many numbers above and below."""

    def model(b: Array, x: Array) -> Array:
        above = sum(b[k] * x**k for k in range(top))
        return above / (1.0 + sum(b[top + k] * x ** (k + 1) for k in range(bottom)))

    return model


def gauss(b: Array, x: Array) -> Array:
    peaks = sum(b[k] * np.exp(-(((x - b[k + 1]) / b[k + 2]) ** 2)) for k in (2, 5))
    return b[0] * np.exp(-b[1] * x) + peaks


def lanczos(b: Array, x: Array) -> Array:
    return sum(b[k] * np.exp(-b[k + 1] * x) for k in (0, 2, 4))


def enso(b: Array, x: Array) -> Array:
    waves = ((b[1], b[2], 12.0), (b[4], b[5], b[3]), (b[7], b[8], b[6]))
    turn = 2.0 * np.pi * x
    return b[0] + sum(c * np.cos(turn / p) + s * np.sin(turn / p) for c, s, p in waves)


MODELS: dict[str, Model] = {
    "Bennett5": lambda b, x: b[0] * (b[1] + x) ** (-1.0 / b[2]),
    "BoxBOD": lambda b, x: b[0] * (1.0 - np.exp(-b[1] * x)),
    "Chwirut1": lambda b, x: np.exp(-b[0] * x) / (b[1] + b[2] * x),
    "Chwirut2": lambda b, x: np.exp(-b[0] * x) / (b[1] + b[2] * x),
    "DanWood": lambda b, x: b[0] * x ** b[1],
    "ENSO": enso,
    "Eckerle4": lambda b, x: b[0] / b[1] * np.exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
    "Gauss1": gauss,
    "Gauss2": gauss,
    "Gauss3": gauss,
    "Hahn1": rational(4, 3),
    "Kirby2": rational(3, 2),
    "Lanczos1": lanczos,
    "Lanczos2": lanczos,
    "Lanczos3": lanczos,
    "MGH09": lambda b, x: b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3]),
    "MGH10": lambda b, x: b[0] * np.exp(b[1] / (x + b[2])),
    "MGH17": lambda b, x: b[0] + b[1] * np.exp(-b[3] * x) + b[2] * np.exp(-b[4] * x),
    "Misra1a": lambda b, x: b[0] * (1.0 - np.exp(-b[1] * x)),
    "Misra1b": lambda b, x: b[0] * (1.0 - (1.0 + 0.5 * b[1] * x) ** -2),
    "Misra1c": lambda b, x: b[0] * (1.0 - (1.0 + 2.0 * b[1] * x) ** -0.5),
    "Misra1d": lambda b, x: b[0] * b[1] * x / (1.0 + b[1] * x),
    "Nelson": lambda b, x: b[0] - b[1] * x[0] * np.exp(-b[2] * x[1]),
    "Rat42": lambda b, x: b[0] / (1.0 + np.exp(b[1] - b[2] * x)),
    "Rat43": lambda b, x: b[0] / (1.0 + np.exp(b[1] - b[2] * x)) ** (1.0 / b[3]),
    "Roszman1": lambda b, x: b[0] - b[1] * x - np.arctan(b[2] / (x - b[3])) / np.pi,
    "Thurber": rational(4, 3),
}


@dataclass(frozen=True)
class Problem:
    """A problem with its certified answer."""

    x: Array
    y: Array
    starts: tuple[Array, Array]
    values: Array
    errors: Array
    power: float


def read(name: str) -> Problem:
    text = (FILES / f"{name}.dat").read_text("ascii")
    rows = re.findall(r"^ *b\d+ = +(\S+) +(\S+) +(\S+) +(\S+)$", text, re.M)
    told = np.array(rows, dtype=np.float64)
    power = re.search(r"Residual Sum of Squares: +(\S+)", text)
    assert power is not None
    data = text[text.rindex("Data:") :].splitlines()[1:]
    table = np.array([line.split() for line in data if line.strip()], dtype=np.float64).T
    y, x = table[0], table[1] if len(table) == 2 else table[1:]
    if name == "Nelson":
        y = np.log(y)
    return Problem(x, y, (told[:, 0], told[:, 1]), told[:, 2], told[:, 3], float(power[1]))


def slopes(model: Model, b: Array, x: Array) -> Array:
    """Derivatives by a complex step: exact to rounding."""
    columns = []
    for k in range(len(b)):
        tiny = 1e-100 * (abs(b[k]) or 1.0)
        moved = b.astype(complex)
        moved[k] += 1j * tiny
        columns.append(np.imag(model(moved, x)) / tiny)
    return np.column_stack(columns)


def fitted(problem: Problem, model: Model, start: Array) -> tuple[Array, Array, float]:
    """Values, standard errors and sum of squares."""
    free = np.full(len(start), np.inf)

    def residual(b: Array) -> Array:
        # A trial may run away: it must look bad.
        with np.errstate(all="ignore"):
            left = model(b, problem.x) - problem.y
            return np.clip(np.nan_to_num(left, nan=FAR), -FAR, FAR)

    def jacobian(b: Array) -> Array:
        with np.errstate(all="ignore"):
            return np.nan_to_num(slopes(model, b, problem.x))

    found = levenberg_marquardt(
        residual, jacobian, start, (-free, free), np.abs(start), most=5000, tolerance=1e-15
    )
    assert found.converged
    inverse, scale = normal_inverse(jacobian(found.x))
    variance = found.cost / (len(problem.y) - len(start))
    return found.x, np.sqrt(variance * np.diag(inverse)) / scale, found.cost


@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize("name", MODELS)
def test_least_squares_give_the_certified_values(name: str, start: int) -> None:
    problem = read(name)
    values, errors, power = fitted(problem, MODELS[name], problem.starts[start])
    if (name, start) in ELSEWHERE:
        assert power > 2.0 * problem.power
        return
    assert values == pytest.approx(problem.values, rel=WITHIN)
    if name not in ROUNDING:
        assert errors == pytest.approx(problem.errors, rel=WITHIN)
        assert power == pytest.approx(problem.power, rel=WITHIN)


def test_every_problem_is_there() -> None:
    assert {path.stem for path in FILES.glob("*.dat")} == set(MODELS)
