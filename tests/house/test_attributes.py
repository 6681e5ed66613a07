"""Whatever a public name leads to says of each of its attributes what it is."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from tests.house.test_docstrings import entries

import stiction as st

PACKAGE = Path(st.__file__).parent
OTHERS = {"jax", "torch", "gym", "control", "mujoco", "paper", "bench"}
"""Modules that the public names do not lead to; extras of some are not installed everywhere."""


@cache
def homes() -> dict[str, str]:
    """The module of every class of the package by its name."""
    found = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        if parts[0] not in OTHERS:
            module = ".".join(("stiction", *(part for part in parts if part != "__init__")))
            for node in ast.parse(path.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.ClassDef):
                    found[node.name] = module
    return found


def functions(value: Any) -> Iterator[Any]:
    """The function itself, or the public methods and properties of a class."""
    if not inspect.isclass(value):
        yield value
        return
    for name in vars(value):
        member = inspect.getattr_static(value, name)
        if not name.startswith("_"):
            yield getattr(member, "fget", None) or getattr(member, "__func__", member)


def leads_to(value: Any) -> set[str]:
    """Classes of the package that attributes and results have in their annotations."""
    told = list(getattr(value, "__annotations__", {}).values()) if inspect.isclass(value) else []
    told += [getattr(each, "__annotations__", {}).get("return", "") for each in functions(value)]
    return {word for text in told for word in re.findall(r"\w+", str(text))} & homes().keys()


def reachable() -> dict[str, type]:
    found: dict[str, type] = {}
    ahead = [getattr(st, name) for name in st.__all__ if name != "__version__"]
    while ahead:
        value = ahead.pop()
        if inspect.isclass(value):
            if value.__name__ in found:
                continue
            found[value.__name__] = value
        ahead += [getattr(import_module(homes()[name]), name) for name in leads_to(value)]
    return found


REACHABLE = {name: value for name, value in reachable().items() if not name.startswith("_")}


def unsaid(value: type) -> list[str]:
    """Public attributes that have neither a type nor a sentence, and methods without one."""
    text = inspect.getdoc(value) or ""
    said = {**entries(text, "Parameters"), **entries(text, "Attributes")}
    fields = {name for name in vars(value).get("__annotations__", {}) if name[0] != "_"}
    missing = sorted(name for name in fields if not any(said.get(name, ())))
    for name, member in vars(value).items():
        if not name.startswith("_") and name not in fields:
            function = member.fget if isinstance(member, property) else getattr(value, name)
            if not inspect.getdoc(function):
                missing.append(name)
    return missing


@pytest.mark.parametrize("name", sorted(REACHABLE))
def test_every_attribute_is_documented(name: str) -> None:
    assert inspect.getdoc(REACHABLE[name])
    assert unsaid(REACHABLE[name]) == []


def test_results_are_among_what_is_looked_at() -> None:
    assert {"Cause", "EffectRecord", "FitParameter", "Parameter", "Part", "View"} <= set(REACHABLE)
