"""Rate-and-state friction fitted: to what it made itself, and to rock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction.fitting.minimise import launch
from stiction.fitting.rows import Rows
from stiction.fitting.start import complete, free_paths

MOVED = {"motion": {"kind": "linear"}, "drive": {"kind": "prescribed_motion"}}
BLOCK_S = 0.5
PLACED = (0.0, 0.5, 1.0, 1.5)
"""Where the blocks begin, in blocks: which of them holds the step decides much."""


def plant(law: str, **friction: object) -> st.Plant:
    return st.Plant.from_dict(MOVED | {"friction": {"law": law} | friction})


def test_naming_the_law_is_enough_for_its_own_recording() -> None:
    dt = 0.01
    time = dt * np.arange(6000)
    speeds = 1e-5 * 10.0 ** np.repeat([0.0, 1.0, 0.0, 1.5, 0.5, 1.0], 1000)
    position = np.concatenate([[0.0], np.cumsum(speeds[1:] * dt)])
    law = st.FrictionModel(
        "rate_and_state", coulomb=40.0, slip_distance=2e-5, reference_velocity=1e-4,
        direct_effect=0.02, evolution_effect=0.03,
    )  # fmt: skip
    effort = np.concatenate([[40.0], law.simulate(speeds[1:], dt)])
    fixed = {"value": 0.0, "fixed": True}
    recording = st.Recording(time, None, position, effort=effort)
    found = st.fit(plant("rate_and_state", viscous=fixed), recording)
    assert found.success
    # The reference speed is that of the data and fixed; Coulomb friction goes with it.
    reference = found.plant.parameters["friction.reference_velocity"]
    assert reference.fixed
    steady = 40.0 * (1.0 - 0.01 * np.log(reference.value / 1e-4))
    assert found["coulomb"].value == pytest.approx(steady, rel=3e-3)
    assert found["direct_effect"].value * steady == pytest.approx(0.8, rel=0.05)
    assert found["evolution_effect"].value * steady == pytest.approx(1.2, rel=0.05)
    assert found["slip_distance"].value == pytest.approx(2e-5, rel=0.05)


@pytest.fixture
def rock(shared_data: Path) -> st.Recording:
    """Basalt, sheared at 3 and then at 10 µm/s."""
    return st.Recording.load(
        shared_data / "rock_rsf" / "velstep4_BRAVA_expb819_basalt.txt",
        {
            "time": "Time(s)",
            "position": {"name": "Displ(microns)", "unit": "µm"},
            "friction_coefficient": "Friction",
            "normal_force": "Normal_stress(MPa)",
        },
    )


# A rig of this kind yields by about 1e-11 m/Pa; viscous friction and a - b are one at two speeds.
RIG = {"compliance": 1e-11, "viscous": {"value": 0.0, "fixed": True}}


@pytest.mark.parametrize(
    ("evolution", "distance"), [("ageing", (5e-6, 8.5e-6)), ("slip", (6.5e-6, 11e-6))]
)
def test_rock_shows_its_classic_values(
    rock: st.Recording, evolution: str, distance: tuple[float, float]
) -> None:
    found = st.fit(plant("rate_and_state", evolution=evolution, **RIG), rock)
    assert found.success
    assert not found.bounds_hit
    assert not found.undetermined
    mu_0 = found["coulomb"].value / 19.97e6
    direct, evolving = (found[name].value * mu_0 for name in ("direct_effect", "evolution_effect"))
    assert 0.005 < direct < 0.012
    assert abs(evolving - direct) < 0.1 * direct
    assert distance[0] < found["slip_distance"].value < distance[1]
    for name in ("direct_effect", "evolution_effect", "slip_distance"):
        low, high = found[name].ci95
        assert 0.0 < low < found[name].value < high < 2.0 * found[name].value
    # The stiffness of the rig as rock mechanics gives it: 5e-3 to 12e-3 of normal stress per µm.
    assert 5e-3 < 1e-6 / (found["compliance"].value * 19.97e6) < 12e-3


def test_no_law_without_an_age_follows_the_step_on_rows_that_were_not_fitted(
    rock: st.Recording,
) -> None:
    left = {}
    stribeck = {"coulomb": 1.2e7, "breakaway": 1.25e7, "stribeck_velocity": 5e-6}
    for name, own in {
        "coulomb": plant("coulomb"),
        "stribeck": plant("coulomb", **stribeck),
        "maxwell_slip": plant("maxwell_slip"),
        "rigid": plant("rate_and_state", viscous=RIG["viscous"]),
        "rate_and_state": plant("rate_and_state", **RIG),
    }.items():
        left[name] = held_around_the_step(own, rock)
    # 78, 78, 85, 43 and 35 kPa of 12.1 MPa.
    assert left["rigid"] < 0.6 * min(left["coulomb"], left["stribeck"], left["maxwell_slip"])
    assert left["rate_and_state"] < 0.9 * left["rigid"]


def held_around_the_step(own: st.Plant, recording: st.Recording) -> float:
    """Residual of the blocks in between where the speed steps, after a fit to every other block."""
    from stiction.residual.weak_form import WeakForm

    form = WeakForm(own, recording, every=0.01)
    since = form.time - recording.time[0]
    power = []
    for place in PLACED:
        phase = (since / BLOCK_S + place) % 2.0
        rows = Rows(own, form, 0, (since > 0.2) & (phase < 0.86))
        held = (phase > 1.07) & (phase < 1.93) & (since > 68.0) & (since < 71.5)
        starts = complete(own, [form])
        found = launch(starts, free_paths(starts[0]), [rows], most=200)
        power.append(np.mean(rows.residual(found.plant, found.nuisances)[held] ** 2))
    return float(np.sqrt(np.mean(power)))
