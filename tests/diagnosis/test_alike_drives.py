"""Causes of a drive that look alike: what only one of them can do tells them apart."""

from functools import cache

import numpy as np
import pytest
from scipy.signal import lfilter
from tests.blind.score import as_plant, as_session
from tests.diagnosis.builders import DT, plant
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.phrases import PARTLY

SIZE = 0.012
"""rms of what is hidden as a share of F_c."""


@cache
def hidden(name, seed, base="maxwell_slip", size=SIZE):
    made = make_session(seed, base=base, hidden=[(name, size)])
    return made, st.diagnose(as_plant(made), as_session(made), threads=1)


def row_of(found, name):
    (row,) = [each for each in found.candidates if each.name == name]
    return row


def added(made, torque):
    """The same motion, for which the input would have been another one by this, of that size."""
    parts = [torque(r) for r in made.recordings]
    rms = float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
    scale = 0.015 * made.plant["coulomb"] / rms
    inputs = [r.torque_nm + scale * part for r, part in zip(made.recordings, parts, strict=True)]
    return st.diagnose(as_plant(made), as_session(made, inputs), threads=1)


@pytest.mark.slow
def test_a_limit_is_named_though_it_acts_in_one_recording_of_each_role():
    made, found = hidden("drive_saturation", 9900008, "coulomb")
    limit = made.effects[0].shape["limit"]
    acts = [r.role for r in made.recordings if np.abs(r.torque_nm).max() > limit]
    assert sorted(acts) == ["select", "test", "train"]
    (cause,) = found.effects
    assert (cause.name, cause.decided) == ("drive_saturation", True)
    share, reached = (
        cause.parameters[f"effects.drive_saturation.{name}"].value for name in ("share", "limit")
    )
    assert share > 0.95
    assert reached == pytest.approx(limit, rel=0.01)


@pytest.mark.slow
def test_a_limit_that_comes_down_with_speed_is_named_and_a_small_part_beyond_it_is_none():
    """A drive that is out of voltage gives no more, however much is asked for."""
    _, found = hidden("voltage_limit", 12750007, "coulomb", 0.0106)
    (cause,) = found.effects
    assert (cause.name, cause.decided) == ("voltage_limit", True)
    part = {"amplitude": 0.05, "limit": 0.9, "no_load": 14.0}
    made = make_session(713, base="coulomb", hidden=[("voltage_limit", None, part)])
    found = st.diagnose(as_plant(made), as_session(made), threads=1)
    assert "voltage_limit" not in [cause.name for cause in found.effects]
    assert "beyond a limit nothing gets through" in row_of(found, "voltage_limit").reason


@pytest.mark.slow
@pytest.mark.parametrize("form", ["library", "foreign"])
def test_a_part_that_is_lost_of_large_inputs_is_a_torque_constant_that_falls(form):
    """Beyond a soft knee a twentieth is lost: a limit with a small share fits that best."""
    _, found = hidden(f"torque_constant_saturation:{form}", 612, "coulomb")
    (cause,) = found.effects
    assert (cause.name, cause.decided) == ("torque_constant_saturation", True)
    reason = row_of(found, "drive_saturation").reason
    assert "beyond a limit nothing gets through" in reason


@pytest.mark.parametrize(("share", "sure"), [(1.0, True), (0.4, False)])
def test_a_limit_that_surely_lets_a_part_through_is_left_open(share, sure):
    """A gain that falls to a floor, which the catalogue has not, looks like such a limit."""
    limited = plant(effects=[{"name": "drive_saturation", "share": share, "limit": 0.35}])
    source = np.random.default_rng(5)
    time = np.arange(2500) * DT
    recordings = []
    for role in ("train", "train", "select", "test"):
        waves = [0.3 * np.sin(w * time + source.uniform(0.0, 6.0)) for w in (2.0, 5.3, 13.0)]
        effort = np.sum(waves, axis=0)
        moved = limited.motor().simulate(effort[:-1], DT).position
        position = np.concatenate([[0.0], moved]) + 1e-5 * source.standard_normal(len(time))
        recordings.append(st.Recording(time, effort, position, role=role))
    found = st.diagnose(plant(body={}), recordings, surrogates=8, threads=1)
    (cause,) = found.effects
    assert (cause.name, cause.decided) == ("drive_saturation", sure)
    assert cause.doubt == ("" if sure else PARTLY)


def test_a_mass_that_is_dragged_along_is_no_friction_that_comes_late():
    """Coupled by oil alone, it pulls at all speeds; a lag of friction is over at low ones."""

    def dragged(recording):
        velocity = recording.truth["velocity"]
        smoothing = 1e-3 / (0.03 + 1e-3)
        return velocity - lfilter([smoothing], [1.0, smoothing - 1.0], velocity)

    found = added(make_session(551), dragged)
    assert found.verdict == "unexplained"
    assert "frictional_lag" not in [cause.name for cause in found.effects]
    assert found.unexplained[0].coordinate == "response to the effort"


def test_a_drive_that_gives_more_one_way_is_no_sure_friction_of_one_direction():
    found = added(make_session(502), lambda recording: np.abs(recording.torque_nm))
    assert all(not cause.decided for cause in found.effects)
    assert "effort" in [each.coordinate for each in found.unexplained]
