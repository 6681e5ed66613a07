"""Experiments 1, 2 and 3 against the prototype's figures for the illustrative rig."""

from __future__ import annotations

import doctest
import importlib

import numpy as np
import pytest

import stiction as st
from stiction import paper
from stiction.errors import InputError
from stiction.paper import ARC_SECOND

# Arc-seconds; the prototype's positions and hardening are printed to 0.1, some to 0.01.
PRINTED, PRINTED_FINELY = 0.05, 0.005
# Half of the last digit of the torques, and one step of the ramp in a controller's period.
TORQUE = 0.0005 + 0.00025
RATIO = 0.005
# Both integrators at the same step; the fast one is of second order.
FAST_POSITION = 0.005
# A finer step moves the reference integrator by less than this, arc-seconds.
STEP_POSITION = 1e-3


def arcsec(values):
    return np.asarray(values) / ARC_SECOND


def test_experiment_1_cuts_earlier_each_time(experiment_1):
    printed = [0.215, 0.200, 0.192, 0.188]
    assert np.allclose(experiment_1.cut_torque[:4], printed, rtol=0, atol=TORQUE)
    assert np.all(np.diff(experiment_1.cut_torque) < 0.0)


def test_experiment_1_rests_farther_each_time(experiment_1):
    rest = arcsec(experiment_1.rest_position)
    assert np.allclose(rest[:3], [6.1, 7.6, 8.3], rtol=0, atol=PRINTED)
    assert np.all(np.diff(rest) > 0.0)


def test_experiment_1_rings_at_95_to_100_hertz_once_the_first_swing_is_over(experiment_1):
    frequency = experiment_1.ring_frequency
    # The first two half cycles are wide enough to soften the spring below 95 Hz.
    assert np.all((frequency[2:] >= 95.0) & (frequency[2:] <= 100.0))
    assert np.all(np.diff(frequency) > 0.0)


def test_experiment_1_damps_large_swings_more_than_small_ones(experiment_1):
    ratio = experiment_1.half_cycle_ratio
    assert ratio[1] == pytest.approx(0.78, abs=RATIO)
    assert ratio[9] == pytest.approx(0.845, abs=RATIO)
    assert np.all(np.diff(ratio[:10]) > 0.0)


def test_experiment_1_lasts_five_seconds(experiment_1):
    assert experiment_1.time[-1] == pytest.approx(5.0)
    assert len(experiment_1.cut_torque) == 5


def test_experiment_2_creeps_and_stops(experiment_2):
    assert experiment_2.held_torque == pytest.approx(0.134, abs=TORQUE)
    read = arcsec(experiment_2.read_position)
    printed = [12.05, 13.7, 14.8, 15.7, 16.25, 16.32]
    assert np.allclose(read, printed, rtol=0, atol=PRINTED)
    assert np.allclose(read[[0, 4, 5]], np.array(printed)[[0, 4, 5]], rtol=0, atol=PRINTED_FINELY)


def test_experiment_3_hardens_in_both_directions(experiment_3):
    hardening = arcsec(experiment_3.rest_hardening[19::20])
    assert np.allclose(hardening, [5.4, 12.6, 13.7, 14.6], rtol=0, atol=PRINTED)


def test_experiment_3_pulses_a_fifth_of_the_time(experiment_3):
    assert np.mean(experiment_3.effort != 0.0) == pytest.approx(0.2)
    assert len(experiment_3.rest_time) == 80


@pytest.mark.parametrize("name", ["experiment_1", "experiment_2", "experiment_3"])
def test_every_number_is_near_the_prototype(name, request):
    numbers = request.getfixturevalue(name).numbers
    compared = {key: number for key, number in numbers.items() if number.prototype is not None}
    assert len(compared) >= 4
    allowed = {"arcsec": PRINTED, "N·m": TORQUE, "1": RATIO, "Hz": 2.0}
    for key, number in compared.items():
        assert number.value == pytest.approx(number.prototype, abs=allowed[number.unit]), key


@pytest.mark.parametrize(
    ("name", "quantity"),
    [
        ("experiment_1", "rest_position"),
        ("experiment_2", "read_position"),
        ("experiment_3", "rest_hardening"),
    ],
)
def test_fast_integrator_gives_the_same_experiment(name, quantity, request):
    reference = getattr(request.getfixturevalue(name), quantity)
    fast = getattr(getattr(paper, name)(integrator="fast"), quantity)
    assert np.max(np.abs(arcsec(fast - reference))) < FAST_POSITION


def test_a_finer_step_changes_nothing_that_can_be_read(experiment_2):
    finer = paper.experiment_2(dt=2.5e-5)
    difference = arcsec(finer.read_position - experiment_2.read_position)
    assert np.max(np.abs(difference)) < STEP_POSITION


def test_fine_encoder_reads_whole_counts_and_triggers_half_a_count_early(experiment_1):
    run = paper.experiment_1(encoder_count=paper.FINE_COUNT)
    counts = run.measured / paper.FINE_COUNT
    assert np.max(np.abs(counts - np.round(counts))) < 1e-9
    assert np.max(np.abs(run.measured - run.position)) <= 0.5 * paper.FINE_COUNT * (1.0 + 1e-9)
    assert run.cut_torque[0] < experiment_1.cut_torque[0]
    assert all(number.prototype is None for number in run.numbers.values())


def test_coarse_encoder_does_not_see_where_the_rotor_rests():
    run = paper.experiment_1(encoder_count=paper.COARSE_COUNT, duration=1.2)
    assert run.rest_position[0] == 0.0
    assert run.position[-1] > 0.0


def test_overrides_reach_the_rig(experiment_2):
    still = paper.experiment_2(rig={"creep_rate": 0.0})
    assert np.all(still.states["plastic"] == 0.0)
    assert still.held_torque > experiment_2.held_torque
    assert all(number.prototype is None for number in still.numbers.values())


@pytest.mark.parametrize(
    "module", ["dynamic", "local", "loops", "mechanisms", "rig", "static", "stick_slip"]
)
def test_examples_in_docstrings_hold(module):
    tried = doctest.testmod(importlib.import_module(f"stiction.paper.{module}"))
    assert tried.attempted > 0
    assert tried.failed == 0


def test_a_motor_or_a_law_serves_as_rig(experiment_2):
    law = paper.illustrative_friction()
    law.simulate(np.full(100, 0.01), 1e-3)
    half = st.Motor(inertia=paper.ILLUSTRATIVE_RIG["inertia"], torque_constant=0.5, friction=law)
    for rig in (law, half):
        run = paper.experiment_2(rig=rig)
        # Starts virgin, whatever the law has gone through; effort is torque, not current.
        assert np.allclose(run.read_position, experiment_2.read_position, rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"dt": 3e-4}, "does not divide"),
        ({"dt": 0.0}, "no duration"),
        ({"encoder_count": -1.0}, "no count"),
        ({"target": 1.0}, "has not reached"),
        ({"rig": {"creep_rat": 1.0}}, "creep_rat"),
        ({"rig": "motor"}, "no rig"),
        ({"integrator": "euler"}, "euler"),
    ],
)
def test_a_wrong_request_says_what_is_wrong(wrong, said):
    with pytest.raises(InputError, match=said):
        paper.experiment_2(**wrong)


def test_results_print_their_numbers_beside_the_prototype(experiment_2):
    text = repr(experiment_2)
    assert "Experiment 2" in text
    assert "prototype" in text
    assert any("torque held" in line and "0.134" in line for line in text.splitlines())
    html = experiment_2._repr_html_()
    assert "<table>" in html
    assert "torque held" in html


def test_results_cannot_be_changed(experiment_2):
    with pytest.raises(AttributeError):
        experiment_2.target = 0.0
    with pytest.raises(TypeError):
        experiment_2.numbers["torque held"] = None
