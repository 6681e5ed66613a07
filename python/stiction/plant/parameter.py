"""A parameter of a plant: a value, its bounds, and whether a fit may change it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .._support.given import number
from ..errors import InputError

__all__ = ["Parameter"]

_KEYS = ("value", "min", "max", "fixed")


@dataclass(frozen=True)
class Parameter:
    """A number of a plant file.

    Attributes
    ----------
    value : float
        SI value.
    min, max : float or None
        Bounds for a fit, beyond those of the catalogue.
    fixed : bool
        Whether a fit leaves it alone.

    Raises
    ------
    InputError
        A value or a bound that is no number.
    """

    value: float
    min: float | None = None
    max: float | None = None
    fixed: bool = False

    def __post_init__(self) -> None:
        for name in ("value", "min", "max"):
            given = getattr(self, name)
            if given is not None or name == "value":
                number(given, f"Parameter: {name}")

    def to_toml(self) -> float | dict[str, float | bool]:
        """What a plant file holds: a plain number where there is nothing else to say."""
        if self.min is None and self.max is None and not self.fixed:
            return self.value
        table: dict[str, float | bool] = {"value": self.value}
        if self.min is not None:
            table["min"] = self.min
        if self.max is not None:
            table["max"] = self.max
        if self.fixed:
            table["fixed"] = True
        return table

    @classmethod
    def read(cls, given: Any, where: str) -> Parameter:
        """Take a number or ``{ value, min, max, fixed }``.

        Raises
        ------
        InputError
            Anything else; a value outside its own bounds.
        """
        if not isinstance(given, dict):
            return cls(number(given, where))
        for key in given:
            if key not in _KEYS:
                allowed = ", ".join(_KEYS)
                raise InputError(f"{where}: key '{key}' is unknown; allowed are {allowed}")
        if "value" not in given:
            raise InputError(f"{where}: 'value' is missing; write {{ value = … }}")
        fixed = given.get("fixed", False)
        if not isinstance(fixed, bool):
            raise InputError(f"{where}: fixed = {fixed!r} is not true or false")
        value = number(given["value"], f"{where}.value")
        low = number(given["min"], f"{where}.min") if "min" in given else None
        high = number(given["max"], f"{where}.max") if "max" in given else None
        if low is not None and high is not None and low > high:
            raise InputError(f"{where}: min = {low} is above max = {high}; swap them")
        if (low is not None and value < low) or (high is not None and value > high):
            bounds = f"{'-inf' if low is None else low} to {'inf' if high is None else high}"
            raise InputError(
                f"{where}: value = {value} is out of its own bounds {bounds}; change one of them"
            )
        # Bounds that leave nothing to fit fix it as well.
        return cls(value, low, high, fixed or low == high == value)
