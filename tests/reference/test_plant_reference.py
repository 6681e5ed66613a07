"""The reference plant against closed forms, against itself, and against what was asked of it."""

import csv
import math
import tomllib
import zlib

import numpy as np
import pytest

from .contact_reference import LadderContact, SeriesContact, branch_curve, contact_of, spring_ladder
from .effect_catalogue import EFFECTS
from .excitation_reference import BASES, KINDS, draw_plant
from .plant_reference import EffectGroup, Lanes, simulate
from .session_reference import LARGEST_FACTOR, Draft, Spec, lanes_of, make_session, make_sessions

STEP = 1e-4
COUNT = 2.0 * math.pi / 2**18
ELASTIC = {name: kind for name, kind in EFFECTS.items() if "maxwell_slip" in kind.bases}
FORMS = [(name, form) for name, kind in ELASTIC.items() for form in kind.forms]


def lanes_with(torque, *, base="coulomb", plant=None, **options):
    """One open-loop lane with these samples of torque."""
    plant = plant or draw_plant(base, np.random.default_rng(5))
    torque = np.asarray(torque, dtype=float)[:, None]
    none = np.zeros(1)
    return Lanes(
        base=base,
        plants=[plant],
        torque=torque,
        reference=np.zeros_like(torque),
        noise=np.zeros_like(torque),
        proportional=none,
        derivative=none,
        integral=none,
        filter_time=np.full(1, 1e-3),
        start=none,
        start_s=none,
        start_path=none,
        **options,
    )


def walk(contact, *turns):
    """Move one lane from position to position in small steps; the force after each leg."""
    forces, x = [], 0.0
    for goal in turns:
        for dx in np.diff(np.linspace(x, goal, 2001)):
            contact.advance(np.array([dx]))
        x = goal
        forces.append(float(contact.force[0]))
    return forces


# --- contacts


def test_elements_close_their_loops_and_double_the_virgin_curve():
    plant = draw_plant("maxwell_slip", np.random.default_rng(3))
    y, k = plant["slip_distance"], plant["stiffness"]

    def virgin(x):
        return float((k * np.minimum(x, y)).sum())

    contact = LadderContact.of_lanes([plant])
    a, b = 0.7 * plant["presliding"], 0.2 * plant["presliding"]
    up, down, again, beyond = walk(contact, a, -b, a, 1.3 * a)
    assert up == pytest.approx(virgin(a), rel=1e-9)
    assert up - down == pytest.approx(2.0 * virgin((a + b) / 2.0), rel=1e-9)
    assert again == pytest.approx(up, rel=1e-9)
    assert beyond == pytest.approx(virgin(1.3 * a), rel=1e-9)
    assert contact.limit[0] == pytest.approx(plant["coulomb"], rel=1e-12)


def test_one_curve_is_met_by_its_elements():
    plant = draw_plant("maxwell_slip", np.random.default_rng(12), one_curve=True)
    y, k, kappa = plant["slip_distance"], plant["stiffness"], plant["yield_shape"]
    assert np.all(k > 0.0)
    x = np.linspace(0.0, plant["presliding"], 200)
    force = np.minimum(x[:, None], y) @ k
    k_0 = plant["coulomb"] * (1.0 - 0.02**kappa) / kappa / plant["presliding"]
    u = np.maximum(1.0 - kappa * k_0 * x / plant["coulomb"], 0.0)
    np.testing.assert_allclose(
        force, plant["coulomb"] * (1.0 - u ** (1.0 / kappa)), atol=1e-3 * plant["coulomb"]
    )


def test_series_spring_follows_the_masing_branches():
    plant = draw_plant("hsieh_pan", np.random.default_rng(4)) | {"creep_rate": 0.0}
    curve = plant["initial_stiffness"], plant["final_stiffness"], plant["decay_distance"]
    contact = SeriesContact([plant], STEP)
    a, b = 0.8 * plant["reach"], -0.3 * plant["reach"]
    up, down, again = walk(contact, a, b, a)
    bound = 0.002 * plant["coulomb"]
    assert up == pytest.approx(branch_curve(2.0 * a, *curve) / 2.0, abs=bound)
    assert up - down == pytest.approx(branch_curve(a - b, *curve), abs=bound)
    assert again == pytest.approx(up, abs=1e-9)


def test_spring_ladder_meets_the_curve_at_its_nodes():
    y, k = spring_ladder(3000.0, 800.0, 3e-4, 5e-4, 28)
    line = 800.0 * y + np.minimum(y[:, None], y[None, :]) @ k
    np.testing.assert_allclose(line, branch_curve(2.0 * y, 3000.0, 800.0, 3e-4) / 2.0, rtol=1e-12)
    assert np.all(k > 0.0)


def test_hook_slides_at_its_level_and_forgets_on_reversal():
    plant = draw_plant("hsieh_pan", np.random.default_rng(6))
    contact = SeriesContact([plant], STEP)
    curve = plant["initial_stiffness"], plant["final_stiffness"], plant["decay_distance"]
    reach = plant["reach"]
    (slide,) = walk(contact, 5.0 * reach)
    assert contact.mode[0] == 1.0
    assert slide == pytest.approx(plant["coulomb"], rel=1e-12)
    assert contact.hardening[0] > 0.0
    contact.advance(np.array([-0.2 * reach]))  # one step: creep is nothing
    assert contact.mode[0] == 0.0
    drop = slide - contact.force[0]
    assert drop == pytest.approx(branch_curve(0.2 * reach, *curve), rel=0.02)


def test_held_force_creeps_towards_its_possible_hardening():
    plant = draw_plant("hsieh_pan", np.random.default_rng(7))
    level = 0.6 * plant["coulomb"]
    torque = level * np.minimum(np.arange(3000) / 500.0, 1.0)
    run = simulate(lanes_with(torque, base="hsieh_pan", plant=plant))
    x = run.true_position[:, 0]
    hardening, after = 0.0, []
    for k in range(30000):
        force = min(k / 5000.0, 1.0) * level
        possible = plant["hardening_coefficient"] * force ** plant["exponent"]
        hardening += plant["creep_rate"] * STEP * max(possible - hardening, 0.0)
        after.append(hardening)
    assert x[-1] - x[1000] == pytest.approx(after[-1] - after[10000], rel=0.05)


@pytest.mark.parametrize("base", ["maxwell_slip", "hsieh_pan"])
def test_contact_never_gives_back_more_than_it_took(base):
    rng = np.random.default_rng(11)
    plants = [draw_plant(base, rng) for _ in range(16)]
    contact = contact_of(base, plants, STEP)
    length = np.array([p["presliding"] for p in plants])
    work = np.zeros(16)
    for stretch in range(60):
        for dx in rng.normal(0.0, 0.01, (100, 16)) + rng.normal(0.0, 0.02 * (stretch % 3), 16):
            contact.advance(dx * length)
            work += contact.force * dx * length
            assert np.all(work >= contact.stored_energy() - 1e-9)


# --- motion


@pytest.mark.parametrize("base", BASES)
def test_without_input_nothing_moves(base):
    run = simulate(lanes_with(np.zeros(2000), base=base))
    assert not run.true_position.any()
    assert not run.velocity.any()


def test_dry_contact_holds_up_to_its_limit():
    plant = draw_plant("coulomb", np.random.default_rng(5))
    for share, moves in ((0.999, False), (1.01, True)):
        run = simulate(lanes_with(np.full(500, share * plant["coulomb"]), plant=plant))
        assert run.true_position[-1, 0].any() == moves
        if not moves:
            np.testing.assert_allclose(run.friction, share * plant["coulomb"], rtol=1e-12)


def test_coasting_stops_as_the_closed_form_says():
    plant = draw_plant("coulomb", np.random.default_rng(8))
    J, F_c, F_v = plant["inertia"], plant["coulomb"], plant["viscous"]
    push, on = 3.0 * F_c, 0.06
    torque = np.zeros(1500)
    torque[:60] = push
    run = simulate(lanes_with(torque, plant=plant))
    rate, t = F_v / J, np.arange(1500) * 1e-3
    top = (push - F_c) / F_v * -math.expm1(-rate * on)
    coasting = (top + F_c / F_v) * np.exp(-rate * (t - on)) - F_c / F_v
    expected = np.where(
        t <= on, (push - F_c) / F_v * -np.expm1(-rate * t), np.maximum(coasting, 0.0)
    )
    np.testing.assert_allclose(run.velocity[:, 0], expected, atol=2e-5 * top)
    # It stops inside a step, whose rest is what the position may be wrong by.
    stop = math.log1p(top * F_v / F_c) / rate
    distance = (push - F_c) / F_v * (on + math.expm1(-rate * on) / rate)
    distance += (top + F_c / F_v) * -math.expm1(-rate * stop) / rate - F_c / F_v * stop
    assert run.true_position[-1, 0] == pytest.approx(distance, rel=1e-6)
    assert run.velocity[-1, 0] == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("base", BASES)
def test_half_the_step_leads_to_the_same_recording(base):
    """One count of a sensor with 2^18 counts, also in free flight, which forgets nothing."""
    runs = [
        make_session(21, base=base, roles=("train",), seconds=6 * 1.5, rate=rate, counts_per_rev=0)
        for rate in (1e4, 2e4)
    ]
    for one, two in zip(runs[0].recordings, runs[1].recordings, strict=True):
        difference = np.abs(one.position_rad - two.position_rad).max()
        assert difference < COUNT, one.kind


# --- effects


def identity_batch(base, name, form, size=0.02):
    """One step in a sample, so that every step is in the log; exact sensor."""
    spec = Spec(
        31,
        base,
        hidden=((f"{name}:{form}", size),),
        roles=("train",),
        seconds=6 * 1.5,
        rate=1e3,
        counts_per_rev=0,
    )
    return lanes_of([Draft(spec)])


# The encoder's hidden torque belongs to the motion that is read, see below.
@pytest.mark.parametrize("base", ["maxwell_slip", "hsieh_pan"])
@pytest.mark.parametrize(("name", "form"), [f for f in FORMS if f[0] != "encoder_eccentricity"])
def test_hidden_torque_is_what_the_base_plant_lacks(name, form, base):
    """J x'' = u + noise - F_base(x) + hidden along the same motion, to round-off."""
    batch = identity_batch(base, name, form)
    run = simulate(batch)
    h, J = 1e-3, np.array([p["inertia"] for p in batch.plants])
    v, x = run.velocity, run.true_position
    contact, last = contact_of(base, batch.plants, h), x[0].copy()
    friction = np.empty_like(x[:-1])
    for k in range(len(friction)):
        middle = x[k] + 0.5 * h * v[k]
        contact.advance(middle - last)
        last = middle
        friction[k] = contact.force + contact.damping * 0.5 * (v[k] + v[k + 1])
    acting = run.input + batch.noise + (0.0 if batch.load is None else batch.load)
    needed = J * np.diff(v, axis=0) / h + friction - acting[:-1]
    np.testing.assert_allclose(run.hidden[0, :-1], needed, rtol=0, atol=1e-8)
    assert run.hidden.any()


def test_eccentric_encoder_hides_inertia_and_friction():
    batch = identity_batch("maxwell_slip", "encoder_eccentricity", "library", size=0.01)
    batch.substeps = 10
    run = simulate(batch)
    J = np.array([p["inertia"] for p in batch.plants])
    lane = KINDS.index("tracking")
    rate = np.diff(run.position[:, lane], 2) / 1e-6
    true_rate = np.diff(run.true_position[:, lane], 2) / 1e-6
    inertial = J[lane] * (rate - true_rate)
    hidden = 0.5 * (run.hidden[0, 1:-1, lane] + run.hidden[0, :-2, lane])
    fast = np.abs(run.velocity[1:-1, lane]) > 1.0  # friction is the same on both positions
    viscous = (
        batch.plants[0]["viscous"]
        * (np.gradient(run.position[:, lane]) - np.gradient(run.true_position[:, lane]))[1:-1]
    )
    error = (hidden - inertial - viscous / 1e-3)[fast]
    assert np.sqrt(np.mean(error**2)) < 0.05 * np.sqrt(np.mean(hidden[fast] ** 2))


@pytest.mark.parametrize("base", BASES)
def test_effect_without_amplitude_changes_no_bit(base):
    names = [n for n, kind in EFFECTS.items() if base in kind.bases]
    options = {"base": base, "seconds": 6 * 0.25, "roles": ("train",)}
    channels = [{EFFECTS[n].channel} - {None} for n in names]
    plain = make_sessions([options | {"seed": 3, "channels": c} for c in channels])
    named = make_sessions([options | {"seed": 3, "hidden": [(n, 0.0)]} for n in names])
    for name, one, two in zip(names, plain, named, strict=True):
        for a, b in zip(one.recordings, two.recordings, strict=True):
            if name == "input_delay" and two.effects[0].shape["sign"] < 0.0:
                continue  # its controller computes ahead
            assert a.torque_nm.tobytes() == b.torque_nm.tobytes(), (name, a.kind)
            assert a.position_rad.tobytes() == b.position_rad.tobytes(), (name, a.kind)
            # The shadow contact of a sensor follows a sum of differences.
            assert np.abs(b.truth["hidden"]).max() < 1e-10, (name, a.kind)


@pytest.mark.parametrize("late", [0.37e-3, 1.234e-3, 2e-3, -0.62e-3])
def test_delay_moves_the_torque_by_exactly_its_time(late):
    """A body without friction: its velocity is the integral of what acted."""
    plant = draw_plant("coulomb", np.random.default_rng(9)) | {"coulomb": 1e-15, "viscous": 0.0}
    torque = np.random.default_rng(1).normal(size=200)
    group = EffectGroup(
        EFFECTS["input_delay"],
        0,
        np.array([0]),
        np.array([abs(late)]),
        {"sign": np.array([math.copysign(1.0, late)])},
    )
    prompt = simulate(lanes_with(torque, plant=plant)).velocity[:, 0]
    delayed = simulate(lanes_with(torque, plant=plant, groups=[group])).velocity[:, 0]
    t = np.arange(200) * 1e-3
    inside = (t - late >= 0.0) & (t - late <= t[-1])
    begin = np.interp(max(-late, 0.0), t, prompt)  # what an early input did before the start
    expected = np.interp(t - late, t, prompt) - begin
    np.testing.assert_allclose(delayed[inside], expected[inside], atol=1e-10)


# --- sessions


def sizes(specs):
    """Effects of sessions of one effect each, at the amplitude that was found for them."""
    for session in make_sessions(specs):
        (effect,) = session.effects
        hidden = np.concatenate([r.truth["hidden"] for r in session.recordings])
        rms = np.sqrt(np.mean(hidden**2)) / session.plant["coulomb"]
        assert effect.raw == pytest.approx(rms, rel=1e-9)
        yield session, effect


@pytest.mark.slow
@pytest.mark.parametrize("machine", [40, 70, 100])
def test_sizes_are_reached_or_stated(machine):
    """A short recording may keep one out of reach: no rest to relax in, a patch never passed."""
    short = {"roles": ("train",), "seconds": 6 * 0.6, "rate": 5e3}
    quick = {"run_in": {"distance": 5.0}, "warm_up": {"time": 5.0}}
    # The seed is of the form alone, so that a new effect does not give others another machine.
    specs = [
        {"seed": machine + zlib.crc32(form.encode()), "hidden": [(form, 0.012, quick.get(name))]}
        | short
        for name, form in ((name, f"{name}:{form}") for name, form in FORMS)
    ]
    out_of_reach = 0
    for session, effect in sizes(specs):
        if effect.reached == pytest.approx(0.012, rel=0.05):
            continue
        kind = EFFECTS[effect.name]
        bound = min(LARGEST_FACTOR * kind.usual(session.plant) * 1.2, kind.largest)
        at_bound = effect.amplitude == pytest.approx(bound) and effect.reached < 0.012
        never_passed = effect.name == "stick_patch" and effect.reached == 0.0
        assert at_bound or never_passed, f"{effect.name} {session.spec.seed} {effect.reached}"
        out_of_reach += 1
    assert out_of_reach <= 0.1 * len(FORMS)


@pytest.mark.slow
@pytest.mark.parametrize("base", ["hsieh_pan", "coulomb"])
def test_sizes_are_reached_on_other_bases(base):
    short = {"base": base, "roles": ("train",), "seconds": 6 * 0.6, "rate": 5e3}
    names = ("stribeck", "viscous_quadratic", "cogging", "dwell_strengthening")
    specs = [{"seed": 90, "hidden": [(name, 0.02)]} | short for name in names]
    for _, effect in sizes(specs):
        assert effect.reached == pytest.approx(0.02, rel=0.05), effect.name


def test_two_effects_have_sizes_of_their_own():
    session = make_session(
        50, hidden=[("cogging", 0.01), ("torque_bias", 0.02)], seconds=18.0, lead_in=0.2
    )
    assert [e.reached for e in session.effects] == pytest.approx([0.01, 0.02], rel=0.03)
    for r in session.recordings:
        assert r.truth["parts"].shape == (2, r.time_s.size)
        np.testing.assert_allclose(r.truth["parts"].sum(axis=0), r.truth["hidden"])


def test_seeds_repeat_and_neighbours_do_not_matter():
    spec = {"seed": 60, "hidden": [("stribeck", 0.01)], "seconds": 9.0}
    alone = make_session(**spec)
    _, among, _ = make_sessions([{"seed": 61, "seconds": 9.0}, spec, spec | {"seed": 62}])
    other = make_session(63, seconds=9.0)
    assert len({r.start_s for r in alone.recordings}) == 18
    for one, two, three in zip(alone.recordings, among.recordings, other.recordings, strict=True):
        np.testing.assert_allclose(one.position_rad, two.position_rad, rtol=0, atol=1e-9)
        np.testing.assert_allclose(one.torque_nm, two.torque_nm, rtol=0, atol=1e-7)
        assert not np.array_equal(one.torque_nm, three.torque_nm)
    again = make_session(**spec)
    assert alone.recordings[0].torque_nm.tobytes() == again.recordings[0].torque_nm.tobytes()


def test_default_session_is_what_one_would_record():
    session = make_session(70, roles=("train",))
    assert {r.kind for r in session.recordings} == set(KINDS)
    by_kind = {r.kind: r for r in session.recordings}
    assert np.ptp(by_kind["tracking"].position_rad) > 4.0 * np.pi
    assert 6.0 < np.abs(by_kind["tracking"].truth["velocity"]).max() < 13.0
    small = by_kind["presliding"]
    assert np.abs(small.torque_nm).max() < 0.95 * session.plant["coulomb"]
    assert np.ptp(small.position_rad) < 6.0 * session.plant["presliding"]
    assert np.abs(by_kind["dwell"].torque_nm).max() > 1.2 * session.plant["coulomb"]
    for r in session.recordings:
        assert r.time_s.size == 8667
        assert (r.reference_rad is None) == (r.kind in ("dwell", "pulses", "presliding"))
        assert np.abs(r.position_rad - r.truth["position"]).max() <= 0.5001 * COUNT


def test_files_say_what_was_recorded(tmp_path):
    session = make_session(80, hidden=[("torque_bias", 0.01)], seconds=9.0)
    session.write(tmp_path, truth=True)
    described = tomllib.loads((tmp_path / "session.toml").read_text())
    plant = tomllib.loads((tmp_path / described["plant"]).read_text())
    assert plant["friction"] == {"law": "maxwell_slip"}
    assert plant["drive"] == {"input": "torque_nm", "gain": 1.0}
    assert plant["sensor"]["counts_per_rev"] == 2**18
    assert len(described["recordings"]) == 18
    assert [r["start_s"] for r in described["recordings"]] == sorted(
        r["start_s"] for r in described["recordings"]
    )
    for entry, recording in zip(described["recordings"], session.recordings, strict=True):
        assert (entry["role"], entry["kind"]) == (recording.role, recording.kind)
        with open(tmp_path / entry["file"], newline="") as file:
            rows = list(csv.DictReader(file))
        assert ("reference_rad" in rows[0]) == (recording.reference_rad is not None)
        read = np.array([float(row["position_rad"]) for row in rows])
        np.testing.assert_allclose(read, recording.position_rad, rtol=1e-11)


def test_names_that_do_not_exist_are_refused():
    with pytest.raises(ValueError, match="no effect is called 'stribek'"):
        make_session(1, hidden=[("stribek", 0.01)])
    with pytest.raises(ValueError, match="has the forms library"):
        make_session(1, hidden=[("torque_bias:foreign", 0.01)])
