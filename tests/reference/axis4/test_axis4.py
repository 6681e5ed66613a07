"""The stranger's axis against closed forms, and its sessions against what is asked of them."""

from __future__ import annotations

import ast
import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from . import machine, sessions
from .machine import Loop, Machine, simulate
from .sessions import EFFECTS, plan

PLAIN = Machine(inertia=0.01, coulomb=0.2, viscous=0.05)
SECOND_ORDER = 2e-6
"""Of the midpoint rule at 0.2 ms over motions of about 1 rad."""
ROUNDING = 1e-9
CALIBRATED = (0.6, 1.5)
"""Times what was asked: the motion answers, and a share may stop growing with the size."""


def sums(n, dt, seed=0):
    """An effort that slides both ways and rests between."""
    t, r = np.arange(n) * dt, np.random.default_rng(seed)
    return 0.3 * np.sin(7.0 * t + r.random()) + 0.2 * np.sin(2.3 * t + r.random())


@pytest.mark.parametrize("path", [machine, sessions], ids=lambda each: each.__name__[-8:])
def test_it_imports_nothing_of_the_package(path):
    tree = ast.parse(Path(path.__file__).read_text(encoding="utf-8"))
    names = [a.name for n in ast.walk(tree) if isinstance(n, ast.Import) for a in n.names]
    names += [n.module or "" for n in ast.walk(tree) if isinstance(n, ast.ImportFrom)]
    assert not [name for name in names if name.split(".")[0] == "stiction"]


def test_it_coasts_to_a_stop_as_the_closed_form_says():
    m, speed = PLAIN, 10.0
    run = simulate(m, np.zeros(1000), 1e-3, start=(0.0, speed))
    lasts, level = m.inertia / m.viscous, m.coulomb / m.viscous
    stop = lasts * math.log(1.0 + speed / level)
    assert run.position[-1] == pytest.approx(lasts * speed - level * stop, abs=SECOND_ORDER)
    assert np.flatnonzero(run.speed == 0.0)[0] == math.ceil(stop / 1e-3)


def test_what_is_stuck_rests_to_the_last_bit():
    run = simulate(PLAIN, 0.1999 * np.sin(np.arange(4000) * 0.01), 1e-3, start=(0.3, 0.0))
    assert np.ptp(run.position) == 0.0
    assert not run.sliding.any()


@pytest.mark.parametrize("contact", ["rigid", "dahl", "lugre"])
def test_energy_is_neither_made_nor_lost(contact):
    m = replace(PLAIN, contact=contact, bristle=200.0, bristle_damping=0.3)
    e = simulate(m, sums(3000, 1e-3), 1e-3, start=(0.0, 1.0)).energy
    assert e["work"] + e["start"] == pytest.approx(e["dry"] + e["viscous"] + e["kinetic"], ROUNDING)
    assert e["dry"] > 0.1


def test_a_driven_axis_comes_to_its_steady_speed():
    run = simulate(PLAIN, np.full(5000, 0.6), 1e-3)
    assert run.speed[-1] == pytest.approx((0.6 - PLAIN.coulomb) / PLAIN.viscous, ROUNDING)


def test_quadratic_drag_adds_to_the_steady_speed_equation():
    m = replace(PLAIN, quadratic=0.02)
    v = simulate(m, np.full(6000, 0.6), 1e-3).speed[-1]
    assert m.coulomb + m.viscous * v + m.quadratic * v * v == pytest.approx(0.6, 1e-6)


def test_a_slow_push_draws_the_curve_of_dahl():
    m = replace(PLAIN, contact="dahl", bristle=200.0, viscous=0.0)
    push = 0.15 * np.linspace(0.0, 1.0, 4000)
    run = simulate(m, push, 1e-3)
    curve = -m.coulomb / m.bristle * math.log(1.0 - push[-1] / m.coulomb)
    assert run.position[-1] == pytest.approx(curve, rel=0.01)


def test_finer_steps_change_little():
    coarse, fine = (simulate(PLAIN, sums(2000, 1e-3), 1e-3, step=h) for h in (2e-4, 2e-5))
    assert np.abs(coarse.position - fine.position).max() < SECOND_ORDER


def test_two_bodies_swing_at_their_frequency():
    jl, rate = 0.004, 2 * math.pi * 20.0
    shaft = jl * (0.01 - jl) / 0.01 * rate**2
    m = Machine(0.01, 0.0, 0.0, load_inertia=jl, shaft=shaft)
    # The motor alone is struck: beside the mean motion a swing is left.
    run = simulate(m, np.where(np.arange(2000) < 1, 1.0, 0.0), 1e-3)
    swing = run.speed[1:] - np.mean(run.speed[1:])
    upward = np.flatnonzero((swing[:-1] < 0) & (swing[1:] >= 0))
    assert 1e-3 * np.mean(np.diff(upward)) == pytest.approx(2 * math.pi / rate, rel=0.01)


def test_across_the_gap_the_motor_turns_alone():
    m = Machine(0.01, 0.0, 0.0, load_inertia=0.004, shaft=1e4, play=0.2)
    run = simulate(m, np.full(20, 1.0), 1e-3)
    alone = 0.5 * (1.0 / 0.006) * run.time**2
    within = run.position < 0.1
    assert np.count_nonzero(within) > 10
    assert run.position[within] == pytest.approx(alone[within], abs=1e-9)


def test_the_drive_holds_back_and_lags():
    late, low = replace(PLAIN, lag=0.05), replace(PLAIN, limit=0.4)
    for other, push in ((late, 0.6), (low, 0.6)):
        plain, held = (simulate(each, np.full(400, push), 1e-3) for each in (PLAIN, other))
        assert held.position[-1] < plain.position[-1]
    dead = replace(PLAIN, dead_band=0.1)
    shifted = simulate(PLAIN, np.full(400, 0.5), 1e-3)
    assert simulate(dead, np.full(400, 0.6), 1e-3).position == pytest.approx(shifted.position)


def test_a_position_loop_follows():
    width = 2 * math.pi * 6
    loop = Loop("position", 0.01 * width, 0.01 * width**2 / 4, width / 4, 0.35 / width, 5.0)
    wanted = np.sin(np.arange(4000) * 2e-3)
    run = simulate(PLAIN, wanted, 1e-3, loop=loop, count=2 * math.pi / 65536)
    assert np.sqrt(np.mean((run.position - wanted)[1000:] ** 2)) < 0.02


def test_a_share_is_what_an_added_effort_comes_to():
    m = replace(PLAIN, bias=0.02)
    own, left = machine.share(PLAIN, [simulate(m, sums(4000, 1e-3), 1e-3)], 1e-3)
    assert own == pytest.approx(0.1, rel=1e-3)
    assert 0.0 < left <= own
    assert machine.share(PLAIN, [simulate(PLAIN, sums(4000, 1e-3), 1e-3)], 1e-3)[0] < 1e-6


def test_every_effect_comes_once_and_a_longer_plan_holds_the_shorter():
    whole, short = plan(4), plan(4, 5)
    assert sorted(each.effect for each in whole if each.effect) == sorted(EFFECTS)
    assert sum(each.effect is None for each in whole) == len(EFFECTS)
    assert short == whole[:5] + whole[16:21]
    assert plan(4, 20)[:16] == whole[:16]


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_effect_has_the_size_that_was_asked_for(effect, tmp_path):
    bench = sessions.draw(11, "dc_motor", six=True, seconds=6.0)
    facts = sessions.write(bench, effect, 0.15, tmp_path / "s", tmp_path / "truth")
    assert CALIBRATED[0] * 0.15 < facts["share"] < CALIBRATED[1] * 0.15


def test_the_same_seed_gives_the_same_bytes_and_the_truth_lies_apart(tmp_path):
    bench = sessions.draw(3, "ballscrew", six=True, seconds=6.0)
    for name in ("a", "b"):
        sessions.write(bench, "torque_bias", 0.1, tmp_path / name, tmp_path / "truth")
    files = sorted(path.name for path in (tmp_path / "a").iterdir())
    assert files == sorted({"session.toml", "plant.toml", *(f for f in files if "rec" in f)})
    # An NPZ holds the time at which it was written.
    same = [name for name in files if not name.endswith(".npz")]
    assert all((tmp_path / "a" / f).read_bytes() == (tmp_path / "b" / f).read_bytes() for f in same)
    assert json.loads((tmp_path / "truth" / "a.json").read_text())["hidden"] == ["torque_bias"]
