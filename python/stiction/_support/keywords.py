"""Calls with a keyword that is not there: one sentence with the name that is meant."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from functools import wraps
from typing import Any, Final, ParamSpec, TypeVar

from ..errors import CallError, InputError
from .wording import commas, did_you_mean

__all__ = ["explain_constructor", "explain_keywords"]

P = ParamSpec("P")
R = TypeVar("R")

_NO_COLUMNS: Final = (
    "time dt time_step timestep step ts h period sample_time fs rate frequency",
    "inertia mass j m",
    "torque_constant gain kt kv kf motor_constant",
    "friction law model friction_model frictionmodel laws",
    "plant machine motor robot",
    "session recordings recording data dataset",
    "without exclude skip ignore",
    "threads workers n_jobs jobs cores n_threads",
    "seed random_state rng",
    "parameters params samples ranges",
    "to target format kind",
)
"""What is said of the same thing, beside the words of columns; the data tell nothing of these."""


def explain_keywords(function: Callable[P, R]) -> Callable[P, R]:
    """A function that tells of an unknown or missing keyword which one is meant.

    What is meant is found by the words that columns of recordings are known by, and by spelling:
    another function needs no list of its own.

    Parameters
    ----------
    function : callable
        A public one, documented as numpydoc does.

    Returns
    -------
    callable
        The same, which raises ``CallError`` in place of the interpreter's TypeError.
    """

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return function(*args, **kwargs)
        except TypeError:
            # Of a call that fits its signature the error is another one.
            called = function.__qualname__, inspect.getdoc(function) or ""
            told = _mistake(inspect.signature(function), args, kwargs, *called)
            if told is None:
                raise
        except InputError as error:
            order = _exchange(inspect.signature(function), args, inspect.getdoc(function) or "")
            if not order:
                raise
            told = f"{error}; {order}"
        raise CallError(told)

    return call


def explain_constructor(cls: type[R]) -> type[R]:
    """A class whose constructor tells of keywords as ``explain_keywords`` does.

    Parameters
    ----------
    cls : type
        Its parameters are documented in its own docstring.

    Returns
    -------
    type
        The same class.
    """
    signature = inspect.signature(cls)
    name = "__init__" if "__init__" in vars(cls) else "__new__"
    made: Callable[..., Any] = getattr(cls, name)

    @wraps(made)
    def call(own: Any, *args: Any, **kwargs: Any) -> Any:
        try:
            return made(own, *args, **kwargs)
        except TypeError:
            told = _mistake(signature, args, kwargs, cls.__name__, inspect.getdoc(cls) or "")
            if told is None:
                raise
        raise CallError(told)

    # What is compiled has no signature of its own to be found behind the wrapper.
    own = inspect.Parameter("own", inspect.Parameter.POSITIONAL_ONLY)
    parameters = [own, *signature.parameters.values()]
    shown = inspect.Signature(parameters, return_annotation=signature.return_annotation)
    call.__signature__ = shown  # type: ignore[attr-defined]
    setattr(cls, name, call)
    return cls


def _mistake(
    signature: inspect.Signature,
    given: tuple[object, ...],
    keywords: Mapping[str, object],
    named: str,
    text: str,
) -> str | None:
    """What a call names or leaves out against the signature, None where it fits that."""
    try:
        bound = signature.bind(*given, **keywords).arguments
    except TypeError as error:
        why = str(error)
    else:
        if order := _exchange(signature, given, text):
            return f"{named}: {order}"
        return _misplaced(bound, signature.parameters, named, text)
    kinds = inspect.Parameter
    known = {
        name: each
        for name, each in signature.parameters.items()
        if name not in ("self", "cls") and each.kind is not kinds.VAR_KEYWORD
    }
    takes = f"it takes {commas(known)}"
    filled = _filled(signature, given)
    free = [name for name in known if name not in keywords and name not in filled]
    for name in keywords:
        if name not in known:
            meant = next((each for each in free if _means(name) & _means(each)), None)
            if meant is not None:
                return (
                    f"{named}: '{name}' is unknown; it is called '{meant}' here"
                    f"{_meaning(text, meant)}; {takes}"
                )
            if not _takes_any(signature):
                return f"{named}: '{name}' is unknown{did_you_mean(name, known)}; {takes}"
    missing = next((name for name in free if known[name].default is kinds.empty), None)
    if missing is not None:
        return f"{named}: {missing} is missing{_meaning(text, missing)}; {takes}"
    return f"{named}: {why}; {takes}"


def _exchange(signature: inspect.Signature, given: tuple[object, ...], text: str) -> str:
    """In which order a number and an array belong that were exchanged, "" where they were not."""
    places = signature.bind_partial(*given).arguments
    for name, value in places.items():
        only_arrays = re.search(rf"^{name} : array_like", text, re.MULTILINE)
        array = next((other for other, its in places.items() if _is_array(its)), None)
        if only_arrays and array and isinstance(value, float | int):
            shown = [each for each in places if each != "self"]
            return f"{array} is an array: the order is {', '.join(shown)}"
    return ""


def _misplaced(
    given: Mapping[str, object], parameters: Iterable[str], named: str, text: str
) -> str | None:
    """An array for a number, or an object in the place of another parameter; None without one."""
    for name, value in given.items():
        if re.search(rf"^{name} : float$", text, re.MULTILINE) and _is_array(value):
            return f"{named}: {name} is no number; give one{_meaning(text, name)}"
        kind = type(value)
        meaning = _means(kind.__name__) if kind.__module__.partition(".")[0] == "stiction" else ()
        meant = next((each for each in parameters if _means(each).intersection(meaning)), name)
        if meant != name:
            return (
                f"{named}: {name} is a {kind.__name__}, and that belongs to {meant}; write "
                f"{meant}=..."
            )
    return None


def _is_array(value: object) -> bool:
    return hasattr(type(value), "__len__")


def _takes_any(signature: inspect.Signature) -> bool:
    every = signature.parameters.values()
    return any(each.kind is inspect.Parameter.VAR_KEYWORD for each in every)


def _filled(signature: inspect.Signature, given: tuple[object, ...]) -> Iterable[str]:
    """Parameters that are given by place."""
    try:
        return signature.bind_partial(*given).arguments
    except TypeError:
        return signature.parameters


def _means(name: str) -> frozenset[str]:
    """What a name may be the name of."""
    from ..recording.column_words import WORDS

    word = name.casefold()
    found = {line.partition(" ")[0] for line in _NO_COLUMNS if word in line.split()}
    if found:
        return frozenset(found)
    part = next((part for part in (word, *word.split("_")) if part in WORDS), None)
    return frozenset(WORDS[part].kinds[:1] if part else ())


def _meaning(text: str, name: str) -> str:
    """The first sentence on a parameter, in brackets."""
    found = re.search(rf"^(?:\w+, )*\*?{name}\b[^\n]*\n((?: +\S[^\n]*\n?)+)", text, re.MULTILINE)
    if found is None:
        return ""
    sentence = re.split(r"[.;](?=\s|$)", " ".join(found[1].split()))[0]
    # A, V and the like stay what they are.
    begins = sentence[:1].lower() if sentence[1:2].islower() else sentence[:1]
    return f" ({begins}{sentence[1:]})"
