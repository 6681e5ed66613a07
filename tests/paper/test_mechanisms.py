"""Loops of other mechanisms, and friction that varies from place to place."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st
from stiction import paper

NAMES = {record.name for record in st.laws()}
# Share of the width of the loops; the paths meet each level to round-off.
MET_AGAIN = 1e-12


def gaps(study, label=""):
    named = {
        name: number.value for name, number in study.numbers.items() if f"{label}gap at" in name
    }
    assert named
    return (
        np.array(list(named.values()))
        * {"nm": 1e-9, "arcsec": paper.ARC_SECOND}[next(iter(study.numbers.values())).unit]
    )


@pytest.mark.parametrize("make", [paper.nanometre_loops, paper.ball_screw])
def test_springs_meet_every_reverse_point_again(make):
    study = make()
    width = np.ptp(study.curves[0].position)
    assert np.max(np.abs(gaps(study))) < MET_AGAIN * width


def test_the_wide_loops_follow_the_first_loading():
    study = paper.ball_screw()
    # From one tip to the next the way is that of a contact that made no smaller loop.
    law = st.FrictionModel(
        "hsieh_pan",
        initial_stiffness=1200.0,
        final_stiffness=150.0,
        decay_distance=80.0 * paper.ARC_SECOND,
        hardening_coefficient=0.0,
        damping=0.0,
    )
    tip = study.curves[0].settled[study.letters.index("h")]
    assert law.simulate(np.full(100, tip), 0.01)[-1] == pytest.approx(0.15, rel=1e-12)


def test_loss_in_the_ball_screw_is_that_of_its_branches():
    study = paper.ball_screw()
    settled = study.curves[0].settled
    k_0, k_inf, d_0 = 1200.0, 150.0, 80.0 * paper.ARC_SECOND
    for index in range(3):
        d = settled[3 * index] - settled[3 * index + 1]
        bent = (k_0 - k_inf) * d_0
        fallen = -np.expm1(-d / d_0)
        integral = 0.5 * k_inf * d**2 + bent * (d - d_0 * fallen)
        area = 2.0 * integral - d * (k_inf * d + bent * fallen)
        found = 1e-6 * study.numbers[f"work lost in loop {index + 1}"].value
        assert found == pytest.approx(area, rel=1e-3)


def test_a_metal_contact_keeps_what_its_force_hardens():
    study = paper.metal_contact()
    # c·s^n with c = 2e-9 m/N² and n = 2; the holds of 4 s leave e^(−8) of the creep.
    for point, force in (("c", 3.0), ("f", 6.0)):
        found = 1e-6 * study.numbers[f"permanent displacement after point {point}"].value
        assert found == pytest.approx(2e-9 * force**2, rel=2e-3)
    assert np.max(np.abs(gaps(study))) < 1e-3 * np.ptp(study.curves[0].position)


def test_nanometre_loops_are_linear_within_100_nm():
    number = paper.nanometre_loops().numbers[
        "mean stiffness over 100 nm below that at the reverse point"
    ]
    assert 0.0 < number.value < 5.0
    assert number.unit == "%"


def test_bearing_loops_close_with_memory_only():
    study = paper.bearing_loops()
    width = np.ptp(study.curves[0].position)
    assert np.max(np.abs(gaps(study, "hsieh_pan (spring): "))) < MET_AGAIN * width
    labels = [curve.label for curve in study.curves]
    assert labels == [
        "hsieh_pan (spring)",
        *[n for n in ("dahl", "dahl_with_memory") if n in NAMES],
    ]
    if "dahl" in NAMES:
        assert np.min(np.abs(gaps(study, "dahl: "))) > 1.0 * paper.ARC_SECOND
    if "dahl_with_memory" in NAMES:
        assert np.max(np.abs(gaps(study, "dahl_with_memory: "))) < 1e-9 * width


def test_the_law_dahl_goes_the_way_of_the_closed_form():
    numbers = paper.dahl_on_static_1().numbers
    name = "greatest distance of the law dahl from the closed form"
    assert (name in numbers) == ("dahl" in NAMES)
    if name in numbers:
        assert numbers[name].value < 1e-9


def test_friction_varies_from_place_to_place_and_repeats_in_each():
    run = paper.local_variation(places=6, share=0.4, periods=1)
    expected = 0.5 * (1.0 + 0.4 * np.cos(run.place))
    # The ramp rises by 1.25e-4 N·m a sample, a sample ends beyond break-away, and the damper
    # carries C_s·v, about as much.
    assert np.max(np.abs(run.breakaway - expected[:, None])) < 5e-4
    assert np.ptp(run.breakaway, axis=1).max() == 0.0
    assert np.ptp(run.displacement, axis=1).max() == 0.0
    numbers = run.numbers
    assert numbers["change of break-away 10 arcsec beside"].value < 2e-4
    # More friction is more stiffness: the level scales force at the same displacement.
    assert np.argmin(run.displacement[:, 0]) == np.argmax(run.breakaway[:, 0])


@pytest.mark.parametrize(
    "make",
    [
        paper.experiment_2,
        paper.static_test,
        paper.hardening_cycles,
        paper.nested_loops,
        paper.dahl_on_static_1,
        paper.metal_contact,
        paper.nanometre_loops,
        paper.bearing_loops,
        paper.ball_screw,
        paper.loop_areas,
    ],
)
def test_every_result_says_in_a_sentence_what_it_shows(make):
    run = make()
    assert run.shows.endswith(".")
    assert run.shows in repr(run)
    assert run.to_dict()["shows"] == run.shows
