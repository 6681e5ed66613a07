"""Recordings that decide or test begin where their contact was left: no error of a plant."""

from __future__ import annotations

import numpy as np
from tests.reference.ladder_spring import LadderSpring

import stiction as st
from stiction.fitting.recording_starts import fit_starts
from stiction.fitting.rows import WARM_UP_S, Nuisances, Rows
from stiction.residual.weak_form import WeakForm

DT = 0.01
NOISE = 0.1  # N
OIL = 150.0  # N s/m
SLIDING = 0.005  # m, a dozen times the length over which the contact yields
LOADED = 3e-4  # m, from where loops a tenth as wide never slide
COARSE = 2e-4  # m, half the length over which it yields
CURVE = {"initial_stiffness": 8e4, "final_stiffness": 1.0, "decay_distance": 4e-4}
PLANT = st.Plant.from_dict(
    {
        "motion": {"kind": "linear"},
        "drive": {"kind": "prescribed_motion"},
        "friction": {"law": "maxwell_slip"},
    }
)


def moved(
    seed: int, role: str, size: float, before: float = 0.0, count: float = 0.0
) -> st.Recording:
    """Swings of a damper that was moved so far before anybody recorded it, read in counts."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 20.0, DT)
    swings = zip((1.0, 0.5, 0.3), (0.23, 0.51, 0.97), rng.uniform(0.0, 6.28, 3), strict=True)
    way = sum(share * np.sin(2.0 * np.pi * rate * time + at) for share, rate, at in swings)
    position = size * (way - way[0])
    spring = LadderSpring(**CURVE)
    spring.advance(before)
    force = np.array([spring.advance(step) for step in np.diff(position, prepend=0.0)])
    effort = force + OIL * np.gradient(position, time) + NOISE * rng.standard_normal(len(time))
    read = count * np.round(position / count) if count else position
    return st.Recording(time, None, read, effort=effort, role=role, kind=f"{size:g}")


def session(*roles: str) -> st.Session:
    """Slides that are fitted, and small loops under force in each of these roles."""
    loops = [moved(k, role, 0.1 * LOADED, LOADED) for k, role in enumerate(roles, 10)]
    return st.Session([moved(0, "train", SLIDING), moved(1, "train", LOADED), *loops])


def test_what_a_contact_brought_along_is_no_error_of_a_fit() -> None:
    found = st.fit(PLANT, session("test"))
    assert found.heldout_rms is not None
    # A contact that was never moved would be wrong by nearly all of its force, some 12 N.
    assert found.heldout_rms < 2.0 * NOISE
    assert "recording 3" not in found.starts


def test_what_a_contact_brought_along_is_not_taken_for_something_missing() -> None:
    found = st.diagnose(PLANT, session("select", "select", "test"), surrogates=6)
    assert found.verdict == "nothing_missing", found.sentence
    assert found.baseline.select_rms is not None
    assert found.baseline.heldout_rms is not None
    assert max(found.baseline.select_rms, found.baseline.heldout_rms) < 2.0 * NOISE


def test_a_start_is_found_from_the_rows_of_its_own_recording() -> None:
    loops = moved(20, "test", 0.1 * LOADED, LOADED)
    form = WeakForm(PLANT, loops)
    rows = Rows(PLANT, form, 0, np.ones(len(form), dtype=bool))
    fitted = st.fit(PLANT, session("test")).plant
    spring = LadderSpring(**CURVE)
    spring.advance(LOADED)
    found = fit_starts(fitted, [rows], Nuisances(0.0, {7: {"force": 1.0}}))
    assert abs(found.starts[0]["force"] - spring.force()) < 0.05 * spring.force()
    assert found.starts[7] == {"force": 1.0}
    # Where a law brings nothing along there is nothing to find.
    rigid = st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"kind": "prescribed_motion"},
            "friction": {"law": "coulomb", "coulomb": 10.0},
        }
    )
    assert fit_starts(rigid, [rows], Nuisances()) == Nuisances()


def test_a_contact_that_is_moved_and_read_coarsely_is_told_without_a_ring() -> None:
    # Within two counts the contact has yielded, and there is no inertia that could ring on it.
    roles = ("train", "select", "test")
    read = [moved(k, role, SLIDING, count=COARSE) for k, role in enumerate(roles)]
    found = st.diagnose(PLANT, st.Session(read), surrogates=6)
    assert "so that it shows little" in found.data["residual"]
    assert "rings" not in found.data["residual"]


def bent(seed: int, role: str, *before: float, size: float = LOADED) -> st.Recording:
    """Loops that never slide, on a contact that earlier ways have bent."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 20.0, DT)
    swings = zip((1.0, 0.6), (0.31, 0.83), rng.uniform(0.0, 6.28, 2), strict=True)
    way = sum(share * np.sin(2.0 * np.pi * rate * time + at) for share, rate, at in swings)
    position = size * (way - way[0])
    spring = LadderSpring(**CURVE)
    for step in before:
        spring.advance(step)
    force = np.array([spring.advance(step) for step in np.diff(position, prepend=0.0)])
    effort = force + OIL * np.gradient(position, time) + NOISE * rng.standard_normal(len(time))
    return st.Recording(time, None, position, effort=effort, role=role, kind="loops")


SLID_BACK = (SLIDING, -4.4e-4)
"""m: beyond a slide, and back to about no force."""
RANG = (-SLIDING, 7e-4, -3e-4)
"""m: let go after a slide the other way, past the middle and back."""


def machine(*recordings: st.Recording) -> st.Session:
    """Slides to fit, and loops on bent contacts."""
    return st.Session([moved(0, "train", SLIDING), moved(1, "train", LOADED), *recordings])


def test_a_contact_that_slid_and_was_let_go_is_no_error_of_a_fit() -> None:
    found = st.fit(PLANT, machine(bent(30, "train", *SLID_BACK), bent(31, "test", *RANG)))
    assert found.heldout_rms is not None
    # On the curve of first loading it would be 1.4 and 0.26 N, most of it in the first loops.
    assert max(found.train_rms, found.heldout_rms) < NOISE
    assert abs(found.starts["recording 3"]["turned"]) > 0.9


def test_a_contact_that_slid_and_was_let_go_sets_no_recording_apart() -> None:
    session = machine(
        bent(40, "select", *SLID_BACK), bent(41, "select", *RANG), bent(42, "test", *RANG)
    )
    found = st.diagnose(PLANT, session, surrogates=6)
    assert not found.effects
    assert not any("alone" in each.coordinate for each in found.unexplained)
    assert found.baseline.select_rms is not None
    assert found.baseline.heldout_rms is not None
    # What is left is the ladder's own; on the curve of first loading it would be eight times that.
    assert max(found.baseline.select_rms, found.baseline.heldout_rms) < NOISE


def test_a_contact_that_was_never_moved_has_no_turn() -> None:
    found = st.fit(PLANT, machine(bent(50, "train")))
    for start in found.starts.values():
        assert "turned" not in start


def test_a_second_turn_is_kept_where_it_explains_more() -> None:
    slid = bent(61, "train", *SLID_BACK)
    fitted = st.fit(PLANT, machine(slid, bent(62, "test", *RANG))).plant
    form = WeakForm(PLANT, bent(60, "test", *RANG))
    rows = Rows(PLANT, form, 0, form.time > WARM_UP_S)
    start = fit_starts(fitted, [rows], Nuisances()).starts[0]
    left = rows.residual(fitted, Nuisances(0.0, {0: start}))[rows.mask]
    assert np.sqrt(np.mean(left**2)) < NOISE
    assert start["turned"] < -0.9
    assert 0.4 < start["turned_again"] < 0.7
    # What it is fitted from afterwards stays: a plant that hardly differs does not lose it.
    again = fit_starts(fitted, [rows], Nuisances(0.0, {0: start})).starts[0]
    assert set(again) == set(start)


def test_a_force_that_makes_up_for_an_offset_hides_no_turn() -> None:
    """It bent all the rest by so much that no turn seemed to change any of it."""
    fitted = st.fit(PLANT, machine(bent(61, "train", *SLID_BACK))).plant
    form = WeakForm(PLANT, bent(60, "test", *SLID_BACK, size=0.5 * LOADED))
    rows = Rows(PLANT, form, 0, form.time > WARM_UP_S)
    start = fit_starts(fitted, [rows], Nuisances()).starts[0]
    left = rows.residual(fitted, Nuisances(0.0, {0: start}))[rows.mask]
    # With a force alone it would be 1.2 N.
    assert np.sqrt(np.mean(left**2)) < NOISE
    assert abs(start["turned"]) > 0.9


def test_an_offset_is_no_turn() -> None:
    # In loops that never slide both are a constant, which is the machine's.
    own = machine(*(bent(70 + k, role) for k, role in enumerate(("train", "select", "test"))))
    pulled = st.Session(
        [
            st.Recording(
                each.time,
                None,
                each.position,
                effort=each.effort + 3.0,
                role=each.role,
                kind=each.kind,
            )
            for each in own
        ]
    )
    found = st.diagnose(PLANT, pulled, surrogates=6)
    assert [cause.name for cause in found.effects] == ["torque_bias"], found.sentence
    (bias,) = found.effects[0].parameters.values()
    # As an effort beside the drive it pulls against what is measured.
    assert abs(bias.value + 3.0) < 0.15
