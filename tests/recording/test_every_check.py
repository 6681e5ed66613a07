"""Every data check finds what it looks for."""

from __future__ import annotations

import ast
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from stiction.recording import Check, Recording, check, checks
from stiction.recording.checks import impulse_checks, starts

from .test_checks import COUNT, ROWS, machine
from .test_impulses import bursts, driven, moved, recording

FOLDER = Path(checks.__file__).parent


def names() -> set[str]:
    """Names of the checks, as the package makes them."""
    found = set()
    for path in sorted(FOLDER.glob("*.py")):
        tree = ast.parse(path.read_text("utf-8"))
        scopes = [tree, *(each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef))]
        for scope in scopes:
            known = {**words(tree), **words(scope)}
            for node in ast.walk(scope) if scope is not tree else ():
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Check":
                    found |= said(node.args[0], known)
    return found


def said(name: ast.expr, known: dict[str, str]) -> set[str]:
    """What a name of a check comes to."""
    if isinstance(name, ast.Constant):
        return {str(name.value)}
    if isinstance(name, ast.Name):
        return {known[name.id]}
    # One for each kind of stretch.
    assert isinstance(name, ast.JoinedStr)
    return {f"noise at {kind}" for kind in ("standstill", "constant speed")}


def words(scope: ast.Module | ast.FunctionDef) -> dict[str, str]:
    """Words that are given a name right there."""
    found = {}
    for node in scope.body:
        target = getattr(node, "target", None) or getattr(node, "targets", [None])[0]
        value = getattr(node, "value", None)
        if isinstance(target, ast.Name) and isinstance(value, ast.Constant):
            found[target.id] = str(value.value)
    return found


def changed(**channels: np.ndarray | None) -> list[Check]:
    return list(check(Recording(**{**machine(), **channels})))


def with_position(change: Callable[[np.ndarray], None]) -> list[Check]:
    position = machine()["position"]
    change(position)
    return changed(position=position)


def freeze(position: np.ndarray) -> None:
    position[4500:5000] = position[4499]


def stress() -> list[Check]:
    data = machine()
    rows = zip(data["time"], data["position"], strict=True)
    lines = [f"{t},{x},{0.6 + 0.01 * (k % 7)},20" for k, (t, x) in enumerate(rows)]
    columns = {
        "position": {"name": "x", "unit": "m"},
        "friction_coefficient": "mu",
        "normal_force": {"name": "stress", "unit": "MPa"},
    }
    with TemporaryDirectory() as folder:
        path = Path(folder) / "rock.csv"
        path.write_text("\n".join(["time_s,x,mu,stress", *lines]))
        return list(check(Recording.load(path, columns)))


def begun(*labels: dict[str, object]) -> list[Check]:
    data = machine()
    recordings = [Recording(**data, **each) for each in labels]  # type: ignore[arg-type]
    return [each for _, each in starts(recordings)]


def struck() -> list[Check]:
    effort = driven()
    failed = recording(bursts(effort, 20, 1, 5.0), moved(effort))
    return [each for _, each in impulse_checks([failed])]


def at(place: int, value: float) -> Callable[[np.ndarray], None]:
    return lambda values: values.__setitem__(place, value)


TIME = machine()["time"]
SINE = COUNT * np.round(np.sin(7.0 * TIME) / COUNT)
PROVOKED: dict[str, Callable[[], list[Check]]] = {
    "missing cells": lambda: with_position(at(7, np.nan)),
    "clock jitter": lambda: changed(time=TIME + 2e-5 * np.random.default_rng(1).normal(size=ROWS)),
    "gaps": lambda: changed(time=TIME + 0.3 * (np.arange(ROWS) > 5000)),
    "sampling rate": lambda: changed(time=np.cumsum(np.where(np.arange(ROWS) < 3000, 0.001, 0.01))),
    "sampling speed": lambda: list(
        check(Recording(**{name: values[::10] for name, values in machine().items()}))
    ),
    "constant channel": lambda: changed(position=np.ones(ROWS)),
    "spikes": lambda: with_position(at(100, -3.14)),
    "repeated readings": lambda: changed(position=np.repeat(np.sin(20.0 * TIME)[::2], 2)),
    "stuck channel": lambda: with_position(freeze),
    "clipping": lambda: changed(position=np.clip(SINE, -0.9, 0.9)),
    "input saturation": lambda: changed(input=np.clip(machine()["input"], -0.9, 0.9)),
    "input refresh": lambda: changed(input=np.sign(np.sin(5.0 * TIME))),
    "noise": lambda: list(check(Recording(TIME, machine()["input"], None))),
    "noise at standstill": lambda: changed(position=np.sin(9.0 * TIME)),
    "noise at constant speed": lambda: changed(position=np.sin(9.0 * TIME)),
    "unit of the effort": stress,
    "impulses of the input": struck,
    "clock": lambda: begun({"start_s": 1e6}, {"start_s": 1e6 + 20.0}),
    "cold start": lambda: begun({"start_s": 0.0}, {"start_s": 9000.0, "cold": True}),
    "doubtful cold start": lambda: begun({"start_s": 0.0}, {"start_s": 9000.0}),
}
TOLD = {"noise", "cold start"}
"""Checks that tell what is and find nothing wrong."""


def test_the_table_has_every_check_and_no_other() -> None:
    assert names() == set(PROVOKED)


@pytest.mark.parametrize("name", sorted(PROVOKED))
def test_every_check_finds_what_it_looks_for(name: str) -> None:
    found = [each for each in PROVOKED[name]() if each.name == name]
    assert found
    wrong = [each for each in found if each.verdict != "fine"]
    assert bool(wrong) is (name not in TOLD)
    assert all(each.what and each.means for each in wrong)
