"""What an experiment returns, and how it prints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from .._support.arrays import FloatArray
from .._support.frozen import Frozen, freeze
from .._support.wording import commas, plural
from .rig import ARC_SECOND

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Known", "MotionResult", "Number", "Result"]

Known: TypeAlias = float | tuple[float, float] | None
"""A figure of the prototype, a range of them, or nothing to compare with."""

_HEADINGS = ("", "here", "unit", "prototype")


class Number(NamedTuple):
    """A number that an experiment yields.

    ``prototype`` is what an independent prototype of the same equations (Runge-Kutta, 5e-5 s)
    gave for the illustrative rig: a number, a range, or None where it has none or where the rig
    or the protocol is another.
    """

    value: float
    unit: str
    prototype: Known = None


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Result:
    """An experiment that has been run.

    Attributes
    ----------
    title : str
        What was done.
    source : str
        Where the paper shows it.
    numbers : Mapping of str to Number
        What the experimenter reads off, with unit and the prototype's figure.
    shows : str
        One sentence: which property of friction it shows.
    """

    title: str
    source: str
    shows: str
    numbers: Mapping[str, Number] = field(default_factory=dict)

    def __post_init__(self) -> None:
        freeze(self, Frozen, "numbers")

    @property
    def success(self) -> bool:
        """Whether all that was recorded and read off is finite."""
        return not self._lost()

    @property
    def message(self) -> str:
        """What happened, in words."""
        lost = self._lost()
        if lost:
            return f"no finite number came out for {commas(lost)}"
        return f"the experiment ran to its end: {plural(len(self.numbers), 'number')} read off"

    def _lost(self) -> list[str]:
        """What is not finite, by name."""
        return [name for name, number in self.numbers.items() if not np.isfinite(number.value)]

    def plot(self) -> Figure:
        """The figure of this experiment."""
        from .figures import draw

        return draw(self)

    def to_dict(self) -> dict[str, Any]:
        """Title, source and numbers as plain dicts and lists."""
        return {
            "title": self.title,
            "source": self.source,
            "shows": self.shows,
            "numbers": {
                name: {
                    "value": number.value,
                    "unit": number.unit,
                    "prototype": (
                        list(number.prototype)
                        if isinstance(number.prototype, tuple)
                        else number.prototype
                    ),
                }
                for name, number in self.numbers.items()
            },
        }

    def __repr__(self) -> str:
        rows = [_HEADINGS, *self._rows()] if self.numbers else []
        widths = [max(len(row[column]) for row in rows) for column in range(4)] if rows else []
        lines = [f"{self.title} ({self.source})", f"  {self.shows}"]
        for name, value, unit, known in rows:
            line = (
                f"  {name:<{widths[0]}}  {value:>{widths[1]}}  {unit:<{widths[2]}}  "
                f"{known:>{widths[3]}}"
            )
            lines.append(line.rstrip())
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{name}</th>" for name in _HEADINGS)
        body = "".join(
            "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>"
            for row in self._rows()
        )
        return (
            f"<p><b>{escape(self.title)}</b> ({escape(self.source)})</p><p>{escape(self.shows)}</p>"
            f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        )

    def _rows(self) -> list[tuple[str, str, str, str]]:
        return [
            (name, f"{number.value:.5g}", number.unit, _known(number.prototype))
            for name, number in self.numbers.items()
        ]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class MotionResult(Result):
    """An experiment that was recorded over time; arrays of shape (n,).

    Attributes
    ----------
    time : numpy.ndarray, shape (n,)
        s; entry k is the end of sample k.
    effort : numpy.ndarray, shape (n,)
        Torque that was applied during sample k, N·m.
    position, velocity : numpy.ndarray, shape (n,)
        Of the rotor, rad and rad/s.
    measured : numpy.ndarray, shape (n,)
        Position as the encoder reads it, rad; equals ``position`` without an encoder.
    states : Mapping of str to numpy.ndarray
        States of the friction law over time (``plastic``, ``hardening``, …).
    """

    time: FloatArray
    effort: FloatArray
    position: FloatArray
    velocity: FloatArray
    measured: FloatArray
    states: Mapping[str, FloatArray]

    def _lost(self) -> list[str]:
        recorded = ("position", "velocity", "measured")
        ran_away = [name for name in recorded if not np.isfinite(getattr(self, name)).all()]
        return [*ran_away, *super()._lost()]


def arcsec(value: float, prototype: Known = None) -> Number:
    """A Number in arc-seconds of an angle in rad."""
    return Number(float(value) / ARC_SECOND, "arcsec", prototype)


def enumerate_values(
    name: str, values: Iterable[Number], prototypes: Sequence[Known] = ()
) -> dict[str, Number]:
    """``{"name 1": first, "name 2": second, …}``, with the prototype's figures as far as known."""
    return {
        f"{name} {index + 1}": number._replace(
            prototype=prototypes[index] if index < len(prototypes) else number.prototype
        )
        for index, number in enumerate(values)
    }


def _known(prototype: Known) -> str:
    if prototype is None:
        return ""
    if isinstance(prototype, tuple):
        return f"{prototype[0]:g} to {prototype[1]:g}"
    return f"{prototype:g}"
