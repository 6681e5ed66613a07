"""What there is to call: found by looking, so that nothing new has to be listed."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, is_dataclass
from functools import cache
from pathlib import Path
from typing import Any

import stiction

HIDDEN = {
    "drafting": "the verbs init and diagnose are run as commands",
    "cli": "its verbs are run as commands",
    "bench": "lays out, diagnoses and counts folders of sessions; its verb is run as a command",
}
"""Packages that are not looked through, and why."""
BESIDE = ("_native",)
"""Modules that are no packages, and whose names users or the issue's callers take."""
EXCLUDED = {
    "stiction.InputError": "takes a sentence, as every exception does",
    "stiction.Trajectory": "made by simulations alone",
    "stiction.EnsembleRun": "made by simulations alone",
    "stiction.CurveFit": "made by fits alone",
    "stiction.FitResult": "made by fits alone",
    "stiction.Diagnosis": "made by diagnoses alone",
    "stiction.plan.Plan": "made by plans alone",
    "stiction.robot.RobotPlan": "made by plans alone",
    "stiction.robot.RobotSignal": "made by plans alone",
    "stiction._native.least_squares": "calls back what a fit gives it",
}
"""Public callables that no case calls, and why."""
PARTS = {
    "Cell": "part of a comparison or a table",
    "Property": "part of a comparison",
    "UnitNumber": "part of a comparison",
    "Row": "part of a comparison",
    "FitParameter": "part of a fit",
    "Estimated": "part of an estimate",
    "StaticCase": "describes an experiment of the paper",
    "Experiment": "describes an experiment of a plan",
    "JointFindings": "part of a diagnosis of a robot",
    "Fold": "part of a split",
    "Repair": "part of a recording",
    "Unit": "part of a list of units",
    "Column": "part of a mapping",
}
"""Records that others hold and show, and why they are not made by themselves."""
EXTENDED = "the package's class of the same name extends it"
RECORDS = "a record without checks: what makes it is called"


def names_read(line: str) -> set[str]:
    """Names that a line needs before it runs."""
    nodes = (node for node in ast.walk(ast.parse(line)) if isinstance(node, ast.Name))
    return {node.id for node in nodes if isinstance(node.ctx, ast.Load)}


@dataclass(frozen=True)
class Target:
    """Something to call.

    Attributes
    ----------
    name : str
        Such as ``stiction.fit`` or ``Motor.step``.
    call : str
        How a program calls it: a path, or ``x.step`` of a receiver x.
    value : callable
    owner : type or None
        The class of the receiver; None for functions and constructors.
    kind : {"function", "class", "method", "setter", "look"}
        "look" reads every property of an object, and shows it.
    """

    name: str
    call: str
    value: Any
    owner: type | None = None
    kind: str = "function"


@cache
def modules() -> list[str]:
    """Where public names are."""
    inside = pkgutil.iter_modules(stiction.__path__)
    packages = [m.name for m in inside if m.ispkg and m.name not in HIDDEN and m.name[0] != "_"]
    return ["stiction", *(f"stiction.{name}" for name in [*packages, *BESIDE])]


def named() -> Iterator[tuple[str, Any]]:
    """Every public name once: where it is first."""
    seen: set[int] = set()
    for path in modules():
        module = importlib.import_module(path)
        for name in module.__all__:
            value = getattr(module, name)
            if callable(value) and id(value) not in seen:
                seen.add(id(value))
                yield f"{path}.{name}", value


def of_house(owner: type) -> bool:
    return owner.__module__.split(".")[0] in ("stiction", "builtins", "_native")


def members(cls: type) -> Iterator[tuple[str, Any, Any]]:
    """Public members of a class that the package defines: name, as defined, as looked up."""
    for name in sorted(set(dir(cls))):
        owner = next((each for each in cls.__mro__ if name in vars(each)), object)
        if name.startswith("_") or owner in (object, Exception, ValueError, KeyError, tuple):
            continue
        if issubclass(owner, BaseException) or not of_house(owner):
            continue
        yield name, vars(owner)[name], getattr(cls, name)


def reason_to_pass(path: str, value: Any) -> str:
    """Why a public callable is no target, "" where it is one."""
    if path in EXCLUDED:
        return EXCLUDED[path]
    if not inspect.isclass(value):
        return ""
    if path.startswith("stiction._native.") and hasattr(stiction, value.__name__):
        return EXTENDED
    if issubclass(value, stiction_result()) or issubclass(value, tuple):
        return RECORDS
    if is_dataclass(value) and "__post_init__" not in vars(value):
        by_hand = not value.__dataclass_params__.init  # type: ignore[attr-defined]
        return "" if by_hand else RECORDS
    return ""


def stiction_result() -> type:
    """The class of what the paper's experiments return."""
    result: type = importlib.import_module("stiction.paper").Result
    return result


@cache
def targets() -> dict[str, Target]:
    """Every public function, constructor, method and setter, by name."""
    found: dict[str, Target] = {}

    def add(target: Target) -> None:
        found.setdefault(target.name, target)

    for path, value in named():
        short = path.removeprefix("stiction.")
        bare = short.removeprefix("_native.")
        short = short if bare in found else bare
        if not inspect.isclass(value):
            if not reason_to_pass(path, value):
                add(Target(short, path, value))
            continue
        if not reason_to_pass(path, value):
            add(Target(short, path, value, kind="class"))
        if issubclass(value, BaseException) or value.__name__ in PARTS:
            continue
        if reason_to_pass(path, value) == EXTENDED:
            continue
        add(Target(f"{short} read", "look", value, value, "look"))
        for name, raw, member in members(value):
            _add_member(add, path, short, value, name, raw, member)
    return found


def _add_member(
    add: Callable[[Target], None],
    path: str,
    short: str,
    cls: type,
    name: str,
    raw: Any,
    member: Any,
) -> None:
    if isinstance(raw, classmethod | staticmethod):
        add(Target(f"{short}.{name}", f"{path}.{name}", member))
    elif callable(member):
        add(Target(f"{short}.{name}", f"x.{name}", member, cls, "method"))
    elif settable(cls, name, raw):
        add(Target(f"{short}.{name}=", f"x.{name}", member, cls, "setter"))


def settable(cls: type, name: str, raw: Any) -> bool:
    """Whether a property is made to be set: the compiled module's tell it by their stubs alone."""
    if isinstance(raw, property):
        return raw.fset is not None
    return any((each.__name__, name) in stated_setters() for each in cls.__mro__)


@cache
def stated_setters() -> set[tuple[str, str]]:
    """Class and property of every setter in the stubs."""
    stub = Path(stiction.__file__).with_name("_native.pyi")
    return {
        (each.name, member.name)
        for each in ast.parse(stub.read_text(encoding="utf-8")).body
        if isinstance(each, ast.ClassDef)
        for member in each.body
        if isinstance(member, ast.FunctionDef)
        and any(isinstance(d, ast.Attribute) and d.attr == "setter" for d in member.decorator_list)
    }
