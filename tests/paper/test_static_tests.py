"""The static tests, memory, hardening and loop areas."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

from stiction import paper
from stiction.errors import InputError
from stiction.paper import ARC_SECOND

PRINTED = [21.14, 10.91, 21.18, 45.19, 30.17, 45.25, 78.23, 58.14, 78.32, 94.10]
# Arc-seconds; the prototype printed two digits after the point.
FORCE_DRIVEN = 0.01
# Slow ramps with inertia creep for a moment longer and ring by next to nothing.
RAMPED = 0.01
# Halving the step of a force-driven path, arc-seconds.
STEP = 1e-4
# rad; what the prototype found for reverse points that are met again.
MET_AGAIN = 1e-14
# Arc-seconds; straight lines between samples 9e-5 N·m apart.
BRANCH = 1e-4
# Trapezoidal rule over 2000 samples a branch.
AREA = 1e-6


def arcsec(values):
    return np.asarray(values) / ARC_SECOND


def test_force_driven_path_is_that_of_the_prototype(static_1):
    assert np.max(np.abs(arcsec(static_1.settled) - PRINTED)) < FORCE_DRIVEN
    known = [number.prototype for number in static_1.numbers.values()]
    assert known == PRINTED


def test_slow_ramps_follow_the_force_driven_path(static_1):
    ramped = paper.static_test(1, driven="ramp", dt=2.5e-4)
    assert np.max(np.abs(arcsec(ramped.settled - static_1.settled))) < RAMPED


def test_fast_integrator_follows_slow_ramps_too(static_1):
    ramped = paper.static_test(1, driven="ramp", dt=2.5e-4, integrator="fast")
    assert np.max(np.abs(arcsec(ramped.settled - static_1.settled))) < RAMPED


def test_steps_overshoot_and_end_farther_along(static_1, static_1_stepped):
    first = slice(0, static_1_stepped.settled_at[0])
    assert static_1_stepped.position[first].max() > static_1_stepped.settled[0]
    assert static_1_stepped.settled[0] > static_1.settled[0]


def test_only_steps_harden_beyond_what_their_level_can(static_1, static_1_stepped):
    d = static_1.letters.index("d")
    greatest = paper.ILLUSTRATIVE_RIG["hardening_coefficient"] * static_1.level[d] ** 2
    at_d = [run.states["hardening"][run.settled_at[d]] for run in (static_1, static_1_stepped)]
    assert at_d[0] <= greatest < at_d[1]


def test_half_the_step_gives_the_same_force_driven_path(static_1):
    finer = paper.static_test(1, dt=1e-3)
    assert np.max(np.abs(arcsec(finer.settled - static_1.settled))) < STEP


def test_friction_passes_through_the_wanted_force(static_1):
    force = static_1.states["spring_force"]
    assert np.max(np.abs(force - static_1.effort)) < 1e-12


def test_case_2_recovers_d_and_goes_on_along_cd():
    rig = {"hardening_coefficient": 0.0}
    nested = paper.static_test(2, rig=rig)
    plain = paper.static_test(rig=rig, levels=[0.34, -0.20, 0.34, 0.40])
    at = dict(zip(nested.letters, nested.settled, strict=True))
    assert abs(at["f"] - at["d"]) < MET_AGAIN
    assert abs(at["g"] - at["b"]) < MET_AGAIN
    # The loop d-e-f has left no trace on the way from c to g and on to h.
    assert np.max(np.abs(nested.settled[[0, 1, 5, 6]] - plain.settled)) < MET_AGAIN


def test_case_3_branches_are_one_curve_turned_and_shifted():
    test = paper.static_test(3, rig={"hardening_coefficient": 0.0})
    travels = []
    for level, position, start, end in zip(
        test.level[:5], test.settled[:5], test.settled_at[:5], test.settled_at[1:6], strict=True
    ):
        leg = slice(start + 1, end + 1)
        force = np.abs(test.effort[leg] - level)
        travels.append(np.interp(0.15, force, np.abs(test.position[leg] - position)))
    # The same travel for 0.15 N·m from every reverse point, whatever its force and position.
    assert np.ptp(arcsec(travels)) < BRANCH


def test_first_direction_takes_all_the_permanent_displacement():
    cycles = paper.hardening_cycles()
    added = arcsec(cycles.permanent)
    assert np.max(np.abs(added - [29.63, -0.07, 0.0, 0.0, 0.0])) < FORCE_DRIVEN


def test_nested_loops_are_met_again_and_forgotten():
    loops = paper.nested_loops()
    gaps = [number.value for name, number in loops.numbers.items() if name.startswith("gap")]
    assert len(gaps) == 4
    assert max(gaps) < MET_AGAIN
    assert loops.numbers["reverse points kept at most"].value == 6
    assert loops.numbers["reverse points kept at the end"].value == 0


def test_dahl_never_closes_the_loop():
    test = paper.dahl_on_static_1()
    # Printed to 0.1 arc-seconds.
    assert test.numbers["drift of loop b-c-d"].value == pytest.approx(11.2, abs=0.05)


def test_work_lost_in_a_loop_is_twice_the_integral_minus_the_rectangle():
    areas = paper.loop_areas()
    assert np.all(areas.area > 0.0)
    assert np.max(np.abs(areas.area / areas.formula - 1.0)) < AREA


def test_hardening_of_a_rig_without_plastic_module_is_refused():
    from stiction import FrictionModel

    with pytest.raises(InputError, match="no plastic module"):
        paper.hardening_cycles(rig=FrictionModel("coulomb"))
    with pytest.raises(InputError, match="reverse points"):
        paper.nested_loops(rig=FrictionModel("coulomb"))


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"case": 4}, "case 4"),
        ({"driven": "hand"}, "'hand'"),
        ({"rig": {"breakaway": 0.3}}, "slips"),
    ],
)
def test_a_wrong_static_test_says_what_is_wrong(wrong, said):
    with pytest.raises(InputError, match=said):
        paper.static_test(**wrong)


def test_levels_of_your_own_get_letters():
    test = paper.static_test(levels=[0.1, 0.0, 0.1], hold=0.1, ramp_rate=1.0)
    assert test.letters == ("b", "c", "d")
    assert test.case is None
    assert all(number.prototype is None for number in test.numbers.values())


def test_results_survive_pickling_and_copying(static_1):
    for other in (pickle.loads(pickle.dumps(static_1)), copy.deepcopy(static_1)):
        assert repr(other) == repr(static_1)
        assert np.array_equal(other.position, static_1.position)
