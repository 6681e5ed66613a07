"""More effects: what holds for all of them, and drives against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from .effect_catalogue import EFFECTS
from .excitation_reference import BASES, draw_plant
from .plant_reference import EffectGroup, simulate
from .session_reference import Draft, Spec, make_session, make_sessions
from .test_plant_reference import COUNT, identity_batch, lanes_with

pytestmark = pytest.mark.slow  # of the simulators that tests use, not of the package

DRIVES = (
    "gravity_unbalance",
    "torque_constant_saturation",
    "drive_saturation",
    "back_emf",
    "voltage_limit",
    "current_loop_lag",
)
CONTACTS = (
    "frictional_lag",
    "reverse_point_memory",
    "relaxation",
    "temperature_dependent_friction",
    "load_dependent_friction",
    "backlash",
)
CASES = [
    (name, form, base)
    for name in DRIVES + CONTACTS
    for form in EFFECTS[name].forms
    for base in EFFECTS[name].bases
]
FREE = draw_plant("coulomb", np.random.default_rng(9)) | {"coulomb": 1e-15, "viscous": 0.0}
J = FREE["inertia"]
T = np.arange(400) * 1e-3


def run_of(name, torque, amplitude, shape=(), *, base="coulomb", plant=FREE, **options):
    """One open-loop lane with one effect."""
    shape = {key: np.array([value]) for key, value in dict(shape).items()}
    group = EffectGroup(EFFECTS[name], 0, np.array([0]), np.array([amplitude]), shape)
    return simulate(lanes_with(torque, base=base, plant=plant, groups=[group], **options))


# --- all of them


@pytest.mark.parametrize("base", BASES)
def test_foreign_forms_without_amplitude_change_no_bit(base):
    names = [name for name, form, of in CASES if (form, of) == ("foreign", base)]
    options = {"seed": 3, "base": base, "seconds": 6 * 0.25, "roles": ("train",)}
    plain = make_sessions([options | {"channels": {EFFECTS[n].channel} - {None}} for n in names])
    named = make_sessions([options | {"hidden": [(f"{n}:foreign", 0.0)]} for n in names])
    for name, one, two in zip(names, plain, named, strict=True):
        for a, b in zip(one.recordings, two.recordings, strict=True):
            assert a.torque_nm.tobytes() == b.torque_nm.tobytes(), (name, a.kind)
            assert a.position_rad.tobytes() == b.position_rad.tobytes(), (name, a.kind)
            assert not b.truth["hidden"].any(), (name, a.kind)


def lacking(batch, run):
    """J x'' - u - load - noise + F_c sgn x' + F_v x' where a dry contact slides, and the hidden."""
    inertia, coulomb, viscous = (
        np.array([p[key] for p in batch.plants]) for key in ("inertia", "coulomb", "viscous")
    )
    v, after = run.velocity[:-1], run.velocity[1:]
    acting = run.input + batch.noise + (0.0 if batch.load is None else batch.load)
    friction = coulomb * np.sign(v) + viscous * 0.5 * (v + after)
    needed = inertia * (after - v) / 1e-3 + friction - acting[:-1]
    hidden = run.hidden.sum(axis=0)[:-1]
    assert not hidden[after == 0.0].any()
    sliding = v * after > 0.0
    return needed[sliding], hidden[sliding]


@pytest.mark.parametrize(("name", "form"), [c[:2] for c in CASES if c[2] == "coulomb"])
def test_hidden_torque_is_what_a_sliding_dry_contact_lacks(name, form):
    batch = identity_batch("coulomb", name, form)
    needed, hidden = lacking(batch, simulate(batch))
    np.testing.assert_allclose(hidden, needed, rtol=0, atol=1e-8)
    assert hidden.any()


@pytest.mark.parametrize("form", ["library", "foreign"])
def test_a_gap_parts_what_a_shaft_leaves(form):
    for order in (1, -1):
        batch = identity_batch("coulomb", "backlash", form)
        shaft = identity_batch("coulomb", "shaft_compliance", "library").groups[0]
        batch.groups = [replace(shaft, slot=1), *batch.groups][::order]
        needed, hidden = lacking(batch, simulate(batch))
        np.testing.assert_allclose(hidden, needed, rtol=0, atol=1e-8)


@pytest.mark.parametrize("base", BASES)
def test_half_the_step_leads_to_the_same_recording_with_effects(base):
    """One count; eight behind a gap.

    A mass that bounces in its gap amplifies any difference, the more so where a contact springs:
    in open loop no step is small enough for that, and only the dry contact is asked for it.
    """
    cases = [c[:2] for c in CASES if c[2] == base and (base == "coulomb" or c[0] != "backlash")]
    options = {"base": base, "roles": ("train",), "seconds": 6 * 1.2, "counts_per_rev": 0}
    plant = Draft(Spec(21, base)).plant
    specs = [
        options
        | {"seed": 21, "hidden": [(f"{n}:{f}", None, {"amplitude": EFFECTS[n].usual(plant)})]}
        for n, f in cases
    ]
    runs = [make_sessions([s | {"rate": rate} for s in specs]) for rate in (1e4, 2e4)]
    for (name, form), one, two in zip(cases, *runs, strict=True):
        assert one.effects[0].raw > 5e-4
        bound = (8.0 if name == "backlash" else 1.0) * COUNT
        for a, b in zip(one.recordings, two.recordings, strict=True):
            assert np.abs(a.position_rad - b.position_rad).max() < bound, (name, form, a.kind)


def test_an_effect_is_refused_on_a_contact_that_cannot_have_it():
    with pytest.raises(ValueError, match="ReversePointMemory needs a contact of coulomb"):
        make_session(1, hidden=[("reverse_point_memory", 0.01)], seconds=9.0)
    with pytest.raises(ValueError, match="Relaxation needs a contact of maxwell_slip or"):
        make_session(1, base="coulomb", hidden=[("relaxation", 0.01)], seconds=9.0)


def test_sizes_are_reached_on_dry_contacts():
    cases = [c[:2] for c in CASES if c[2] == "coulomb"]
    options = {"base": "coulomb", "roles": ("train",), "seconds": 6 * 1.5, "rate": 5e3}
    for size in (0.003, 0.01):
        sessions = make_sessions(
            [options | {"seed": 44, "hidden": [(f"{n}:{f}", size)]} for n, f in cases]
        )
        for session in sessions:
            (effect,) = session.effects
            assert effect.reached == pytest.approx(size, rel=0.05), effect.name


# --- unbalance and drives


def test_unbalance_swings_as_a_pendulum_does():
    a, phase = 0.4, 0.7
    run = run_of("gravity_unbalance", np.zeros(400), a, {"phase": phase})
    swing = solve_ivp(
        lambda t, y: [y[1], a * math.cos(y[0] - phase) / J],
        (0.0, T[-1]),
        [0.0, 0.0],
        t_eval=T,
        rtol=1e-10,
        atol=1e-12,
    )
    np.testing.assert_allclose(run.true_position[:, 0], swing.y[0], atol=1e-5 * np.ptp(swing.y[0]))


def test_saturation_takes_its_part_of_the_torque():
    u = np.array([-2.0, -1.0, -0.2, 0.0, 0.2, 1.0, 2.0])
    cubic = run_of("torque_constant_saturation", u, 0.1, {"reference": 2.0})
    np.testing.assert_allclose(cubic.hidden[0, :, 0], -0.1 * u**3 / 4.0, atol=1e-15)
    knee = run_of("torque_constant_saturation", u, 0.1, {"knee": 1.0, "width": 0.1})
    lost = -knee.hidden[0, :, 0]
    np.testing.assert_allclose(lost, -lost[::-1], atol=1e-15)
    # At the knee half a width's softness: w ln 2 / 2, beyond it the share of what is beyond.
    np.testing.assert_allclose(lost[3:], [0.0, 0.0, 0.1 * 0.05 * math.log(2.0), 0.1], atol=1e-7)


def test_a_saturated_drive_clips():
    u = np.linspace(-3.0, 3.0, 61)
    hard = run_of("drive_saturation", u, 1.0, {"limit": 1.0})
    np.testing.assert_allclose(u + hard.hidden[0, :, 0], np.clip(u, -1.0, 1.0), atol=1e-15)
    soft = run_of("drive_saturation", u, 1.0, {"limit": 1.0, "softness": 0.3})
    reached = u + soft.hidden[0, :, 0]
    assert np.all(np.diff(reached) >= 0.0)
    assert np.abs(reached).max() == pytest.approx(1.3, rel=1e-3)
    inside = np.abs(u) <= 1.0
    np.testing.assert_allclose(reached[inside], u[inside], atol=1e-15)


@pytest.mark.parametrize("form", ["library", "foreign"])
def test_a_limit_by_speed_is_brought_to_size_by_where_it_lies(form):
    session = make_session(
        31, base="coulomb", hidden=[(f"voltage_limit:{form}", 0.012)], seconds=30.0
    )
    (effect,) = session.effects
    assert effect.amplitude == 1.0
    assert effect.reached == pytest.approx(0.012, rel=0.15)
    limit, no_load = effect.shape["limit"], effect.shape["no_load"]
    for r in session.recordings:
        # Speeds are those at stamps, between which they change a little.
        reach = limit * (1.0 - np.abs(r.truth["velocity"]) / no_load)
        still = np.abs(r.torque_nm) <= 0.98 * reach
        assert not r.truth["hidden"][still].any()


@pytest.mark.parametrize("form", ["library", "foreign"])
def test_a_limit_is_brought_to_size_by_where_it_lies(form):
    """Nothing of what is beyond it gets through, however small a size is asked for."""
    session = make_session(
        31, base="coulomb", hidden=[(f"drive_saturation:{form}", 0.012)], seconds=30.0
    )
    (effect,) = session.effects
    assert effect.amplitude == 1.0
    assert effect.reached == pytest.approx(0.012, rel=0.15)
    for r in session.recordings:
        within = np.abs(r.torque_nm) <= effect.shape["limit"]
        assert not r.truth["hidden"][within].any()
        if form == "library":
            acts = r.torque_nm + r.truth["hidden"]
            np.testing.assert_allclose(np.abs(acts[~within]), effect.shape["limit"], rtol=1e-12)


def test_a_coasting_bridge_ends_at_its_no_load_speed():
    u, no_load = 0.8, 12.0
    run = run_of("back_emf", np.full(400, u), 1.0 / no_load)
    expected = no_load * -np.expm1(-u * T / (no_load * J))
    np.testing.assert_allclose(run.velocity[:, 0], expected, atol=1e-5 * no_load)
    coasting = run_of("back_emf", np.where(T < 0.02, u, 0.0), 1.0 / no_load)
    assert np.ptp(coasting.velocity[20:, 0]) == 0.0
    # Beyond the knee the loss is that of the knee, so the speed that is reached grows with u.
    above = run_of("back_emf", np.full(400, u), 1.0 / no_load, {"knee": 0.5})
    expected = no_load * u / 0.5 * -np.expm1(-0.5 * T / (no_load * J))
    np.testing.assert_allclose(above.velocity[:, 0], expected, atol=1e-5 * no_load)
    below = run_of("back_emf", np.full(400, u), 1.0 / no_load, {"knee": 1.0})
    np.testing.assert_array_equal(below.velocity, run.velocity)


def test_a_current_loop_out_of_voltage_ends_at_its_no_load_speed():
    u, stall, no_load = 0.5, 1.0, 12.0
    run = run_of("voltage_limit", np.full(400, u), 1.0, {"limit": stall, "no_load": no_load})
    at = 0.5 * no_load  # from where on there is less than u
    begin = at * J / u
    falling = no_load + (at - no_load) * np.exp(-stall * (T - begin) / (no_load * J))
    np.testing.assert_allclose(
        run.velocity[:, 0], np.where(begin > T, u * T / J, falling), atol=1e-4 * no_load
    )


def test_what_a_rounded_voltage_limit_reaches_runs_out_with_speed():
    u = np.concatenate([np.zeros(10), np.full(390, 3.0)])
    shape = {"limit": 1.0, "no_load": 1e9, "width": 0.3}
    still = run_of("voltage_limit", u, 1.0, shape)
    np.testing.assert_allclose(3.0 + still.hidden[0, 50, 0], 1.0 + 0.3 * math.tanh(2.0 / 0.3))
    running = run_of("voltage_limit", u, 1.0, shape | {"no_load": 12.0})
    reached = u + running.hidden[0, :, 0]
    assert np.all(np.diff(reached[20:]) <= 1e-12)
    assert reached[-1] == pytest.approx(0.3, abs=0.01)


@pytest.mark.parametrize("lags", [1.0, 2.0])
def test_a_sine_through_the_current_loop_is_smaller_and_late(lags):
    late, omega = 4e-3, 2.0 * np.pi * 20.0
    t = np.arange(1000) * 1e-3
    u = np.sin(omega * t)
    run = run_of("current_loop_lag", u, late, {"lags": lags})
    acting = u + run.hidden[0, :, 0]
    steady = slice(500, 1000)  # 10 periods
    response = np.mean(acting[steady] * np.exp(-1j * omega * t[steady])) / np.mean(
        u[steady] * np.exp(-1j * omega * t[steady])
    )
    lag = 1.0 / (1.0 + 1j * omega * late / lags) ** lags
    if lags == 1.0:
        assert abs(lag) == pytest.approx(1.0 / math.sqrt(1.0 + (omega * late) ** 2), rel=1e-12)
    # A staircase and the mean over a sample are what is left of the sine at 1 kHz.
    seen = np.sinc(omega * 1e-3 / (2.0 * np.pi)) ** 2
    assert response == pytest.approx(seen * lag, abs=3e-4)
