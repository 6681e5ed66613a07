"""What callers hand over: of the right kind, or refused in a sentence."""

from __future__ import annotations

import math
import os
import stat
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from numbers import Real
from pathlib import Path
from types import UnionType
from typing import Any, Final, TypeVar

import numpy as np
import numpy.typing as npt

from ..errors import InputError

__all__ = [
    "MOST_WHOLE",
    "brief",
    "each_of",
    "explain_write_errors",
    "instance",
    "mapping",
    "memory_for",
    "names",
    "number",
    "numbers",
    "path",
    "real",
    "refuse_mask",
    "regular",
    "share",
    "vacant",
    "whole",
    "word",
    "yes_or_no",
]

T = TypeVar("T")
_NO_FILES: Final = {
    stat.S_IFIFO: "pipe",
    stat.S_IFSOCK: "socket",
    stat.S_IFCHR: "device",
    stat.S_IFBLK: "device",
}
_REAL: Final = "biufO"
"""Kinds of numpy's types; Python's own numbers, Decimal and Fraction among them, are objects."""
MOST_WHOLE: Final = 2**62
"""What a counter of the machine holds."""
_WORTH_ASKING: Final = 2.0**26
"""Bytes."""


def each_of(given: Any, where: str, remedy: str) -> Iterator[Any]:
    """Go through a sequence.

    Parameters
    ----------
    given : iterable
    where : str
        What it is called.
    remedy : str
        What to give instead.

    Raises
    ------
    InputError
        Nothing that can be gone through: a number, also as an array of no dimensions.
    """
    try:
        return iter(given)
    except TypeError:
        raise InputError(f"{where} = {brief(given)} is no sequence; give {remedy}") from None


def instance(given: object, kind: type[T] | UnionType, where: str, remedy: str) -> T:
    """Take an object of a class.

    Parameters
    ----------
    given : object
    kind : type, or several with | between
    where : str
        What it is called, such as ``"fit: plant"``.
    remedy : str
        What to give instead.

    Raises
    ------
    InputError
        Anything else.
    """
    if not isinstance(given, kind):
        raise InputError(f"{where} is {brief(given)}; give {remedy}")
    return given


def mapping(given: Any, where: str, remedy: str) -> Mapping[str, Any]:
    """Take a mapping, an empty one for None.

    Raises
    ------
    InputError
        Anything else.
    """
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise InputError(f"{where} is {brief(given)}; give {remedy}")
    return given


def memory_for(size: float, what: str) -> None:
    """Ask for memory before the core does, which could only abort.

    Parameters
    ----------
    size : float
        Bytes; small requests are not looked at.
    what : str
        What they are for, with what makes it less: ``"10 machines; give fewer"``.

    Raises
    ------
    InputError
        There is not that much.
    """
    if size < _WORTH_ASKING:
        return
    try:
        # Handed out by the system and given back, never touched.
        np.empty(int(size), dtype=np.uint8)
    except (MemoryError, OverflowError, ValueError):
        raise InputError(f"there is no memory ({size / 2**30:.3g} GiB) for {what}") from None


def regular(file: Path) -> os.stat_result:
    """What the system says of a file that can be read to its end.

    Reading a pipe or a device may wait for ever, or never come to an end.

    Parameters
    ----------
    file : Path
        Follows links.

    Raises
    ------
    InputError
        A pipe, a socket or a device.
    OSError
        It cannot be looked at.
    """
    found = file.stat()
    if kind := _NO_FILES.get(stat.S_IFMT(found.st_mode)):
        raise InputError(f"{file}: this is a {kind} and no file; save what comes from it to a file")
    return found


def names(given: Any, where: str) -> list[str]:
    """Take a sequence of names, no single word.

    Raises
    ------
    InputError
        A word, no sequence, or something else among them.
    """
    if isinstance(given, str):
        raise InputError(f"{where} = '{given}' is a word; give a sequence of names")
    names = list(each_of(given, where, "a sequence of names"))
    for k, name in enumerate(names):
        if not isinstance(name, str):
            raise InputError(f"{where}[{k}] = {brief(name)} is no word; give a sequence of names")
    return names


def path(given: str | os.PathLike[str], where: str) -> Path:
    """Take a path.

    Raises
    ------
    InputError
        Anything that names no file: None, a number, bytes.
    """
    if not isinstance(given, str | os.PathLike) or isinstance(os.fspath(given), bytes):
        raise InputError(f"{where}: {brief(given)} is not a path; give the name of a file")
    try:
        nameable = b"\0" not in os.fsencode(given)
    except UnicodeEncodeError:
        nameable = False
    if not nameable:
        raise InputError(
            f"{where}: {os.fspath(given)!r} is no name that a file can have; leave out what no "
            "encoding knows, and zero bytes"
        )
    return Path(given)


def whole(given: Any, name: str, *, least: int, most: int | None = None) -> int:
    """Take a whole number, numpy's too.

    Raises
    ------
    InputError
        Anything else, such as 1.9 or True, or one out of bounds.
    """
    try:
        number = None if isinstance(given, bool) else int(given.__index__())
    except (AttributeError, TypeError):
        number = None
    if number is None or number < least or (most is not None and number > most):
        upto = "" if most is None else f" to {most}"
        raise InputError(
            f"{name} = {brief(given)} is out of bounds: give a whole number from {least}{upto}"
        )
    return number


def share(given: Any, name: str) -> float:
    """Take a share above 0 and below 1.

    Raises
    ------
    InputError
        Anything else.
    """
    number = given if isinstance(given, Real) and not isinstance(given, bool) else None
    if number is None or not 0.0 < float(number) < 1.0:
        raise InputError(
            f"{name} = {brief(given)} is out of bounds: give a share above 0 and below 1, such as "
            "0.01"
        )
    return float(number)


def yes_or_no(given: object, where: str) -> bool:
    """Take True or False, of numpy as well.

    Parameters
    ----------
    given : object
    where : str
        What it is called.

    Raises
    ------
    InputError
        Anything else.
    """
    if not isinstance(given, bool) and type(given).__name__ not in ("bool_", "bool"):
        raise InputError(f"{where} is {brief(given)}; give True or False")
    return bool(given)


def refuse_mask(given: object, where: str) -> None:
    """Refuse an array that is masked somewhere: an input has no gaps.

    Raises
    ------
    InputError
    """
    if isinstance(given, np.ma.MaskedArray) and np.ma.is_masked(given):
        raise InputError(f"{where} is masked in places; fill these, or leave them out")


def vacant(folder: Path, names: Iterable[str], remedy: str = "another folder") -> None:
    """Refuse a folder that holds a file of one of these names: nothing is overwritten.

    Parameters
    ----------
    folder : Path
    names : iterable of str
        Of the files that are to be written into it.
    remedy : str
        What to give instead.

    Raises
    ------
    InputError
        One of them is there.
    """
    for name in names:
        # Also a link that leads nowhere: it is there, and would be written through.
        if os.path.lexists(folder / name):
            raise InputError(
                f"{folder / name}: is there already and is not overwritten; move it away, or give "
                f"{remedy}"
            )


def number(given: Any, where: str) -> float:
    """Take a number that is not NaN, numpy's too.

    Raises
    ------
    InputError
        Anything else.
    """
    # numpy calls a span of time a whole number.
    timed = getattr(getattr(given, "dtype", None), "kind", "f") not in "iuf"
    if isinstance(given, bool) or not isinstance(given, Real) or timed:
        kind = type(given).__name__
        told = brief(given)
        what = "" if told == f"a {kind}" else f"{told} "
        quoted = "; leave out the quotes" if _is_number(given) else ""
        if not quoted and isinstance(given, str) and _is_number(given.strip().partition(" ")[0]):
            quoted = "; write it alone and in SI units, without the unit"
        raise InputError(f"{where}: {what}is a {kind}; allowed is a number{quoted}")
    try:
        converted = float(given)
    except OverflowError:  # TOML has no largest integer
        raise InputError(f"{where}: a whole number beyond 1e308; give a smaller one") from None
    if math.isnan(converted):
        raise InputError(f"{where}: nan is not a number; give one")
    return converted


def numbers(given: Any, where: str) -> npt.NDArray[np.float64]:
    """Take an array of numbers, none of them masked.

    Raises
    ------
    InputError
        Anything else.
    """
    refuse_mask(given, where)
    try:
        array: npt.NDArray[np.float64] = np.asarray(real(given), dtype=np.float64)
    except (OverflowError, TypeError, ValueError) as error:
        raise InputError(f"{where} is not an array of numbers: {error}") from None
    return array


def real(given: Any) -> npt.NDArray[Any]:
    """An array of what can be read as real numbers.

    Dates, words and complex numbers are of another kind: numpy would make floats of them.

    Raises
    ------
    TypeError
        Anything else.
    """
    array = np.asarray(given)
    if array.dtype.kind not in _REAL:
        raise TypeError(f"the type is {array.dtype}")
    if array.dtype.kind == "O":
        for item in array.flat:
            if isinstance(item, complex | str | bytes | np.generic) and not isinstance(
                item, np.bool_ | np.integer | np.floating
            ):
                raise TypeError(f"{brief(item)} is among them")
    return array


def word(given: Any, where: str) -> str:
    """Take a word.

    Raises
    ------
    InputError
        Anything else.
    """
    if not isinstance(given, str):
        raise InputError(f"{where} is {brief(given)}; give a word")
    return given


@contextmanager
def explain_write_errors(file: Path) -> Iterator[None]:
    """Says in a sentence that a file cannot be written.

    Raises
    ------
    InputError
        In place of an OSError from inside.
    """
    try:
        yield
    except OSError as error:
        raise InputError(
            f"{file}: cannot be written ({error.strerror or error}); name another file"
        ) from None


def brief(given: object) -> str:
    """An object in a sentence: short, on one line."""
    try:
        shown = " ".join(repr(given).split())
    except Exception:  # what is foreign may fail to show itself, and Python does for huge numbers
        shown = ""
    if not shown or len(shown) > 60 or type(given).__repr__ is object.__repr__:
        return f"a {type(given).__name__}"
    return shown


def _is_number(given: Any) -> bool:
    """Whether a word is a number in quotes."""
    try:
        return isinstance(given, str) and math.isfinite(float(given))
    except ValueError:
        return False
