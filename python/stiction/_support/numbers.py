"""Numbers as an engineer writes them: as many digits as are known, with interval and unit."""

from __future__ import annotations

import math
from typing import Final

from .wording import plural

__all__ = [
    "NO_BREAK",
    "between",
    "digits",
    "duration",
    "isolate",
    "percent",
    "percent_between",
    "plain",
    "quantity",
    "tick",
    "tick_of_ten",
]

UNKNOWN: Final = "not known"
NO_BREAK: Final = "\u00a0"
"""Between a number and its unit."""
_SUPERSCRIPTS: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
# Outside of these powers of ten a plain decimal is hard to read.
_LEAST, _GREATEST = -4, 6


def plain(name: str) -> str:
    """A name of the catalogue as words."""
    return name.replace("_", " ")


def isolate(name: str) -> str:
    """A name within a sentence: whatever direction it is written in, the sentence keeps its own."""
    return f"\u2068{name}\u2069"


def digits(value: float | None, figures: int = 3) -> str:
    """A number with so many significant digits."""
    if value is None or not math.isfinite(value):
        return UNKNOWN
    power = _power(value)
    if _LEAST <= power < _GREATEST:
        return _fixed(value, max(figures - 1 - power, 0))
    return f"{_fixed(value / 10.0**power, figures - 1)}{_times_ten(power)}"


def quantity(value: float | None, unit: str, figures: int = 3) -> str:
    """A number with its unit."""
    text = digits(value, figures)
    return text if unit in ("", "1") or text == UNKNOWN else f"{text}{NO_BREAK}{unit}"


def between(value: float, low: float, high: float) -> tuple[str, str]:
    """A value, and the ends of its interval, with as many digits as the interval allows."""
    if not (math.isfinite(low) and math.isfinite(high)):
        return digits(value), "not determined"
    half = 0.5 * abs(high - low)
    power = _power(max(abs(value), abs(low), abs(high)))
    plainly = _LEAST <= power < _GREATEST
    scale = 1.0 if plainly else 10.0**power
    decimals = 3 if half == 0.0 else min(max(1 - _power(half / scale), 0), 7)
    if value != 0.0:
        # However wide the interval is, the value stays what it is to two figures.
        decimals = max(decimals, min(1 - _power(value / scale), 7))
    tail = "" if plainly else _times_ten(power)
    shown = [_fixed(number / scale, decimals) for number in (value, low, high)]
    if tail:
        return f"{shown[0]}{tail}", f"({shown[1]} to {shown[2]}){tail}"
    return shown[0], f"{shown[1]} to {shown[2]}"


def percent(share: float | None, decimals: int = 1) -> str:
    """A share in per cent."""
    if share is None or not math.isfinite(share):
        return ""
    return f"{_fixed(100.0 * share, decimals)}{NO_BREAK}%"


def percent_between(low: float, high: float) -> str:
    """Both ends of an interval in per cent."""
    return f"{_fixed(100.0 * low, 1)} to {_fixed(100.0 * high, 1)}{NO_BREAK}%"


def duration(seconds: float) -> str:
    """A length of time in s, or in min where it is long."""
    if seconds < 300.0:
        return f"{digits(seconds)}{NO_BREAK}s"
    return plural(round(seconds / 60.0), "minute")


def tick(value: float) -> str:
    """A number at an axis."""
    if abs(value) < 1e-12:
        return "0"
    power = _power(value)
    if _LEAST < power < _GREATEST:
        return f"{value:.6g}".replace("-", "−")
    # Ticks are round, so digits stand here only where they tell neighbours apart.
    return f"{value / 10.0**power:.6g}".replace("-", "−") + _times_ten(power)


def tick_of_ten(value: float) -> str:
    """A number at an axis of powers of ten."""
    power = _power(value)
    if value == 0.0 or -3 <= power <= 3:
        return tick(value)
    return f"10{str(power).translate(_SUPERSCRIPTS)}"


def _power(value: float) -> int:
    # Powers of ten come out of logarithms a little too small.
    return math.floor(math.log10(abs(value)) + 1e-12) if value and math.isfinite(value) else 0


def _fixed(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")
    return text.replace("-", "−")


def _times_ten(power: int) -> str:
    return f"×10{str(power).translate(_SUPERSCRIPTS)}"
