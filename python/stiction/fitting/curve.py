"""A friction law fitted to a table of speed and friction, as joint friction is published."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from .._support import given
from .._support.arrays import FloatArray
from .._support.atomic_files import write_text
from .._support.frozen import ByPath, freeze
from .._support.json_text import json_of
from .._support.keywords import explain_keywords
from .._support.wording import commas, plural
from ..catalogue import laws
from ..errors import InputError
from ..plant import Plant
from ..plant.parameter import Parameter
from .levenberg import levenberg_marquardt
from .result import FitParameter

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["CurveFit", "fit_curve"]

BASE: Final = ("coulomb", "viscous")
STRIBECK: Final = ("breakaway", "stribeck_velocity")
FEWEST: Final = 6
"""Points, beyond which two parameters and their errors can be told."""
TOLERANCE: Final = 1e-9
MOST: Final = 200
ROUNDING: Final = 1e-6
"""Share of the greatest friction to which tables are printed at best."""
STEP: Final = 1e-5
"""Share of a parameter by which its slope is measured."""
SPEEDS_TRIED: Final = 5
"""Speed scales that a Stribeck fit starts from."""
ONE_WAY: Final = 3.0
"""Standard errors by which the mean residuals of both directions differ where that is told."""


@dataclass(frozen=True, eq=False, repr=False)
class CurveFit:
    """A friction law with the numbers of a table of speed and friction.

    Attributes
    ----------
    plant : Plant
        The law alone, of a machine that is moved: for ``friction_model``, ``export``, or the
        [friction] of a plant file.
    parameters : Mapping of str to FitParameter
        By path, with standard errors of independent points.
    speed, friction : numpy.ndarray, shape (n,)
        The table, rad/s or m/s, N·m or N.
    rms, relative : float
        What is left: root mean square, and over that of the friction.
    untold : tuple of str
        Parameters of the law that were not fitted; they have the catalogue's defaults.
    notes : tuple of str
    """

    plant: Plant
    parameters: Mapping[str, FitParameter]
    speed: FloatArray
    friction: FloatArray
    rms: float
    relative: float
    untold: tuple[str, ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, ByPath, "parameters")

    @property
    def message(self) -> str:
        """What was fitted and what is left, in a sentence."""
        return (
            f"{self.plant.friction.law} fitted to {plural(len(self.speed), 'point')} of speed and "
            f"friction: {self.rms:.3g} {self.plant.effort_unit} rms left, "
            f"{100.0 * self.relative:.2g} % of the friction"
        )

    def __str__(self) -> str:
        rows = [("parameter", "value", "std. error", "95 %", "unit")]
        for path, one in self.parameters.items():
            low, high = one.ci95
            interval = f"{low:.4g} to {high:.4g}"
            rows.append((path, f"{one.value:.4g}", f"{one.stderr:.2g}", interval, one.unit))
        wide = [max(len(row[k]) for row in rows) for k in range(4)]
        table = ["  ".join([*(f"{row[k]:<{wide[k]}}" for k in range(4)), row[4]]) for row in rows]
        return "\n".join([self.message, "", *table, *self._remarks()])

    __repr__ = __str__

    def _remarks(self) -> list[str]:
        remarks = list(self.notes)
        if self.untold:
            remarks.append(
                f"not fitted to a curve of steady friction, at defaults: {commas(self.untold)}"
            )
        return ["", *remarks] if remarks else []

    def _repr_html_(self) -> str:
        from ..notebook import drawing, table

        rows = [
            (path, f"{one.value:.4g}", f"{one.ci95[0]:.4g} to {one.ci95[1]:.4g}", one.unit)
            for path, one in self.parameters.items()
        ]
        order = np.argsort(self.speed)
        across = self.speed[order]
        lines = [
            ("table", across, self.friction[order]),
            ("law", across, self.plant.friction_curve(across)),
        ]
        unit = self.plant.position_unit
        drawn = drawing(lines, f"speed ({unit}/s)", f"friction ({self.plant.effort_unit})")
        told = "".join(f"<p>{line}</p>" for line in (self.message, *self._remarks()) if line)
        return told + table(("parameter", "value", "95 %", "unit"), rows) + drawn

    def plot(self, ax: Axes | None = None) -> Axes:
        """The points and the law over speed.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            To draw into, one of a new figure without it.

        Returns
        -------
        matplotlib Axes

        Raises
        ------
        InputError
            ``ax`` is something else than axes.
        """
        from .. import plot

        panel = plot.panel_for(ax)
        panel.plot(self.speed, self.friction, linestyle="", marker=".", label="table")
        most = float(np.max(np.abs(self.speed)))
        one_way = np.geomspace(1e-3 * most, most, 120)
        across = one_way if np.min(self.speed) >= 0.0 else np.concatenate([-one_way[::-1], one_way])
        law = self.plant.friction.law
        panel.plot(across, self.plant.friction_curve(across), label=law, linewidth=1.2)
        panel.set_xlabel(f"speed ({self.plant.position_unit}/s)")
        panel.set_ylabel(f"friction ({self.plant.effort_unit})")
        plot.legend(panel)
        return panel

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain dicts and lists."""
        return {
            "law": self.plant.friction.law,
            "message": self.message,
            "parameters": {
                path: {
                    "value": one.value,
                    "stderr": one.stderr,
                    "ci95": list(one.ci95),
                    "unit": one.unit,
                    "at_bound": one.at_bound,
                }
                for path, one in self.parameters.items()
            },
            "rms": self.rms,
            "relative": self.relative,
            "points": len(self.speed),
            "untold": list(self.untold),
            "notes": list(self.notes),
        }

    def save(self, folder: str | Path) -> list[Path]:
        """Write plant.toml and curve.json.

        Parameters
        ----------
        folder : str or Path
            Made where it is not there.

        Returns
        -------
        list of Path
            The files.

        Raises
        ------
        InputError
            No path, a file that cannot be written.
        """
        where = given.path(folder, "CurveFit.save")
        files = [where / "plant.toml", where / "curve.json"]
        with given.explain_write_errors(where):
            where.mkdir(parents=True, exist_ok=True)
        self.plant.save(files[0])
        with given.explain_write_errors(files[1]):
            write_text(files[1], json_of(self.to_dict()) + "\n")
        return files


@explain_keywords
def fit_curve(
    speed: npt.ArrayLike, friction: npt.ArrayLike, law: str = "coulomb", *, motion: str = "rotary"
) -> CurveFit:
    """Fit a friction law to a table of speed and friction.

    Fitted are the parameters that steady friction tells: the Coulomb level and viscous friction,
    and the Stribeck effect where the law has it and the points ask for it by BIC. Of the others the
    catalogue's defaults are kept, and named.

    Parameters
    ----------
    speed : array_like, shape (n,)
        rad/s or m/s, at least 6 points other than 0, one direction or both.
    friction : array_like, shape (n,)
        N·m or N, positive where it resists positive motion; magnitudes where all are positive.
    law : str
        A name of ``stiction.laws()``.
    motion : {"rotary", "linear"}

    Returns
    -------
    CurveFit

    Raises
    ------
    InputError
        Unknown law or motion, arrays of different lengths, fewer than 6 points, numbers that are
        not finite.

    Examples
    --------
    >>> import numpy as np, stiction as st
    >>> v = np.linspace(0.1, 5.0, 20)
    >>> found = st.fit_curve(v, 0.3 + 0.05 * v)
    >>> round(found.parameters["coulomb"].value, 3), round(found.parameters["viscous"].value, 3)
    (0.3, 0.05)
    """
    record = laws()[given.word(law, "fit_curve: law")]
    across, up = _points(speed, friction)
    names = [each.name for each in record.parameters]
    tables = {"motion": {"kind": motion}, "drive": {"kind": "prescribed_motion"}}
    plant = Plant.from_dict({**tables, "friction": {"law": law}})
    told = [name for name in BASE if name in names]
    if not told:
        raise InputError(
            f"fit_curve: {law} has neither coulomb nor viscous, which a friction curve tells"
        )
    notes: list[str] = []
    best = _fitted(plant, told, across, up, [_begin(across, up)])
    if set(STRIBECK) <= set(names):
        more = [*told[:1], *STRIBECK, *told[1:]]
        starts = _stribeck_begins(across, up, best)
        other = _fitted(plant, more, across, up, starts) if len(across) > len(more) + 1 else None
        if other is not None and _bic(other) < _bic(best):
            best = other
        else:
            notes.append("no Stribeck effect: it would not pay for its two parameters (BIC)")
    notes += _directions(across, best.left, plant.effort_unit)
    power = float(np.mean(up**2))
    return CurveFit(
        best.plant,
        best.parameters(),
        across,
        up,
        best.rms,
        best.rms / math.sqrt(power) if power > 0.0 else 0.0,
        tuple(name for name in names if name not in best.names),
        tuple(notes),
    )


@dataclass(frozen=True)
class _Fitted:
    """A law on the curve: its plant, what is left, and the slopes.

    In ``x`` a break-away level is what it has above the Coulomb level, which bounds hold above 0.
    """

    plant: Plant
    names: Sequence[str]
    begin: FloatArray
    x: FloatArray
    left: FloatArray
    curve: FloatArray
    slopes: FloatArray
    bounds: tuple[FloatArray, FloatArray]

    @property
    def rms(self) -> float:
        return float(np.sqrt(np.mean(self.left**2)))

    def parameters(self) -> dict[str, FitParameter]:
        from scipy.stats import t

        spare = max(len(self.left) - len(self.x), 1)
        variance = float(self.left @ self.left) / spare
        stated = _stated(self.names)
        covariance = variance * stated @ np.linalg.pinv(self.slopes.T @ self.slopes) @ stated.T
        values, begin = stated @ self.x, stated @ self.begin
        times = float(t.ppf(0.975, spare))
        units = {
            each.name: each.unit if self.plant.motion == "rotary" else each.linear_unit
            for each in self.plant.friction.record.parameters
        }
        found = {}
        for k, name in enumerate(self.names):
            value, error = float(values[k]), math.sqrt(max(float(covariance[k, k]), 0.0))
            low, high = self.bounds[0][k], self.bounds[1][k]
            at = "lower" if self.x[k] <= low else "upper" if self.x[k] >= high else ""
            interval = (value - times * error, value + times * error)
            found[f"friction.{name}"] = FitParameter(
                value, error, interval, units[name], at, float(begin[k])
            )
        return found


def _stated(names: Sequence[str]) -> FloatArray:
    """From the variables of a fit to parameters as a law states them; shape (p, p)."""
    found = np.eye(len(names))
    if "breakaway" in names:
        found[names.index("breakaway"), names.index("coulomb")] = 1.0
    return found


def _points(speed: npt.ArrayLike, friction: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Both columns as numbers, without points at rest, of which a curve says nothing."""
    across = given.numbers(speed, "fit_curve: speed")
    up = given.numbers(friction, "fit_curve: friction")
    if across.ndim != 1 or across.shape != up.shape:
        raise InputError(
            f"fit_curve: speed has shape {across.shape} and friction {up.shape}; give two columns "
            "of one length"
        )
    if not (np.isfinite(across).all() and np.isfinite(up).all()):
        raise InputError("fit_curve: some points are not finite numbers; leave them out")
    moving = across != 0.0
    across, up = across[moving], up[moving]
    if len(across) < FEWEST:
        raise InputError(
            f"fit_curve: there are {plural(len(across), 'point')} in motion; give {FEWEST} or more"
        )
    both_ways = np.min(across) < 0.0 < np.max(across)
    if np.all(up >= 0.0) and (both_ways or np.all(across < 0.0)):
        # Published as magnitudes, whatever the direction.
        up = np.copysign(up, across)
    if float(np.sum(across * up)) < 0.0:
        raise InputError(
            "fit_curve: friction has the sign opposite to the speed, so that it would drive the "
            "machine; turn one of the two signs round"
        )
    return across, up


def _begin(across: FloatArray, up: FloatArray) -> dict[str, float]:
    """Level and viscous friction by a line through the magnitudes."""
    lines = np.column_stack([np.ones(len(across)), np.abs(across)])
    level, slope = np.linalg.lstsq(lines, np.abs(up), rcond=None)[0]
    floor = 1e-3 * float(np.max(np.abs(up)))
    return {"coulomb": max(float(level), floor), "viscous": max(float(slope), 0.0)}


def _stribeck_begins(across: FloatArray, up: FloatArray, base: _Fitted) -> list[dict[str, float]]:
    """The base with a higher level at rest, over several scales of speed."""
    begin = dict(zip(base.names, base.x.tolist(), strict=True))
    slow = np.abs(across) <= np.quantile(np.abs(across), 0.2)
    level = begin["coulomb"]
    above = max(float(np.max(np.abs(up[slow]))) - level, 0.05 * level)
    least, most = np.min(np.abs(across)), np.max(np.abs(across))
    scales = np.geomspace(least, most, SPEEDS_TRIED + 2)[1:-1]
    return [{**begin, "breakaway": above, "stribeck_velocity": float(v)} for v in scales]


def _fitted(
    plant: Plant,
    names: Sequence[str],
    across: FloatArray,
    up: FloatArray,
    begins: Sequence[Mapping[str, float]],
) -> _Fitted:
    """The best of the fits from several starts."""
    records = {each.name: each for each in plant.friction.record.parameters}
    low = np.array([0.0 if name == "breakaway" else records[name].bounds[0] for name in names])
    high = np.array([records[name].bounds[1] for name in names])
    scale_of = np.maximum(np.abs(up).max(), 1e-12)
    fast = np.abs(across).max()
    scales = {"viscous": scale_of / fast, "stribeck_velocity": fast}
    scale = np.array([scales.get(name, scale_of) for name in names])

    def at(x: FloatArray) -> Plant:
        values = _stated(names) @ x
        numbers = {name: Parameter(float(v)) for name, v in zip(names, values, strict=True)}
        return replace(plant, friction=replace(plant.friction, parameters=numbers))

    def residual(x: FloatArray) -> FloatArray:
        return at(x).friction_curve(across) - up

    def jacobian(x: FloatArray) -> FloatArray:
        columns = []
        for k in range(len(x)):
            step = STEP * max(abs(x[k]), 1e-3 * scale[k])
            ahead, behind = x.copy(), x.copy()
            ahead[k], behind[k] = min(x[k] + step, high[k]), max(x[k] - step, low[k])
            columns.append((residual(ahead) - residual(behind)) / (ahead[k] - behind[k]))
        return np.column_stack(columns)

    best: tuple[float, FloatArray, FloatArray] | None = None
    for begin in begins:
        start = np.clip(np.array([begin[name] for name in names]), low, high)
        found = levenberg_marquardt(
            residual, jacobian, start, (low, high), scale, most=MOST, tolerance=TOLERANCE
        )
        if best is None or found.cost < best[0]:
            best = (found.cost, found.x, start)
    assert best is not None
    _, x, start = best
    left = residual(x)
    return _Fitted(at(x), names, start, x, left, left + up, jacobian(x), (low, high))


def _bic(found: _Fitted) -> float:
    """Schwarz's criterion, Ann. Statist. 6 (1978), of independent points of one variance."""
    n = len(found.left)
    # What rounding leaves is no misfit that a parameter could explain.
    least = (ROUNDING * float(np.max(np.abs(found.curve)))) ** 2
    variance = max(float(found.left @ found.left) / n, least)
    return n * math.log(variance) + len(found.x) * math.log(n)


def _directions(across: FloatArray, left: FloatArray, unit: str) -> list[str]:
    """Whether one direction has more friction than the law with one level can show."""
    ahead, back = -left[across > 0.0], left[across < 0.0]
    if min(len(ahead), len(back)) < 3:
        return []
    apart = float(np.mean(ahead) - np.mean(back))
    error = math.hypot(*(np.std(each, ddof=1) / math.sqrt(len(each)) for each in (ahead, back)))
    if not abs(apart) > ONE_WAY * error:
        return []
    more = "forward" if apart > 0.0 else "backward"
    return [
        f"friction is {abs(apart):.3g} {unit} higher {more} than the other way, which one level "
        "cannot show: fit each direction by itself, or diagnose a recording"
    ]
