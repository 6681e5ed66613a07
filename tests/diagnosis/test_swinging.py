"""What swings behind a motor: a rigid contact holds it at rest, and slopes tell little of it."""

import math

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.screening.candidates import Scales, candidates
from stiction.residual import effort_residual

SHAFT = (("shaft_compliance", 0.013),)
COUNT = 2.0 * math.pi / 2**18
DT = 1e-3


@pytest.fixture(scope="module")
def made():
    """A dry contact before a shaft that rings at some 200 Hz."""
    return make_session(4302, base="coulomb", hidden=SHAFT)


def machine(made, *, shaft):
    (hidden,) = made.effects
    effects = [{"name": hidden.name, "compliance": hidden.amplitude, **hidden.shape}]
    known = made.plant
    return st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": known["inertia"]},
            "friction": {
                "law": "coulomb",
                "coulomb": known["coulomb"],
                "viscous": known["viscous"],
            },
            "effects": effects if shaft else [],
            "sensor": {"counts_per_rev": made.spec.counts_per_rev},
        }
    )


@pytest.mark.slow
def test_a_contact_at_rest_holds_what_rings_behind_it(made):
    ratios = {}
    for recording in as_session(made).recordings:
        if np.ptp(recording.position) == 0.0:
            continue
        with_it, without = (
            effort_residual(machine(made, shaft=shaft), recording).rms for shaft in (True, False)
        )
        ratios.setdefault(recording.kind, []).append(with_it / without)
    # What stops and sets out most shows it most.
    assert max(ratios["pulses"]) < 0.7
    assert max(ratios["sines"]) < 0.8
    assert max(ratios["dwell"] + ratios["ramps"]) < 1.05
    assert max(ratios["tracking"]) < 1.1


def test_a_shaft_behind_a_dry_contact_is_found_with_its_resonance(made):
    found = st.diagnose(as_plant(made), as_session(made), threads=1)
    assert [(cause.name, cause.decided) for cause in found.effects] == [("shaft_compliance", True)]
    assert found.verdict == "missing_effect"
    assert found.gain.value > 0.3
    (hidden,) = made.effects
    values = {path.rpartition(".")[2]: p.value for path, p in found.effects[0].parameters.items()}
    assert values["compliance"] == pytest.approx(hidden.amplitude, rel=0.15)
    assert values["inertia_share"] == pytest.approx(hidden.shape["inertia_share"], abs=0.08)


def test_counts_of_a_slow_motion_shake_no_mass(made):
    """Between two counts a creeping machine seems to rest; it stopped, and then it crept on."""
    time = DT * np.arange(4000)
    fast = 0.5 - 2.0 * np.maximum(0.5 - time, 0.0) ** 2
    slow = 0.3 * COUNT * np.maximum(time - 0.8, 0.0) / DT
    position = COUNT * np.floor((fast + slow) / COUNT)
    level = made.plant["coulomb"]
    effort = np.where(
        time < 0.5, level - 4.0 * made.plant["inertia"], np.where(time < 0.8, 0.0, level)
    )
    recording = st.Recording(time, effort, position)
    with_it, without = (
        effort_residual(machine(made, shaft=shaft), recording) for shaft in (True, False)
    )
    late = with_it.time > 1.0
    moved = np.mean((with_it.residual - without.residual)[late])
    assert abs(moved) < 1e-3 * level


@pytest.mark.parametrize(("seed", "size"), [(42, 0.1), (41, 0.25), (43, 0.25), (42, 0.25)])
def test_a_shaft_that_swings_as_slowly_as_the_machine_moves_is_found(seed, size):
    """From 50 Hz down to 18: the slope at no compliance knows nothing of these."""
    hidden = (("shaft_compliance", size),)
    session = make_session(seed, base="maxwell_slip", hidden=hidden, seconds=72.0)
    found = st.diagnose(as_plant(session), as_session(session), surrogates=6, threads=1)
    assert found.effects[0].name == "shaft_compliance"
    assert found.effects[0].decided
    (true,) = session.effects
    values = {path.rpartition(".")[2]: p.value for path, p in found.effects[0].parameters.items()}
    assert values["compliance"] == pytest.approx(true.amplitude, rel=0.1)
    assert values["inertia_share"] == pytest.approx(true.shape["inertia_share"], abs=0.05)


def test_what_swings_is_looked_at_at_resonances_that_samples_show():
    (record,) = [each for each in st.effects() if each.name == "shaft_compliance"]
    units = {"one": 1.0}
    for rate, highest in ((1000.0, 96.0), (200.0, 48.0), (20.0, 0.0)):
        scales = Scales((0.1, 1.0), (1.0,), True, units, rate=rate)
        found = candidates(record, scales)
        assert max(each.resonance for each in found) == highest
        assert sum(each.resonance == 0.0 for each in found) == 6
