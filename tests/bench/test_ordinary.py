"""The ordinary machine obeys closed forms, and its sessions read as they were written."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.bench.ordinary.draw import FORMATS, Spec, null_grid, ordinary
from stiction.bench.ordinary.files import write
from stiction.bench.ordinary.hidden import HIDDEN
from stiction.bench.ordinary.machine import Effects, Machine, simulate

PLAIN = Machine(inertia=1.5e-3, coulomb=0.2, viscous=0.01)
DT = 2e-3
EXACT = 1e-9
"""Runge-Kutta steps of half a millisecond between located events."""
SHORT = {"seconds": 4.0, "recordings": 2, "dt": DT}


def driven(machine: Machine, effort: float, seconds: float, **options):
    """Motion under an effort that acts for half of the time."""
    samples = round(seconds / DT)
    return simulate(
        machine, lambda k, x: effort if 2 * k < samples else 0.0, samples, DT, **options
    )


def test_a_body_that_coasts_stops_where_and_when_the_closed_form_says() -> None:
    motion = driven(PLAIN, 0.5, 2.0)
    begin = round(1.0 / DT)
    speed, place = motion.velocity[begin], motion.position[begin]
    settling, limit = PLAIN.inertia / PLAIN.viscous, PLAIN.coulomb / PLAIN.viscous
    assert speed == pytest.approx((0.5 - 0.2) / 0.01 * -math.expm1(-1.0 / settling), rel=EXACT)
    stop = settling * math.log1p(speed / limit)
    travel = settling * (speed + limit) * -math.expm1(-stop / settling) - limit * stop
    assert motion.position[-1] - place == pytest.approx(travel, rel=EXACT)
    stopped = begin + math.ceil(stop / DT)
    assert motion.velocity[stopped - 1] > 0.0
    assert all(v == 0.0 for v in motion.velocity[stopped:])


def test_a_body_below_its_break_away_does_not_move() -> None:
    assert set(driven(PLAIN, 0.999 * PLAIN.coulomb, 1.0).position) == {0.0}
    assert driven(PLAIN, 1.001 * PLAIN.coulomb, 1.0).position[-1] > 0.0


def test_a_bristle_bends_and_creeps_no_further() -> None:
    machine = replace(PLAIN, bristle=2e-3)
    bent = driven(machine, 0.5 * machine.coulomb, 4.0).position
    # Slowly it would go to -2e-3 ln(1 - 0.5); a step swings beyond, up to twice the load.
    assert 2e-3 * math.log(2.0) < bent[round(1.0 / DT)] < 4e-3
    assert bent[round(1.9 / DT)] == pytest.approx(bent[round(1.0 / DT)], abs=1e-8)


def test_a_bristle_that_turns_over_fast_between_rare_samples_stays_finite() -> None:
    machine = Machine(inertia=1e-3, coulomb=0.3, viscous=0.003, bristle=1e-3)
    usual, fine = (simulate(machine, lambda k, x: 0.9, 12, 1e-2, finest=h) for h in (5e-4, 1e-4))
    assert max(usual.velocity) > 20.0
    assert usual.position[-1] == pytest.approx(fine.position[-1], rel=1e-5)


@pytest.mark.parametrize(
    "effects",
    [
        Effects(fall=0.3, fall_speed=1.0),
        Effects(quadratic=1e-4),
        Effects(waves=((0.02, 12.0, 0.0),)),
        Effects(asymmetry=0.1),
        Effects(bias=0.02),
        Effects(delay=3.3e-3),
        Effects(lag=5e-3),
        Effects(dead=0.02),
        Effects(largest=0.3),
        Effects(shaft_share=0.3, shaft_stiffness=20.0, shaft_damping=4e-3),
    ],
)
def test_finer_steps_change_nothing_that_an_encoder_sees(effects: Effects) -> None:
    machine = replace(PLAIN, effects=effects)
    usual, fine = (driven(machine, 0.35, 0.6, finest=h).position for h in (5e-4, 1e-4))
    assert usual[-1] != driven(PLAIN, 0.35, 0.6).position[-1]
    assert np.abs(np.subtract(usual, fine)).max() < 2.0 * math.pi / 2**20


def test_finer_steps_change_little_where_faces_strike() -> None:
    shaft = {"shaft_share": 0.3, "shaft_stiffness": 200.0, "shaft_damping": 0.1}
    machine = replace(PLAIN, effects=Effects(**shaft, gap=0.01))
    usual, fine = (driven(machine, 0.35, 0.6, finest=h).position for h in (5e-4, 1e-4))
    assert np.abs(np.subtract(usual, fine)).max() < 0.01 * machine.effects.gap


@pytest.mark.parametrize("name", HIDDEN)
def test_what_is_hidden_has_about_the_size_that_was_asked_for(name: str) -> None:
    made = ordinary(Spec(5, hidden=name, size=0.1, signals=("sines",) * 2, loop="open", **SHORT))
    assert 0.02 < made.relative_rms < 0.4


def test_the_same_seed_gives_the_same_machine_whatever_is_hidden() -> None:
    plain, hidden = (ordinary(Spec(6, hidden=name, **SHORT)) for name in ("", "torque_bias"))
    assert replace(hidden.machine, effects=Effects()) == plain.machine
    assert hidden.drive == plain.drive
    assert plain.relative_rms == 0.0


@pytest.mark.parametrize("file_format", FORMATS)
def test_every_format_reads_as_it_was_written(file_format: str, tmp_path: Path) -> None:
    seed = 10 + FORMATS.index(file_format)  # other units, linear ones and loops among them
    made = ordinary(Spec(seed, file_format=file_format, linear=seed % 2 == 0, loop="pd", **SHORT))
    session = st.load(write(made, tmp_path))
    assert session.plant.friction.law == "coulomb"
    for recording, log in zip(session, made.logs, strict=True):
        radius = made.radius or 1.0
        effort = 1.0 / radius if made.drive["input"] == "torque_nm" else 1.0
        # CSV has twelve digits.
        assert np.allclose(recording.time, log.time, rtol=1e-9, atol=1e-12)
        assert np.allclose(recording.position, radius * log.position, rtol=1e-9, atol=1e-12)
        assert np.allclose(recording.input, effort * log.input, rtol=1e-9, atol=1e-12)


def test_the_grid_is_two_dozen_sessions_that_never_change() -> None:
    grid = null_grid()
    assert len({(s.counts, s.dt, s.log_noise) for s in grid}) == len(grid) == 24
    assert [grid[0].seed, grid[-1].seed] == [44, 67]
    # A stream that moved would make another machine of an old seed.
    assert ordinary(replace(grid[0], seconds=12.0)).machine.inertia == pytest.approx(FIRST_INERTIA)


FIRST_INERTIA = 0.1583067
"""kg·m² of the first machine of the grid."""
