"""Nothing public is left out, and what is drawn is mostly taken."""

from __future__ import annotations

import inspect
import re

import pytest

import stiction as st
from stiction.recording.formats import FORMATS

from . import surface
from .cases import LONG, names, program, receiver
from .draw import EFFECTS, LAWS, Draw
from .files import WRITERS, kinds, writer
from .hunt import CPU_S, patience
from .judge import run
from .surface import EXCLUDED, PARTS, reason_to_pass, targets
from .world import PRODUCERS

SEEDS = 40
"""Cases among which one is taken as it is."""


def test_every_public_callable_is_called_or_has_a_reason() -> None:
    calls = {target.call for target in targets().values()}
    for path, value in surface.named():
        if not reason_to_pass(path, value):
            assert path in calls, f"no case calls {path}"
        if not inspect.isclass(value) or issubclass(value, BaseException):
            continue
        if value.__name__ in PARTS or reason_to_pass(path, value) == surface.EXTENDED:
            continue
        short = path.removeprefix("stiction.").removeprefix("_native.")
        for name, _ in inspect.getmembers(value, callable):
            own = next(c for c in value.__mro__ if name in vars(c))
            if not name.startswith("_") and own.__module__.startswith("stiction"):
                assert f"{short}.{name}" in targets(), f"no case calls {path}.{name}"


def test_everything_in_the_packages_list_is_looked_at() -> None:
    known = {path for path, _ in surface.named()}
    assert {f"stiction.{name}" for name in st.__all__ if name != "__version__"} <= known
    assert {"stiction.plan.plan", "stiction.compare.compare", "stiction._native.played"} <= known


def test_there_is_one_of_every_class_to_call() -> None:
    owners = {t.owner.__name__ for t in targets().values() if t.owner is not None}
    drawn = {name for name in owners if "made(" not in receiver(Draw("0"), owner_of(name))}
    returned = {
        getattr(inspect.signature(f).return_annotation, "__name__", "")
        or str(inspect.signature(f).return_annotation)
        for _, f in surface.named()
        if inspect.isfunction(f)
    }
    # A result is one of any experiment.
    assert owners <= drawn | PRODUCERS.keys() | returned | {"Result", "MotionResult"}


def owner_of(name: str) -> type:
    return next(t.owner for t in targets().values() if t.owner and t.owner.__name__ == name)


def test_a_new_method_and_a_new_function_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def doubled(self: st.Plant, share: float, names: list[str]) -> float:
        """Not there before."""
        return share

    def brand_new(readings: float) -> float:
        """Not there before."""
        return readings

    targets.cache_clear()
    try:
        monkeypatch.setattr(st.Plant, "doubled", doubled, raising=False)
        monkeypatch.setattr(st, "brand_new", brand_new, raising=False)
        monkeypatch.setattr(st, "__all__", [*st.__all__, "brand_new"])
        assert "x.doubled(" in program("Plant.doubled", "1")[-1]
        assert program("brand_new", "1")[-1].startswith("stiction.brand_new(")
    finally:
        targets.cache_clear()


def test_setters_are_found_in_the_stubs() -> None:
    assert {"Motor.state=", "FrictionModel.state="} <= set(targets())


def test_exclusions_are_of_what_is_there() -> None:
    there = {path for path, _ in surface.named()}
    assert set(EXCLUDED) <= there
    assert set(PARTS) <= {path.rpartition(".")[2] for path in there}


def test_every_format_has_good_files_to_damage() -> None:
    for known in FORMATS:
        for suffix in known.suffixes:
            assert suffix in kinds()
            assert any(writer(suffix) is made for made in WRITERS.values())


def test_every_law_and_every_effect_is_drawn() -> None:
    text = "".join("".join(program("coast" if k % 2 else "Motor.step", str(k))) for k in range(900))
    assert all(f"'{name}'" in text for name in (*LAWS, *EFFECTS))


QUICK = [n for n in names() if n not in LONG and patience(program(n, "0")[-1], n) <= CPU_S]


@pytest.mark.parametrize("name", QUICK)
def test_a_case_of_everything_is_taken_as_it_is(name: str) -> None:
    if name in ("file..mf4", "file..mdf"):
        pytest.skip("no good file of MDF can be written without its library")
    for seed in range(SEEDS):
        lines = program(name, f"taken.{seed}")
        if any(patience(line, name) > CPU_S for line in lines):
            pytest.skip("what it takes is made in seconds")
        if re.fullmatch("[0-9a-f]{24}", run(lines)[1][-1]):
            return
    pytest.fail(f"all of {SEEDS} cases of {name} are refused; draw what it takes")
