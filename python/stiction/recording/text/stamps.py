"""Stamps that are written as dates and times of day.

ISO 8601 and what spreadsheets and measuring programs make of it: ``2024-05-01T12:00:00.25Z``,
``1.5.2024 12:00:00,25``, ``5/1/2024 1:00:00 PM``, ``12:00:00.25``, ``05:12.3`` (minutes, seconds).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import date
from typing import Final

_STAMP: Final = re.compile(
    r"(?:(?:(?P<y>\d{4})[-/.](?P<m>\d\d?)[-/.](?P<d>\d\d?)"
    r"|(?P<a>\d\d?)(?P<sign>[./-])(?P<b>\d\d?)[./-](?P<year>\d{4}))[T ]\s*)?"
    r"(?:(?P<hour>\d\d?):(?P<minute>\d\d):(?P<second>\d\d)(?:[.,](?P<part>\d{1,9})\d*)?"
    r"\s*(?P<half>[AaPp][Mm])?|(?P<minutes>\d\d?):(?P<seconds>\d\d)[.,](?P<tenths>\d{1,9})\d*)"
    r"\s*(?P<zone>[Zz]|[+-]\d\d:?\d\d)?"
)
_LONGEST: Final = 64
_DAY_S: Final = 86_400
_EPOCH: Final = date(1970, 1, 1).toordinal()
_NANOSECONDS: Final = 10**9


def is_stamp(text: str) -> bool:
    """Whether a cell holds a time of day, with or without its date."""
    return _parsed(text) is not None


def _parsed(text: str) -> tuple[int, int] | None:
    """Days since 1970 (-1 where there is no date) and ns since midnight, in UTC where it says."""
    found = _STAMP.fullmatch(text) if len(text) <= _LONGEST else None
    if found is None:
        return None
    got = found.groupdict()
    day = -1
    if got["y"] or got["year"]:
        try:
            day = _day(got) - _EPOCH
        except ValueError:  # no such day
            return None
    hour, minute = int(got["hour"] or 0), int(got["minute"] or got["minutes"])
    second = int(got["second"] or got["seconds"])
    if half := (got["half"] or "").casefold():
        hour = hour % 12 + (12 if half == "pm" else 0)
    # A second of 60 is a leap one.
    if hour > 24 or minute > 59 or second > 60:
        return None
    shift = 0
    if (zone := got["zone"]) and zone not in "Zz":
        shift = (int(zone[1:3]) * 3600 + int(zone[-2:]) * 60) * (-1 if zone[0] == "-" else 1)
    part = int((got["part"] or got["tenths"] or "").ljust(9, "0") or 0)
    return day, (3600 * hour + 60 * minute + second - shift) * _NANOSECONDS + part


def _day(got: Mapping[str, str | None]) -> int:
    if got["y"]:
        return date(int(got["y"]), int(got["m"] or 0), int(got["d"] or 0)).toordinal()
    day, month = int(got["a"] or 0), int(got["b"] or 0)
    # Slashes are American, points and dashes are not; a month beyond 12 is a day.
    if (got["sign"] == "/" and day <= 12) or month > 12:
        day, month = month, day
    return date(int(got["year"] or 0), month, day).toordinal()


class Stamps:
    """The stamps of one column, in the order of its rows: seconds since the first.

    Attributes
    ----------
    begins : float or None
        The first stamp, s since 1970; None without a date.
    """

    def __init__(self) -> None:
        self.begins: float | None = None
        self._first: int | None = None
        self._last = self._midnights = 0

    def second(self, text: str) -> float | None:
        """Seconds since the first stamp; None for what is none."""
        found = _parsed(text)
        if found is None:
            return None
        day, ns = found
        if day >= 0:
            at = day * _DAY_S * _NANOSECONDS + ns
        else:
            # A time of day that falls by half a day has passed midnight.
            if ns - self._last < -_DAY_S * _NANOSECONDS // 2:
                self._midnights += 1
            self._last = ns
            at = self._midnights * _DAY_S * _NANOSECONDS + ns
        if self._first is None:
            self._first = at
            self.begins = at / _NANOSECONDS if day >= 0 else None
        return (at - self._first) / _NANOSECONDS
