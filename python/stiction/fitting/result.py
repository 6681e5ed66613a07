"""What a fit returns: one result, rendered as text, HTML and JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from .._support import given
from .._support.arrays import FloatArray
from .._support.atomic_files import write_text
from .._support.frozen import ByPath, Frozen, freeze
from .._support.json_text import json_of
from ..plant import Plant
from ..residual.compared import comparison_of
from .sign import LEFT_WHERE_WRONG
from .statistics import correlations
from .waves import as_waves, shown_path, waves_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["FitParameter", "FitResult"]

LEAST_CORRELATION: Final = 0.5
"""Of two parameters, from which on it is told; below it neither misleads about the other."""
MOST_CORRELATIONS: Final = 6
"""So many are told; fit.json and the page have all."""


@dataclass(frozen=True)
class FitParameter:
    """A fitted parameter.

    Attributes
    ----------
    value, stderr : float
        SI value and standard error, which allows for residuals correlated over 1 s.
    ci95 : tuple of float
        value ± t·stderr, t of Student with as many degrees as there are blocks of 1 s, less one;
        as far as the value would be without the pull of the readings.
    unit : str
    at_bound : {"", "lower", "upper"}
        Which bound the fit ended at, "" where at none.
    start : float
        Where the fit started.
    """

    value: float
    stderr: float
    ci95: tuple[float, float]
    unit: str
    at_bound: str
    start: float


@dataclass(frozen=True, eq=False, repr=False)
class FitResult:
    """A fitted plant and how well it is known.

    Attributes
    ----------
    plant : Plant
        With the fitted values.
    parameters : Mapping of str to FitParameter
        By path, such as ``friction.coulomb``; the bare last word does where it is unique.
    stderr : Mapping of str to float
        Standard errors alone, by the same names.
    covariance, correlations : numpy.ndarray, shape (p, p)
        In the order of ``parameters``.
    bounds_hit, undetermined : tuple of str
        Sentences.
    r2 : float
        1 − Σr²/Σ(u − ū)² over the rows fitted, u the measured effort, of a servo its motion. Below
        0 a constant would do better.
    train_rms, train_relative : float
        Residual: root mean square, and 2-norm over that of the measured effort; of a servo that of
        the distance of the motion from its mean.
    heldout_rms, heldout_relative : float or None
        The same over rows that were not fitted.
    unit : str
        Of the effort.
    split : str
        Which rows were fitted and which held out, in words.
    success : bool
    message : str
    interrupted : bool
        Whether Ctrl-C ended it: this is the best so far.
    evaluations : int
        Times that the residual was computed.
    timing_offset : float
        By how much the input was taken to be stamped early, s; bounded by half a sample.
    starts : Mapping of str to Mapping
        Friction state at the first row of each recording that tells of it.
    begins : Mapping of str to Mapping
        Where each recording begins: ``clock_s``, ``path``, and the friction state where one is
        known, held-out recordings too (see ``stiction.plant.begins``).
    assumed : tuple of str
        What the plant leaves open and every value hangs on, in sentences.
    stiffness : float or None
        Of a servo: effort per position by which errors of its simulated loop count as a residual.
    """

    plant: Plant
    parameters: Mapping[str, FitParameter]
    covariance: FloatArray
    correlations: FloatArray
    bounds_hit: tuple[str, ...]
    undetermined: tuple[str, ...]
    r2: float
    train_rms: float
    train_relative: float
    heldout_rms: float | None
    heldout_relative: float | None
    unit: str
    split: str
    success: bool
    message: str
    evaluations: int
    timing_offset: float = 0.0
    starts: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    begins: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    assumed: tuple[str, ...] = ()
    stiffness: float | None = None
    interrupted: bool = False

    def __post_init__(self) -> None:
        freeze(self, ByPath, "parameters")
        for name in ("starts", "begins"):
            held = {key: Frozen(start) for key, start in getattr(self, name).items()}
            object.__setattr__(self, name, Frozen(held))

    @property
    def stderr(self) -> Mapping[str, float]:
        """Standard error of each parameter in its SI unit, by path or bare last word."""
        return ByPath({path: p.stderr for path, p in self.parameters.items()})

    @property
    def waves(self) -> Mapping[str, FitParameter]:
        """Amplitude and phase of each wave over position, by path; phase in rad.

        A wave a·cos(n·q − φ) is fitted by its cosine and its sine, which stand in ``parameters``.
        """
        return ByPath(waves_of(self.parameters, self.covariance))

    @property
    def caution(self) -> str:
        """What to look at first where the plant leaves most of the effort, "" where it does not."""
        left = self.train_relative
        if not LEFT_WHERE_WRONG < left < math.inf:
            return ""
        by = comparison_of(self.plant)
        return (
            f"this plant does not describe the recordings: {by.share(left)} is left, so its "
            "numbers mean nothing yet; check columns, units, signs and clocks, and what the plant "
            "file states or leaves out"
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """All that is to be known beside the numbers, in sentences."""
        return (*self.bounds_hit, *self.undetermined, *self.assumed)

    def __getitem__(self, name: str) -> FitParameter:
        """The parameter at a path, or of a bare name where that is unique.

        Raises
        ------
        UnknownName
            An ``InputError`` and a ``KeyError``: no such parameter, or several.
        """
        return self.parameters[name]

    def __str__(self) -> str:
        rows = [("parameter", "value", "± (1 s.e.)", "unit", "")]
        for path, p in self._shown():
            note = f"at its {p.at_bound} bound" if p.at_bound else ""
            share = f" ({100.0 * abs(p.stderr / p.value):.2g} %)" if p.value else ""
            rows.append((path, f"{p.value:.6g}", f"{p.stderr:.2g}{share}", p.unit, note))
        widths = [max(len(row[k]) for row in rows) for k in range(4)]
        table = [
            "  ".join([*(f"{row[k]:<{widths[k]}}" for k in range(4)), row[4]]).rstrip()
            for row in rows
        ]
        return "\n".join([*self._headline(), "", *table, *self._remarks()])

    __repr__ = __str__

    def _shown(self) -> Iterator[tuple[str, FitParameter]]:
        """What is told in a table: of a wave its amplitude and phase in place of its parts."""
        waves = self.waves
        for path, p in self.parameters.items():
            name = shown_path(path)
            yield (name, waves[name]) if name in waves else (path, p)

    def _headline(self) -> list[str]:
        by = comparison_of(self.plant)
        lines = [
            *([self.caution] if self.caution else []),
            self.message,
            f"{by.error} where fitted: {by.share(self.train_relative, 3)} (relative 2-norm), "
            f"{self._size(self.train_rms)} rms{self._spread()}",
        ]
        if self.heldout_rms is not None and self.heldout_relative is not None:
            lines.append(
                f"{by.error} held out: {by.share(self.heldout_relative, 3)}, "
                f"{self._size(self.heldout_rms)} rms"
            )
        return [*lines, self.split]

    def _size(self, rms: float) -> str:
        """A residual in its unit, of a servo as an error of position."""
        if self.stiffness is not None:
            return f"{rms / self.stiffness:.4g} {self.plant.position_unit}"
        return f"{rms:.4g}" + ("" if self.unit == "1" else f" {self.unit}")

    def _spread(self) -> str:
        """r² in words; "" where there is no spread to explain, as of an effort that is constant."""
        if not math.isfinite(self.r2):
            return ""
        if self.r2 < 0.0:
            return f"; worse than a constant {comparison_of(self.plant).quantity} would do"
        return f", r² {self.r2:.5f}"

    def _remarks(self) -> list[str]:
        return [f"  {sentence}" for sentence in (*self.remarks, *self._told_correlations())]

    def _told_correlations(self) -> list[str]:
        """The largest correlations of parameters that are known at all, in one sentence."""
        names = [name for name, _ in self._shown()]
        between = correlations(as_waves(self.parameters, self.covariance))
        found = [
            (abs(r), f"{names[i]} and {names[k]} {r:+.2f}")
            for i in range(len(names))
            for k in range(i + 1, len(names))
            if LEAST_CORRELATION <= abs(r := float(between[i, k])) < math.inf
        ]
        told = [pair for _, pair in sorted(found, reverse=True)[:MOST_CORRELATIONS]]
        if not told:
            return []
        return [f"correlations above {LEAST_CORRELATION:g}: {'; '.join(told)}"]

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(path)}</td><td>{p.value:.6g} {escape(p.unit)}</td>"
            f"<td>{_interval(p)}</td><td>{escape(p.at_bound)}</td></tr>"
            for path, p in self._shown()
        )
        lines = "".join(f"<p>{escape(line)}</p>" for line in self._headline())
        remarks = "".join(f"<li>{escape(line.strip())}</li>" for line in self._remarks())
        head = "<tr><th>parameter</th><th>value</th><th>95 % interval</th><th>bound</th></tr>"
        from ..notebook import friction_drawing

        curve = friction_drawing([(self.plant.friction.law, self.plant, self.unit)])
        return f"{lines}<table>{head}{rows}</table><ul>{remarks}</ul>{curve}"

    def summary(self) -> str:
        """What was fitted, as text: the same as printing the result."""
        return str(self)

    def save(self, path: str | Path) -> Path:
        """Write fit.json, all that a fit tells.

        Parameters
        ----------
        path : str or Path
            Of the file; a file that is there is replaced. The plant has its own ``save``.

        Returns
        -------
        Path

        Raises
        ------
        InputError
            No path, or a file that cannot be written.
        """
        path = given.path(path, "FitResult.save")
        with given.explain_write_errors(path):
            write_text(path, self.to_json() + "\n")
        return path

    def plot(self, ax: Axes | None = None) -> Axes:
        """The friction that was fitted, over speed.

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
        return self.plant.plot_friction(ax)

    def to_dict(self) -> dict[str, Any]:
        """Everything as plain dicts and lists."""
        return {
            "law": self.plant.friction.law,
            "effects": [effect.name for effect in self.plant.effects],
            "parameters": {
                path: {
                    "value": p.value,
                    "stderr": p.stderr,
                    "ci95": list(p.ci95),
                    "unit": p.unit,
                    "at_bound": p.at_bound,
                    "start": p.start,
                }
                for path, p in self.parameters.items()
            },
            "waves": {
                path: {"value": p.value, "stderr": p.stderr, "ci95": list(p.ci95), "unit": p.unit}
                for path, p in self.waves.items()
            },
            "covariance": self.covariance.tolist(),
            "correlations": self.correlations.tolist(),
            "bounds_hit": list(self.bounds_hit),
            "undetermined": list(self.undetermined),
            "assumed": list(self.assumed),
            "r2": self.r2,
            "train_rms": self.train_rms,
            "train_relative": self.train_relative,
            "heldout_rms": self.heldout_rms,
            "heldout_relative": self.heldout_relative,
            "unit": self.unit,
            "split": self.split,
            "success": self.success,
            "message": self.message,
            "caution": self.caution,
            "evaluations": self.evaluations,
            "nuisances": {
                "timing_offset_s": self.timing_offset,
                "starts": {name: dict(start) for name, start in self.starts.items()},
            },
            "begins": {name: dict(begin) for name, begin in self.begins.items()},
        }

    def to_json(self) -> str:
        """Everything as JSON; null stands for what the data do not determine."""
        return json_of(self.to_dict())


def _interval(parameter: FitParameter) -> str:
    """The interval as a table shows it, without a line break inside a number."""
    low, high = parameter.ci95
    if not (math.isfinite(low) and math.isfinite(high)):
        return "not determined"
    return f"{low:.4g} to {high:.4g}"
