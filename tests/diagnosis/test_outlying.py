"""What one recording alone shows is told, and no name is sure where its geometry leaves a rest."""

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_session

import stiction as st


def size_of(made, parts, share):
    """Torques scaled to a share of F_c over the whole session."""
    rms = float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))
    return [share * made.plant["coulomb"] / rms * part for part in parts]


def diagnosed(made, parts):
    """The same motion, for which the input would have been another one."""
    torque = [r.torque_nm + part for r, part in zip(made.recordings, parts, strict=True)]
    return st.diagnose(as_plant(made), as_session(made, torque), threads=1)


def test_a_torque_in_one_recording_that_decides_is_told():
    made = make_session(201)
    chosen = [k for k, r in enumerate(made.recordings) if r.role == "select"][2]
    parts = [
        np.sin(2.0 * np.pi * 2.3 * r.time_s) * (k == chosen) for k, r in enumerate(made.recordings)
    ]
    found = diagnosed(made, size_of(made, parts, 0.012))
    assert found.verdict == "unexplained"
    assert found.effects == ()
    assert [each.coordinate for each in found.unexplained] == [f"recording {chosen + 1} alone"]
    assert found.unexplained[0].share > 0.5
    assert f"recording {chosen + 1} alone" in found.sentence


@pytest.mark.slow
@pytest.mark.parametrize("turns", [True, False])
def test_an_inertia_that_changes_with_the_angle_is_no_sure_error_of_the_encoder(turns):
    hidden = () if turns else (("encoder_eccentricity", 0.012),)
    made = make_session(204 if turns else 214, hidden=hidden)
    parts = [np.zeros(r.time_s.size) for r in made.recordings]
    if turns:
        # d/dt (J v) - J' v^2 / 2, where J = cos(x + .7) is what the inertia has more.
        angles = [r.truth["position"] + 0.7 for r in made.recordings]
        speeds = [r.truth["velocity"] for r in made.recordings]
        parts = size_of(
            made,
            [
                np.cos(x) * np.gradient(v, r.time_s) - 0.5 * np.sin(x) * v**2
                for x, v, r in zip(angles, speeds, made.recordings, strict=True)
            ],
            0.012,
        )
    found = diagnosed(made, parts)
    (cause,) = found.effects
    assert cause.name == "encoder_eccentricity"
    assert cause.decided is not turns
    assert found.verdict in (("ambiguous", "unexplained") if turns else ("missing_effect",))
    left = {each.coordinate for each in found.unexplained}
    grown = {f"order over position, times {by}" for by in ("acceleration", "squared speed")}
    assert bool(left & grown) is turns


def test_a_torque_in_one_recording_that_tests_is_told_and_decides_nothing():
    made = make_session(202)
    chosen = [k for k, r in enumerate(made.recordings) if r.role == "test"][1]
    parts = [
        np.sin(2.0 * np.pi * 2.3 * r.time_s) * (k == chosen) for k, r in enumerate(made.recordings)
    ]
    found = diagnosed(made, size_of(made, parts, 0.012))
    assert (found.verdict, found.effects) == ("nothing_missing", ())
    (check,) = [each for each in found.data["checks"] if each["name"] == "alone"]
    assert check["recording"] == f"recording {chosen + 1}"
    assert f"Of the recordings that test, recording {chosen + 1} leaves" in found.sentence


def test_a_session_like_all_its_recordings_tells_of_none():
    made = make_session(203)
    found = diagnosed(made, [np.zeros(r.time_s.size) for r in made.recordings])
    assert not [each for each in found.data["checks"] if each["name"] == "alone"]


def test_an_encoder_that_errs_several_times_a_turn_is_no_sure_ripple():
    made = make_session(404)
    order, size = 5.0, 4e-3
    count = 2.0 * np.pi / made.spec.counts_per_rev
    for recording in made.recordings:
        angle = recording.truth["position"]
        read = angle + size * np.cos(order * angle + 0.3)
        recording.position_rad = count * np.round(read / count)
    found = diagnosed(made, [np.zeros(r.time_s.size) for r in made.recordings])
    assert not any(cause.decided for cause in found.effects)
    left = {each.coordinate for each in found.unexplained}
    assert "order over position, times squared speed" in left
    assert found.verdict == "unexplained"
