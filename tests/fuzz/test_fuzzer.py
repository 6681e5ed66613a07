"""The fuzzer finds what it is there for: each kind of fault, planted on purpose."""

from __future__ import annotations

import os
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from functools import wraps
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stiction as st

from . import hunt as hunting
from .cases import program
from .hunt import Tally, Task, Worker, hunt
from .judge import Find, fault_of_sentence, judge
from .shrink import shrunk
from .surface import targets

LINES = ["x = motor()", "x.simulate([0.1, 0.2], 1e-3, load=0.5)", "x.step(0.1, 1e-3)"]
SOUND = st.Motor.simulate
COUNTED = count()


class PanicException(BaseException):
    """As the compiled module's."""


def nan(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    return 0.5 * float("nan")


def quiet_nan(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    run = SOUND(motor, *args, **keywords)
    return run.position, run.velocity * np.inf


def index_error(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    return [][3]


def recursion(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    return recursion(motor)


def memory(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    raise MemoryError


def works_for_ever(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    while True:
        pass


def waits_for_ever(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    time.sleep(1000.0)


def panics(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    raise PanicException("index out of bounds")


def aborts(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    os.abort()


def moves_and_refuses(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    motor.step(0.7, 1e-3)
    raise st.InputError("current[0] = 0.1 is too small; give more")


def warns(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    warnings.warn("overflow encountered in multiply", RuntimeWarning, stacklevel=2)


def counts(motor: st.Motor, *args: Any, **keywords: Any) -> Any:
    return next(COUNTED)


KINDS: dict[str, tuple[Callable[..., Any], str]] = {
    "no number": (nan, "not finite"),
    "infinities in an array": (quiet_nan, "not finite"),
    "an IndexError": (index_error, "foreign error"),
    "a recursion": (recursion, "foreign error"),
    "no memory": (memory, "foreign error"),
    "a hang": (works_for_ever, "hang"),
    "a wait": (waits_for_ever, "waits for ever"),
    "a panic": (panics, "panic"),
    "an abort": (aborts, "abort"),
    "a state that a refusal changed": (moves_and_refuses, "changed by a refusal"),
    "a warning": (warns, "warning"),
    "other bits": (counts, "not repeated"),
}


@pytest.fixture
def planted(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[Callable[..., Any]], Worker]]:
    """A worker in whose process a fault was planted."""
    monkeypatch.setattr(hunting, "CPU_S", 0.2)
    monkeypatch.setattr(hunting, "WALL_TIMES", 10.0)
    workers = []

    # What is called is found out before there is a fault, whose signature is another.
    targets()

    def plant(fault: Callable[..., Any]) -> Worker:
        monkeypatch.setattr(st.Motor, "simulate", fault)
        workers.append(Worker())
        return workers[-1]

    yield plant
    for worker in workers:
        worker.close()


@pytest.mark.parametrize("name", KINDS)
def test_a_planted_fault_is_found_and_the_hunt_goes_on(
    name: str, planted: Callable[[Callable[..., Any]], Worker]
) -> None:
    fault, kind = KINDS[name]
    worker = planted(fault)
    found = worker.run(Task("Motor.simulate", "planted", LINES))
    assert [find.kind for find in found] == [kind], found
    assert found[0].line == LINES[1]
    assert worker.run(Task("Motor.step", "sound", ["x = motor()", "x.step(0.1, 1e-3)"])) == []


def test_the_place_of_a_hang_is_told(planted: Callable[[Callable[..., Any]], Worker]) -> None:
    # Its code says that it stands in this file, so that every moment of the hang is there.
    code: dict[str, Any] = {}
    deep = "def deep(motor, *args, **keywords):\n    while True:\n        pass\n"
    exec(compile(deep, str(Path(st.__file__).with_name("motor.py")), "exec"), code)

    found = planted(code["deep"]).run(Task("Motor.simulate", "planted", LINES))
    assert found[0].where.startswith("motor.py")


def test_what_is_sound_finds_nothing() -> None:
    assert judge(LINES) == []
    refused = ["x = motor()", "x.simulate([0.1], -1.0)", "x.simulate('a', 1e-3)", "round_trips(x)"]
    assert judge(refused) == []


def test_a_motor_that_gains_energy_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def driven(motor: st.Motor, current: Any, dt: Any, **keywords: Any) -> Any:
        return SOUND(motor, np.asarray(current) + 5.0, dt, **keywords)

    lines = ["x = motor()", "x.reset(0.0, 3.0)", "coasts(x, 1e-3, 100)"]
    assert judge(lines) == []
    monkeypatch.setattr(st.Motor, "simulate", driven)
    assert [find.kind for find in judge(lines)] == ["broken"]


def test_a_state_that_does_not_come_back_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def forgetful(motor: st.Motor) -> st.Motor:
        return type(motor)(friction=motor.friction, **motor.settings())

    lines = ["x = motor()", "x.simulate([1.0, 1.0], 1e-3)", "round_trips(x)"]
    assert judge(lines) == []
    monkeypatch.setattr(st.Motor, "copy", forgetful)
    assert [find.kind for find in judge(lines)] == ["broken"]


def test_a_planted_fault_is_found_by_drawing(monkeypatch: pytest.MonkeyPatch) -> None:
    @wraps(SOUND)
    def odd(motor: st.Motor, current: Any, dt: Any, **keywords: Any) -> Any:
        if np.size(current) == 7:
            raise ZeroDivisionError("division by zero")
        return SOUND(motor, current, dt, **keywords)

    monkeypatch.setattr(st.Motor, "simulate", odd)
    cases = (Task("Motor.simulate", f"planted.{k}") for k in range(400))
    hit = [
        case
        for case in cases
        if len(case.program()) == 2 and "x.simulate(wave(7," in case.program()[-1]
    ][:8]
    worker = Worker()
    try:
        found = [find.where for case in hit for find in worker.run(case)]
    finally:
        worker.close()
    assert any("ZeroDivisionError" in where for where in found)


def test_a_hunt_counts_what_it_runs_and_goes_by_weight() -> None:
    tally = Tally()
    list(hunt(1.0, 1, 1, tally, ("FrictionModel.step", "laws")))
    assert sum(tally.calls.values()) > 1
    assert tally.next(("paper.estimate", "Motor.step")) == "Motor.step"


def test_a_case_is_the_same_again_from_its_seed() -> None:
    for name in ("Motor.simulate", "file..csv", "fit", "coast"):
        assert program(name, "12.3") == program(name, "12.3")
        assert program(name, "12.3") != program(name, "12.4")


def test_a_find_is_made_short() -> None:
    def judged(lines: list[str]) -> list[Find]:
        return [Find("kind", "where", "")] if any("load=" in line for line in lines) else []

    program = ["y = 3", *LINES, "x.simulate([0.1], 1e-3, load=0.25, outputs=['position'])"]
    short = shrunk(program, Find("kind", "where", ""), judged, time.monotonic() + 5.0)
    assert len(short) == 1
    assert "outputs" not in short[0]


NO_SENTENCES = [
    "",
    " ",
    "a\nb",
    "the dt is",
    "give one of:",
    "x" * 20000,
    "a \ud800 b",
    "object at 0x7f34567890ab is none",
    "run.mat ('NoneType' object has no attribute 'attrs')",
]


@pytest.mark.parametrize("said", NO_SENTENCES)
def test_what_is_no_sentence_is_told(said: str) -> None:
    assert fault_of_sentence(said)


def test_a_sentence_of_the_house_is_one() -> None:
    with pytest.raises(st.InputError) as caught:
        st.FrictionModel("lugr")
    assert fault_of_sentence(str(caught.value)) == ""


PROGRAMS = """
from tests.fuzz.cases import names, program
from hashlib import sha256
drawn = [line for name in names() for k in range(3) for line in program(name, f"7.{k}")]
print(sha256("\\n".join(drawn).encode("utf-8", "replace")).hexdigest())
"""


def test_a_case_is_the_same_in_every_process() -> None:
    digests = {
        subprocess.run(
            [sys.executable, "-c", PROGRAMS],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }
    assert len(digests) == 1


def test_a_case_that_is_given_no_more_time_found_nothing(
    planted: Callable[[Callable[..., Any]], Worker],
) -> None:
    worker = planted(waits_for_ever)
    began = time.monotonic()
    assert worker.run(Task("Motor.simulate", "planted", LINES), began + 0.5) == []
    assert time.monotonic() - began < 20.0


def test_a_program_leaves_nothing_where_the_fuzzer_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert not judge(["x = motor()", "x.simulate([0.1], 1e-3).save('here.npz')"])
    assert not list(tmp_path.iterdir())
