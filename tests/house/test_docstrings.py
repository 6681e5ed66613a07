"""Docstrings of everything public name every parameter, in the form of numpydoc."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import reduce
from typing import Any

import pytest

import stiction as st

EXCEPTIONS = {
    "InputError": "takes a sentence, as every exception does",
    "Trajectory": "made by simulations alone; what it holds stands under Attributes",
}


def public() -> Iterator[tuple[str, Callable[..., Any]]]:
    """What is in ``__all__`` and can be called, and the public methods of its classes."""
    for name in st.__all__:
        value = getattr(st, name)
        if callable(value):
            yield name, value
        for key, member in inspect.getmembers(value, callable) if inspect.isclass(value) else ():
            owner = next((each for each in value.__mro__ if key in vars(each)), object)
            if not key.startswith("_") and owner.__module__.split(".")[0] == "stiction":
                yield f"{name}.{key}", member


PUBLIC = {name: value for name, value in public() if name not in EXCEPTIONS}


def parameters(value: Callable[..., Any]) -> set[str]:
    return set(inspect.signature(value).parameters) - {"self", "cls"}


def section(text: str, title: str) -> str:
    found = re.search(rf"^{title}\n-+\n(.*?)(?=\n\n\S.*\n---|\Z)", text, re.M | re.S)
    return found[1] if found else ""


def entries(text: str, title: str) -> dict[str, tuple[str, str]]:
    """Type and description of each name in a section."""
    found: dict[str, tuple[str, str]] = {}
    for entry in re.split(r"\n(?=\S)", section(text, title)):
        head, _, description = entry.partition("\n")
        names, _, kind = head.partition(" : ")
        found |= {each.strip(" *"): (kind, description) for each in names.split(",")}
    return {name: about for name, about in found.items() if name}


def described(value: Callable[..., Any], text: str) -> dict[str, tuple[str, str]]:
    """Where a class has no Parameters, its Attributes are those of the same names."""
    own = entries(text, "Parameters")
    return own or (entries(text, "Attributes") if inspect.isclass(value) else {})


def resolved(name: str, reference: str) -> tuple[str, Callable[..., Any]]:
    """What a docstring refers to: a method of the same class, or a path from ``stiction``."""
    owner = name.rpartition(".")[0]
    beside = f"{owner}.{reference}"
    path = beside if hasattr(getattr(st, owner, None), reference) else reference
    other: Any = reduce(getattr, path.split("."), st)
    return path, other


def undocumented(name: str, value: Callable[..., Any], text: str) -> list[str]:
    """Parameters without a type, here or where the description says "as for" another."""
    about = described(value, text)
    missing = []
    for parameter in sorted(parameters(value)):
        kind, description = about.get(parameter, ("", ""))
        references = re.findall(r"[Aa]s\s+for\s+`+([\w.]+)`", description)
        for reference in references:
            path, other = resolved(name, reference)
            if parameter in undocumented(path, other, inspect.getdoc(other) or ""):
                missing.append(f"{parameter}, as for {path}")
            elif parameter not in parameters(other):
                missing.append(f"{parameter}, which {path} does not take")
        if not kind and not references:
            missing.append(parameter)
    return missing


@pytest.mark.parametrize("name", PUBLIC)
def test_every_parameter_is_documented(name: str) -> None:
    value = PUBLIC[name]
    text = inspect.getdoc(value) or ""
    assert text, f"{name} has no docstring"
    assert not undocumented(name, value, text)
    assert not entries(text, "Parameters").keys() - parameters(value), "no such parameters"


@pytest.mark.parametrize("name", [name for name in PUBLIC if parameters(PUBLIC[name])])
def test_a_parameter_that_is_taken_out_is_missed(name: str) -> None:
    value = PUBLIC[name]
    text = inspect.getdoc(value) or ""
    for parameter in parameters(value):
        without = re.sub(rf"\b{parameter}\b", "taken_out", text)
        assert parameter in undocumented(name, value, without)


def test_exceptions_are_needed() -> None:
    for name in EXCEPTIONS:
        value = getattr(st, name)
        # Constructors of Python's own may have no signature to look at.
        with suppress(ValueError):
            assert undocumented(name, value, inspect.getdoc(value) or "")


def test_a_trajectory_says_what_it_holds() -> None:
    held = {name for name, _ in inspect.getmembers(st.Trajectory, inspect.isdatadescriptor)}
    documented = entries(inspect.getdoc(st.Trajectory) or "", "Attributes")
    assert {name for name in held if not name.startswith("_")} <= documented.keys()
