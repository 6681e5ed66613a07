"""A few short sessions of the independent plant; `make blind` counts over many."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.session import Session

SECONDS = 72.0
"""Of a session: the shortest in which every kind of recording still says something."""
SIZE = 0.015
"""rms of the hidden torque as a share of F_c: plainly there."""
HIDDEN = (
    "cogging",
    "torque_bias",
    "stribeck",
    "position_dependent_friction",
    "viscous_quadratic",
    "torque_constant_ripple",
    "drive_deadband",
    "encoder_eccentricity",
    "creep_hardening",
    "rate_dependent_breakaway",
    "warm_up",
    "gravity_unbalance",
    "torque_constant_saturation",
    "drive_saturation",
    "back_emf",
    "current_loop_lag",
    "frictional_lag",
    "reverse_point_memory",
    "relaxation",
    "temperature_dependent_friction",
    "load_dependent_friction",
    "backlash",
    "voltage_limit",
)
BASES = {"reverse_point_memory": "coulomb"}
"""Of a machine that can have the effect, where that is not `maxwell_slip`."""
LARGER = {"current_loop_lag": 0.06, "viscous_quadratic": 0.02}
"""Of 1.5 % a lag lies within the half sample that nobody's stamps tell, and of the square of speed
viscous friction takes up so much that who knows the hidden torque gains but 3 % there."""
LONGER = {"relaxation": 156.0}
"""Seconds of a session: creep needs its holds."""
SEEDS = dict(zip(HIDDEN, range(2, 2 + len(HIDDEN)), strict=True))
SEEDS["voltage_limit"] = 61  # the first from 60 on in which recordings of every role reach it
SURROGATES = 6
LEFT_OUT = ("torque_bias", "stribeck")
OF_GAIN = ("heldout_gain", "heldout_gain_ci95")


@cache
def made() -> dict[str | None, Any]:
    specs = [{"seed": 1, "seconds": SECONDS}]
    specs += [
        {
            "seed": seed,
            "seconds": LONGER.get(name, SECONDS),
            "base": BASES.get(name, "maxwell_slip"),
            "hidden": [(name, LARGER.get(name, SIZE))],
        }
        for name, seed in SEEDS.items()
    ]
    return dict(zip((None, *HIDDEN), make_sessions(specs), strict=True))


@cache
def found(name: str | None, without: tuple[str, ...] = (), threads: int = 1) -> st.Diagnosis:
    hidden = made()[name]
    plant, session = as_plant(hidden), as_session(hidden)
    return st.diagnose(plant, session, without=without, surrogates=SURROGATES, threads=threads)


def family(name: str) -> str:
    return next(record.family for record in st.effects() if record.name == name)


def as_noise(recording: st.Recording, rng: np.random.Generator) -> st.Recording:
    """A recording of the same length and label in which nothing is left of the machine."""
    rows = len(recording)
    walk = np.cumsum(rng.standard_normal(rows)) * 1e-3
    return relabelled(recording, recording.role, rng.standard_normal(rows), walk)


def relabelled(
    recording: st.Recording,
    role: str | None,
    effort: np.ndarray | None = None,
    position: np.ndarray | None = None,
    later: float = 0.0,
) -> st.Recording:
    return st.Recording(
        recording.time,
        recording.input if effort is None else effort,
        recording.position if position is None else position,
        role=role,
        kind=recording.kind,
        start_s=recording.start_s + later,
    )


def without_gains(diagnosis: st.Diagnosis) -> dict[str, Any]:
    """What must not depend on the rows that test."""
    told = diagnosis.to_dict()
    for part in ("seconds", "gain", "sentence"):
        del told[part]
    del told["data"]["hashes"], told["data"]["checks"]
    for model in ("baseline", "extended"):
        del told[model]["heldout_rms"], told[model]["replay"], told[model]["begins"]
    for effect in told["effects"]:
        for part in OF_GAIN:
            del effect[part]
    return told


@pytest.mark.slow
def test_a_complete_simulation_gives_no_name() -> None:
    assert found(None).effects == ()


@pytest.mark.slow
@pytest.mark.parametrize("name", HIDDEN)
def test_a_hidden_effect_is_named_or_listed_as_a_look_alike(name: str) -> None:
    first = found(name).effects[0]
    assert name in (first.name, *first.look_alikes)


@pytest.mark.slow
def test_noise_in_place_of_the_rows_that_test_takes_names_away_and_changes_nothing_else() -> None:
    hidden = made()["cogging"]
    session, rng = as_session(hidden), np.random.default_rng(0)
    noisy = [as_noise(r, rng) if r.role == "test" else r for r in session]
    other = st.diagnose(as_plant(hidden), Session(noisy), surrogates=SURROGATES, threads=1)
    usual = found("cogging")
    one, two = without_gains(other), without_gains(usual)
    # The floor is told beside the last model, which is another one.
    for told in (one, two):
        del told["baseline"]["noise_floor_rms"]
    assert one["baseline"] == two["baseline"]
    for ours, theirs in zip(one["candidates"], two["candidates"], strict=True):
        assert {**ours, "reason": ""} == {**theirs, "reason": ""}
    # Noise bears nothing out: there the cause makes up an effort that nobody gave.
    assert [cause.name for cause in usual.effects] == ["cogging"]
    assert other.effects == ()


@pytest.mark.slow
def test_the_number_of_threads_changes_nothing() -> None:
    one, two = (found("cogging", threads=n).to_dict() for n in (1, 2))
    del one["seconds"], two["seconds"]
    assert one == two


@pytest.mark.slow
@pytest.mark.parametrize("name", LEFT_OUT)
def test_a_cause_that_the_library_lacks_is_not_called_by_another_class(name: str) -> None:
    diagnosis = found(name, without=(name,))
    sure = [c for c in diagnosis.effects if c.decided and diagnosis.verdict != "unexplained"]
    assert all(cause.family == family(name) for cause in sure)


def test_a_recording_that_trains_may_not_test() -> None:
    hidden = made()[None]
    session = as_session(hidden)
    swapped = [relabelled(r, "test", later=1e3) for r in session if r.role == "train"]
    train = [r for r in session if r.role != "test"]
    with pytest.raises(st.InputError, match="the same recording"):
        st.diagnose(as_plant(hidden), [*train, *swapped], threads=1)
