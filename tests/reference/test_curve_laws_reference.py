"""Oracles of Dahl, LuGre, the generalized Maxwell slip and their relatives against closed forms."""

import numpy as np
import pytest
from tests.reference.laws import (
    bouc_wen,
    dahl,
    dahl_with_memory,
    elasto_plastic,
    gms,
    leuven,
    lugre,
)

ARC_SECOND = np.pi / (180.0 * 3600.0)
DT = 1e-3


def test_dahl_drifts_by_11_arc_seconds_a_loop_of_static_1():
    # Hsieh and Pan, Fig. 8. A slow motion there and back, read where the force has its levels.
    values = {"coulomb": 0.5, "initial_stiffness": 2063.0, "exponent": 2.0, "viscous": 0.0}
    step = 0.01 * ARC_SECOND
    position = lambda n: np.arange(1, n + 1) * step  # noqa: E731

    def until(turns, level, sign):
        velocity = np.concatenate([*turns, np.full(6000, sign * step / DT)])
        force = dahl.along(velocity, DT, **values)[-6000:]
        return np.interp(level, *(f[:: int(sign)] for f in (force, position(6000))))

    up = until([], 0.16, 1.0)
    turns = [np.full(round(up / step), step / DT)]
    down = until(turns, 0.02, -1.0)
    turns.append(np.full(round(down / step), -step / DT))
    again = until(turns, 0.16, 1.0)
    assert (again - down) / ARC_SECOND == pytest.approx(11.2, abs=0.07)


def test_lugre_slides_at_the_published_levels():
    # sigma_0 1e5, F_c 1, F_s 1.5, v_s 1 mm/s: F_c + (F_s - F_c)/e + sigma_2 v_s at v_s.
    for speed, level in ((1e-6, 1.5), (1e-3, 1.0 + 0.5 / np.e + 0.4e-3), (0.1, 1.04)):
        path = np.full(40, speed)
        settled = lugre.along(path, 1e-5 / speed, **lugre.PUBLISHED)[-1]
        assert settled == pytest.approx(level, rel=1e-5)


def test_elasto_plastic_bristles_are_a_spring_up_to_their_limit_and_lugre_when_they_slide():
    values = lugre.PUBLISHED | {"elastic_share": 0.8}
    x = np.full(7, 1e-6)
    force = elasto_plastic.along(x / DT, DT, **values)
    still = force - (values["damping"] + values["viscous"]) * 1e-3
    assert still == pytest.approx(1e5 * np.cumsum(x), rel=1e-9)
    path = np.full(60, 1e-3)
    settled = elasto_plastic.along(path, 1e-2, **values)[-1]
    assert settled == pytest.approx(1.0 + 0.5 / np.e + 0.4e-3, rel=1e-9)


def test_bouc_wen_of_exponent_2_loads_along_a_tanh_and_unloads_along_a_tan():
    velocity = np.concatenate((np.full(10, 0.02), np.full(4, -0.02)))
    force = bouc_wen.along(
        velocity, DT, coulomb=0.35, initial_stiffness=3000.0, exponent=2.0, unloading_share=1.0,
        viscous=0.0,
    )  # fmt: skip
    way = 0.02 * DT * 3000.0 / 0.35 * np.arange(1, 11)
    top = np.tanh(way[-1])
    exact = np.concatenate((np.tanh(way), np.tan(np.arctan(top) - way[:4])))
    assert force == pytest.approx(0.35 * exact, rel=1e-9)


def test_the_ladder_of_dahls_loop_goes_back_along_it_and_closes_its_loops():
    values = {"coulomb": 0.35, "initial_stiffness": 3000.0, "exponent": 2.0, "viscous": 0.0}
    step = 2e-5
    path = np.concatenate((np.full(2000, 50.0), np.full(20, -1.0), np.full(20, 1.0))) * step
    force = dahl_with_memory.along(path / DT, DT, **values)
    # Dahl's loop from F_c: r = 2/(1 + 2 y).
    y = 3000.0 * step * np.arange(1, 21) / 0.35
    assert force[2000:2020] == pytest.approx(0.35 * (2.0 / (1.0 + 2.0 * y) - 1.0), abs=2e-4)
    assert force[-1] == pytest.approx(force[1999], abs=1e-12)


def test_gms_elements_slide_at_the_published_level_and_near_it_at_the_rate_of_attraction():
    values = lugre.PUBLISHED | {"yield_shape": 0.5, "attraction": 5.0, "viscous": 0.0}
    values.pop("damping")
    path = np.concatenate((np.full(50, 5e-4), np.full(50, 2e-3)))
    force = gms.along(path, 0.02, **values)
    slow, fast = (1.0 + 0.5 * np.exp(-((v / 1e-3) ** 2)) for v in (5e-4, 2e-3))
    assert force[49] == pytest.approx(slow, rel=1e-10)
    left = np.exp(-5.0 * 0.02 * np.arange(1, 51) / fast)
    assert force[50:] == pytest.approx(fast + (slow - fast) * left, rel=1e-9)


def test_gms_elements_of_even_yield_points_have_them_at_odd_sixteenths():
    assert gms.shares(0.5) == pytest.approx((2.0 * np.arange(8) + 1.0) / 64.0, rel=1e-12)


def test_leuven_of_exponent_1_loads_along_a_logistic_curve_up_to_the_level():
    values = {"coulomb": 0.5, "breakaway": 0.5, "stribeck_velocity": 0.1, "stribeck_exponent": 2.0}
    values |= {"initial_stiffness": 3000.0, "saturation": 1.5, "damping": 0.0}
    force = leuven.along(np.full(30, 0.02), DT, **values)
    way = 0.02 * DT * 3000.0 * np.arange(1, 31)
    u = 0.5 / 0.75 * np.exp(-way * (1.0 / 0.5 - 1.0 / 0.75))
    assert force == pytest.approx((0.5 - 0.75 * u) / (1.0 - u), rel=1e-8)


def test_leuven_forgets_inner_turns_that_a_later_excursion_passed():
    assert leuven.dominant([0.0, 3.0, -1.0, 2.0, 0.5, 2.5, -0.5]) == [3.0, -1.0, 2.5, -0.5]
