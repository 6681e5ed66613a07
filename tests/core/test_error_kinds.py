"""Every kind of error that the core has is met by a user, and by a test."""

from __future__ import annotations

import os
import re
import signal
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stiction as st
from stiction import _native

SOURCE = Path(__file__).parents[2] / "crates" / "stiction-core" / "src" / "support" / "error.rs"
DT = 1e-3
VARIANT = re.compile(r'#\[error\(\s*"((?:[^"\\]|\\.|\\\n)*)".*?\)\]\s*(\w+)', re.DOTALL)


def kinds() -> dict[str, str]:
    """The sentence of each variant of the core's error, as an expression that it matches."""
    text = SOURCE.read_text(encoding="utf-8")
    body = text[text.index("pub enum Error {") : text.index("\n}\n\n/// Shorthand")]
    found = {}
    for sentence, name in VARIANT.findall(body):
        plain = re.sub(r"\\\n\s*", "", sentence)
        parts = re.split(r"(\{\{|\}\}|\{[^{}]*\})", plain)
        found[name] = "".join(
            re.escape(each[0])
            if each in ("{{", "}}")
            else ".*"
            if each[:1] == "{"
            else re.escape(each)
            for each in parts
        )
    return found


def motor(law: str = "coulomb", inertia: float = 0.01, **stated: Any) -> st.Motor:
    return st.Motor(inertia, friction=st.FrictionModel(law), **stated)


def motion() -> st.Motion:
    return _native.Motion(1e-3 * np.sin(np.arange(200) * 0.05), np.zeros(199), DT)


def light() -> st.Motor:
    """Its torque leaves the range of floats where its current does not."""
    return motor(inertia=1e-5, torque_constant=100.0)


def stiff() -> st.Motor:
    """It divides 1 ms into some thousand steps."""
    friction = st.FrictionModel("lugre", initial_stiffness=1e9, coulomb=0.3)
    return st.Motor(0.01, friction=friction, effects={"relaxation": {"speed": 1e-4}})


def out_of_range() -> None:
    """A spring that hardens and is damped without measure, thrown to and fro for days."""
    most = {"initial_stiffness": 1e15, "hardening_coefficient": 1e9, "damping": 1e9}
    friction = st.FrictionModel("hsieh_pan", **most, stribeck_velocity=1e6, slip_distance=1e6)
    for velocity in (1e6, -1e6, 1e-300, 1e6):
        friction.step(velocity, 1e6)


def stated_in_both() -> st.Motor:
    contact = st.FrictionModel("coulomb", effects={"torque_bias": {"bias": 0.1}})
    return st.Motor(0.01, friction=contact, effects={"torque_bias": {"bias": 0.1}})


def of_another_law() -> None:
    contact = st.FrictionModel("dahl")
    contact.state = {"no such entry": 1.0}


def struck() -> None:
    """A long run, and Ctrl-C meanwhile; a shell may have let this process ignore it."""
    usual = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.15, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        motor().simulate(np.zeros(60_000_000), 1e-4, outputs=())
    finally:
        timer.join()
        signal.signal(signal.SIGINT, usual)


RIPPLE = {"torque_constant_ripple": {"order": 1.0}}
PROVOKED: dict[str, Callable[[], Any]] = {
    "UnknownName": lambda: st.FrictionModel("hseih_pan"),
    "WrongKind": lambda: st.FrictionModel("coulomb", viscous="0.1"),
    "OutOfBounds": lambda: st.FrictionModel("coulomb", viscous=-1.0),
    "NotFinite": lambda: motor().step(np.nan, DT),
    "BadSample": lambda: motor().simulate([0.1, np.nan], DT),
    "Order": lambda: st.FrictionModel("coulomb", coulomb=0.3, breakaway=0.2),
    "TooLong": lambda: st.Motor(
        0.0076, friction=st.FrictionModel("hsieh_pan", initial_stiffness=1e12)
    ).simulate([0.1] * 3, 1.0),
    "RanAway": lambda: light().step(1e308, DT),
    "RanUnseen": lambda: light().simulate([1e308], DT, outputs=["mode"]),
    "Nowhere": lambda: motor(effects={"cogging": {"order": 1e9, "sine": 1.0}}).reset(1e308),
    "OutOfRange": out_of_range,
    "Interrupted": struck,
    "TooMuchWork": lambda: stiff().simulate(np.full(4000, 0.1), DT),
    "TooManySteps": lambda: stiff().simulate_segments(np.full(40, 200.0), np.full(40, 0.3)),
    "State": of_another_law,
    "Gain": lambda: motor().signatures(motion(), [("torque_bias", {"bias": 0.1})]),
    "NotAtContact": lambda: st.FrictionModel("coulomb", effects=RIPPLE),
    "Twice": stated_in_both,
    "NoStart": lambda: motor("dahl").follow_sensitivity(motion(), ["start.force"]),
    "Kernel": lambda: motor().follow_rows(motion(), _native.RowKernel([0.5, 0.5], [1.0], 1)),
    "Member": lambda: st.Ensemble(light(), 3).step_many([0.1, 1e308, 0.1], DT),
    "Length": lambda: motor().simulate_segments([1.0, 1.0], [0.1]),
}


def test_the_table_has_every_kind_and_no_other() -> None:
    assert set(kinds()) == set(PROVOKED)


@pytest.mark.parametrize("kind", sorted(PROVOKED))
def test_a_user_meets_every_kind(kind: str) -> None:
    if kind == "Interrupted":
        # Python says it in its own way.
        with pytest.raises(KeyboardInterrupt):
            PROVOKED[kind]()
        return
    with pytest.raises((st.InputError, TypeError)) as met:
        PROVOKED[kind]()
    assert re.search(kinds()[kind], str(met.value), re.DOTALL), str(met.value)
