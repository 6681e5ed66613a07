"""Exact derivatives by parameters against differences of whole simulations."""

import numpy as np
import pytest

import stiction as st
from stiction.recording.motion import Kernel

from .rigs import CONTACTS, INERTIA, drawn_rig, motor

# Where both perturbed runs take the same branches, as a share of the derivative's own range.
SAME_BRANCHES = 1e-6
# Across break-away, averaged over the break-away step: what the chord itself is good for.
ACROSS_BREAKAWAY = 0.01
DT = 1e-4
EFFECTS = {
    "cogging": {"cosine": 0.03, "sine": -0.02, "order": 40.0},
    "stribeck": {"excess": 0.2, "velocity": 0.05, "exponent": 1.7},
    "torque_bias": {"bias": 0.04},
}
# Of two runs of a thousand steps, as a share of the motion.
ROUND_OFF = 2e-15
# Signatures of effects that act at once are put together from levels and differences.
SCREENED = 1e-9
# A share of each parameter for the central difference, small enough for branches to agree.
STEP = 1e-5


def changed(machine, path, value):
    """The same motor with one parameter changed; paths are those of `parameters`."""
    group, *names = path.split(".")
    law, keywords = machine.friction_settings()
    settings = machine.settings()
    if group == "friction":
        keywords[names[0]] = value
    elif group == "effects":
        settings["effects"][names[0]][names[1]] = value
    else:
        name = {"gain": "torque_constant", "gravity_zero_rad": "gravity_zero"}.get(
            names[0], names[0].removesuffix("_n")
        )
        settings[name] = value
    return st.Motor(friction=st.FrictionModel(law, **keywords), **settings)


def followed(machine, current, dt):
    """Position and velocity after every sample, and the branches taken by then."""
    rows, branches = [], []
    for u in current.tolist():
        rows.append(machine.step(u, dt))
        branches.append(tuple(machine.statistics.values()))
    return np.array(rows).T, branches


def central_difference(machine, path, current, dt, relative):
    """([∂position, ∂velocity], whether both runs took the same branches in the same samples)."""
    value = machine.parameters[path]
    step = relative * abs(value)
    (high, taken), (low, also) = (
        followed(changed(machine, path, value + sign * step), current, dt) for sign in (1.0, -1.0)
    )
    return (high - low) / (2.0 * step), taken == also


def fourth_order_difference(machine, path, current, dt, relative):
    """The same with the error of second order taken out by a second, wider difference."""
    near, same = central_difference(machine, path, current, dt, relative)
    wide, also = central_difference(machine, path, current, dt, 2.0 * relative)
    return (4.0 * near - wide) / 3.0, same and also


def smooth_current(force, n, seed):
    """Swings within `force`, smooth so that few turning points lie near a step's edge."""
    rng = np.random.default_rng(seed)
    time = np.arange(n) * DT
    waves = [np.sin(2.0 * np.pi * rng.uniform(2.0, 15.0) * time + k) for k in range(3)]
    return force * np.sum(waves, axis=0) / 3.0


def worst(machine, current, dt=DT, relative=STEP, skip=()):
    """By parameter the greatest share by which derivative and difference disagree; the others."""
    # A parameter at 0 is mostly at its bound: those have a test of their own below.
    paths = [p for p, v in machine.parameters.items() if np.isfinite(v) and v and p not in skip]
    exact_x, exact_v = machine.sensitivity(current, dt, paths)
    shares, left_out = {}, []
    run = machine.copy().simulate(current, dt)
    for k, path in enumerate(paths):
        chord, same = fourth_order_difference(machine, path, current, dt, relative)
        if not same:
            left_out.append(path)
            continue
        step = relative * abs(machine.parameters[path])
        worst_of_both = 0.0
        for exact, difference, moved in zip(
            (exact_x[k], exact_v[k]), chord, (run.position, run.velocity), strict=True
        ):
            scale = np.abs(exact).max()
            # Round-off of two runs over the step; where it hides the derivative, nothing is said.
            if ROUND_OFF * np.abs(moved).max() / step > SAME_BRANCHES * scale:
                worst_of_both = np.nan
                break
            worst_of_both = max(worst_of_both, np.abs(exact - difference).max() / scale)
        if np.isfinite(worst_of_both):
            shares[path] = worst_of_both
        else:
            left_out.append(path)
    return shares, left_out


@pytest.mark.parametrize("seed", range(4))
def test_derivatives_of_a_sticking_machine_equal_differences(seed):
    inertia, parameters, force = drawn_rig(seed)
    machine = st.Motor(
        inertia=inertia,
        friction=st.FrictionModel("hsieh_pan", **parameters),
        gravity_amplitude=0.02 * force,
        gravity_zero=0.3,
        weight=0.01 * force,
        effects={"torque_bias": {"bias": 0.03 * force}},
    )
    shares, left_out = worst(machine, smooth_current(force, 1500, seed))
    assert len(shares) > 9, left_out
    assert max(shares.values()) < SAME_BRANCHES, shares


@pytest.mark.parametrize("kind", [k for k in CONTACTS if k not in ("sticking", "elastic")])
def test_derivatives_across_break_away_and_stick_equal_differences(kind):
    machine = motor(kind, effects=EFFECTS, gravity_amplitude=0.05, gravity_zero=0.1, weight=0.01)
    current = smooth_current(1.8, 1500, 3)
    # Where F_c and F_s are equal neither can pass the other.
    equal = machine.parameters["friction.coulomb"] == machine.parameters["friction.breakaway"]
    skip = ("friction.coulomb", "friction.breakaway") if equal else ()
    # A slide goes far: at the narrow width round-off shows, at the wide one the curvature. The
    # derivative must agree with one of them.
    narrow, left_out = worst(machine, current, skip=skip)
    wide, _ = worst(machine, current, relative=4.0 * STEP, skip=skip)
    shares = {path: min(share, wide.get(path, share)) for path, share in narrow.items()}
    assert machine.copy().simulate(current, DT).statistics["breakaways"] >= 1
    assert len(shares) > 9, left_out
    assert max(shares.values()) < SAME_BRANCHES, shares


def test_derivatives_start_at_the_present_state_and_leave_it():
    machine = motor("hook")
    current = smooth_current(1.2, 1200, 1)
    machine.simulate(current[:500], DT)
    kept = machine.copy()
    position, velocity = machine.sensitivity(current[500:], DT, ["friction.viscous"])
    assert machine == kept
    assert position.shape == velocity.shape == (1, 700)
    chord = []
    for sign in (1.0, -1.0):
        other = changed(machine, "friction.viscous", 0.05 + sign * 1e-7)
        other.state = kept.state
        chord.append(other.simulate(current[500:], DT).position)
    difference = (chord[0] - chord[1]) / 2e-7
    scale = np.abs(position).max()
    assert np.abs(position[0] - difference).max() < 100.0 * SAME_BRANCHES * scale


def test_many_parameters_are_differentiated_as_one_at_a_time():
    machine = motor("hook", effects=EFFECTS)
    paths = [p for p, v in machine.parameters.items() if np.isfinite(v)]
    assert len(paths) > 16
    current = smooth_current(1.2, 500, 1)
    together = machine.sensitivity(current, DT, paths)
    for k, path in enumerate(paths):
        alone = machine.sensitivity(current, DT, [path])
        assert np.array_equal(alone[0][0], together[0][k]), path
        assert np.array_equal(alone[1][0], together[1][k]), path
    empty = machine.sensitivity(current, DT, [])
    assert empty[0].shape[0] == 0


@pytest.mark.parametrize("kind", CONTACTS)
def test_derivatives_are_finite_at_rest_and_at_every_neutral_point(kind):
    machine = motor(
        kind,
        effects={"cogging": {}, "stribeck": {}, "torque_bias": {}},
    )
    paths = [p for p, v in machine.parameters.items() if np.isfinite(v)]
    for current in (np.zeros(50), np.repeat([0.0, 0.4, 0.0, -0.7, 0.0], 200)):
        for values in machine.sensitivity(current, DT, paths):
            assert np.isfinite(values).all()


ONE_SIDED = {
    "hardening_coefficient": 1e-9,
    "creep_rate": 1e-6,
    "damping": 1e-7,
    "viscous": 1e-7,
}


@pytest.mark.parametrize("name", ONE_SIDED)
def test_derivative_at_a_neutral_point_is_that_of_the_first_step_away_from_it(name):
    # What a score test asks for: would this part help, seen from where it is switched off?
    hook = CONTACTS["hook"][1] | {name: 0.0}
    machine = st.Motor(inertia=INERTIA, friction=st.FrictionModel("hsieh_pan", **hook))
    current = np.repeat([0.3, 0.8], 500)
    exact = machine.sensitivity(current, DT, [f"friction.{name}"])[0][0]
    step = ONE_SIDED[name]
    near, wide = (
        changed(machine, f"friction.{name}", k * step).simulate(current, DT).position
        for k in (1.0, 2.0)
    )
    here = machine.simulate(current, DT).position
    chord = (4.0 * near - wide - 3.0 * here) / (2.0 * step)
    assert np.abs(chord).max() > 0.0
    assert np.abs(exact - chord).max() < 1e-3 * np.abs(chord).max()


@pytest.mark.long
@pytest.mark.parametrize("kind", ["hook", "rated", "kept", "stribeck"])
@pytest.mark.parametrize("dt", [1e-4, 2e-5])
@pytest.mark.parametrize("integrator", ["fast", "reference"])
def test_derivative_by_breakaway_equals_the_chord_averaged_over_the_break_away_step(
    kind, dt, integrator
):
    law, keywords = CONTACTS[kind]
    # A ramp breaks away once; the body slides on against its friction and the ramp's end.
    rate, level = 4.0, 0.5
    n = round(0.16 / dt)
    current = np.minimum(rate * np.arange(n) * dt, 0.55)
    path = "friction.breakaway"

    def final(value):
        friction = st.FrictionModel(law, **keywords | {"breakaway": value})
        machine = st.Motor(inertia=INERTIA, friction=friction, integrator=integrator)
        slope = machine.sensitivity(current, dt, [path])[0][0, -1]
        run = machine.simulate(current, dt, outputs=("position",))
        return run.position[-1], slope, machine.statistics["breakaways"]

    # Break-away levels whose moments sweep two steps of the ramp, evenly.
    values = level + rate * dt * (np.arange(16) + 0.5) / 8.0
    slopes, chords = [], []
    for value in values:
        high, _, one = final(value * 1.001)
        low, _, other = final(value * 0.999)
        _, slope, breaks = final(value)
        assert breaks == one == other == 1
        chords.append((high - low) / (0.002 * value))
        slopes.append(slope)
    assert np.mean(slopes) == pytest.approx(np.mean(chords), rel=ACROSS_BREAKAWAY)
    # Not by chance: no single value is far off either.
    assert np.abs(np.array(slopes) / np.mean(chords) - 1.0).max() < 5.0 * ACROSS_BREAKAWAY


@pytest.mark.parametrize("kind", CONTACTS)
def test_efforts_along_a_motion_are_differentiated_by_every_parameter(kind):
    machine = motor(kind, effects=EFFECTS, gravity_amplitude=0.05, gravity_zero=0.1)
    time = np.arange(601) * 1e-3
    path = 0.02 * np.sin(9.0 * time) + 1e-3 * np.sin(41.0 * time)
    current = np.cos(7.0 * time[:-1])
    # Along a given motion the inertia has no part.
    paths = [
        p for p, v in machine.parameters.items() if np.isfinite(v) and v and p != "body.inertia"
    ]
    needed, driven, _ = machine.follow_sensitivity(st.Motion(path, current, 1e-3), paths)
    assert needed.shape == driven.shape == (len(paths), 600)

    def along(value, name):
        other = changed(machine, name, value)
        drive, ambient, friction, _ = other.follow(st.Motion(path, current, 1e-3))
        return np.array([friction - ambient, drive])

    compared = 0
    for k, name in enumerate(paths):
        value = machine.parameters[name]
        step = 1e-5 * abs(value)
        try:
            near, wide = (
                (along(value + w * step, name) - along(value - w * step, name)) / (2.0 * w * step)
                for w in (1.0, 2.0)
            )
        except st.InputError:
            continue
        exact = np.array([needed[k], driven[k]])
        scale = np.abs(exact).max()
        # Samples in which a mode changes at another share of the sample have no difference.
        smooth = np.abs(near - wide) <= 1e-6 * scale
        assert np.mean(smooth) > 0.9, name
        assert np.abs(exact - near)[smooth].max() <= 1e-5 * max(scale, 1e-9), name
        compared += 1
    assert compared > 5


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("effects", [None, EFFECTS])
def test_rows_and_columns_are_efforts_and_derivatives_seen_through_the_kernel(held, effects):
    machine = motor("hook", effects=effects, gravity_amplitude=0.05)
    time = np.arange(601) * 1e-3
    path = 0.02 * np.sin(9.0 * time) + 1e-3 * np.sin(41.0 * time)
    current = np.cos(7.0 * time[:-1])
    paths = [p for p, v in machine.parameters.items() if np.isfinite(v) and v]
    kernel, inertia = Kernel(0.03, 1e-3), 0.007
    rows = st._native.RowKernel(kernel.weights, kernel.second, 5, inertia, held=held)

    def seen(derivatives):
        needed, driven, ahead = derivatives
        centred = 0.5 * (driven + np.column_stack([driven[:, 1:], driven[:, -1:]]))
        bent = np.array([kernel.second_derivative(each)[::5] for each in ahead])
        measured = centred if held else np.zeros_like(centred)
        return kernel.mean(measured - needed, every=5) - inertia * bent

    columns = machine.follow_columns(st.Motion(path, current, 1e-3), paths, rows)
    expected = seen(machine.follow_sensitivity(st.Motion(path, current, 1e-3), paths))
    assert columns.shape == expected.shape
    assert np.allclose(columns, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
    drive, ambient, friction, ahead = machine.copy().follow(st.Motion(path, current, 1e-3))
    (expected,) = seen((np.array([friction - ambient]), np.array([drive]), np.array([ahead])))
    found = machine.copy().follow_rows(st.Motion(path, current, 1e-3), rows)
    assert np.allclose(found, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
    columns = machine.signature_columns(st.Motion(path, current, 1e-3), CANDIDATES, rows)
    expected = seen(machine.signatures(st.Motion(path, current, 1e-3), CANDIDATES))
    assert np.allclose(columns, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
    # Of some rows the same numbers, wherever a stretch ends.
    kept = np.flatnonzero(np.arange(columns.shape[1]) % 7 < 3)
    motion = st.Motion(path, current, 1e-3)
    some = machine.signature_columns(motion, CANDIDATES, rows, kept=kept.tolist())
    assert np.array_equal(some, columns[:, kept])


CANDIDATES = [
    ("stribeck", {"velocity": 0.02}),
    ("cogging", {"order": 7.0}),
    ("stribeck", {"velocity": 0.3, "exponent": 1.0}),
    ("input_delay", {}),
    ("torque_bias", {}),
    ("cogging", {}),
    ("direction_asymmetry", {}),
    ("position_dependent_friction", {"order": 2.0}),
    ("torque_constant_ripple", {"order": 3.0}),
    ("viscous_quadratic", {}),
    ("encoder_eccentricity", {}),
]


def signature_alone(machine, name, shape, gain, path, current, load):
    """Signature of one gain from a motor that has the effect, at the gain 0."""
    law, keywords = machine.friction_settings()
    settings = machine.settings()
    # An effect of the same name would hide the candidate.
    settings["effects"] = {k: v for k, v in settings["effects"].items() if k != name}
    settings["effects"][name] = shape
    other = st.Motor(friction=st.FrictionModel(law, **keywords), **settings)
    parameter = f"effects.{name}.{gain}"
    needed, driven, _ = other.follow_sensitivity(
        st.Motion(path, current, 1e-3, load=load), [parameter]
    )
    return needed[0], driven[0]


@pytest.mark.parametrize("kind", CONTACTS)
def test_signatures_are_the_derivatives_by_each_gain_alone(kind):
    machine = motor(kind, effects={"viscous_quadratic": {}}, gravity_amplitude=0.05)
    time = np.arange(501) * 1e-3
    path = 0.02 * np.sin(9.0 * time) + 1e-3 * np.sin(41.0 * time)
    current, load = np.cos(7.0 * time[:-1]), 0.1 * np.sin(3.0 * time[:-1])
    kept = machine.copy()
    needed, driven, _ = machine.signatures(st.Motion(path, current, 1e-3, load=load), CANDIDATES)
    gains = {effect.name: effect.gains for effect in st.effects()}
    rows = [(name, shape, gain) for name, shape in CANDIDATES for gain in gains[name]]
    assert machine == kept
    assert needed.shape == driven.shape == (len(rows), 500)
    for k, row in enumerate(rows):
        alone = signature_alone(machine, *row, path, current, load)
        slides_late = machine.friction_settings()[0] == "hsieh_pan"
        for found, exact in ((needed[k], alone[0]), (driven[k], alone[1])):
            miss = np.linalg.norm(found - exact)
            # A slide of hsieh_pan forgets its first force over a distance, so what a level was
            # before lasts a little; screening looks at each sample alone.
            assert miss <= (0.06 if slides_late else SCREENED) * np.linalg.norm(exact), row
    assert np.abs(needed).max() > 0.0
    assert np.abs(driven[[name == "input_delay" for name, *_ in rows]]).max() > 0.0


def test_signatures_stand_beside_an_effect_of_the_same_name():
    own = {"stribeck": {"excess": 0.3}, "input_delay": {"delay": 2.5e-3}}
    machine = motor("hook", effects=own)
    time = np.arange(501) * 1e-3
    path, current = 0.02 * np.sin(9.0 * time), np.cos(7.0 * time[:-1])
    needed, driven, _ = machine.signatures(
        st.Motion(path, current, 1e-3), [("stribeck", {}), ("input_delay", {})]
    )
    paths = ["effects.stribeck.excess", "effects.input_delay.delay"]
    # Both effects are linear in their gains, two delays add up: the derivative is that of the own.
    also_needed, also_driven, _ = machine.follow_sensitivity(st.Motion(path, current, 1e-3), paths)
    assert np.linalg.norm(needed - also_needed) <= 0.01 * np.linalg.norm(also_needed)
    assert np.allclose(driven, also_driven, rtol=0, atol=SCREENED * np.abs(also_driven).max())


def test_signatures_are_the_same_for_any_number_of_threads():
    machine = motor("hook")
    time = np.arange(801) * 1e-3
    path, current = 0.02 * np.sin(9.0 * time), np.cos(7.0 * time[:-1])
    candidates = [("cogging", {"order": float(k)}) for k in range(1, 30)]
    one = machine.signatures(st.Motion(path, current, 1e-3), candidates)
    for threads in (2, 5):
        other = machine.signatures(st.Motion(path, current, 1e-3), candidates, threads=threads)
        assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))
    assert machine.signatures(st.Motion(path, current, 1e-3), [])[0].shape == (0, 800)


def test_two_shapes_of_one_relaxation_are_seen_each_for_itself():
    """A contact relaxes in one way of a kind at a time: candidates must not shadow each other."""
    motor = st.Motor(inertia=0.0076, torque_constant=1.0, friction=st.FrictionModel("maxwell_slip"))
    position = 2e-4 * np.sin(5e-3 * np.arange(2001))
    shapes = [("creep_hardening", {"rate": 0.8}), ("creep_hardening", {"rate": 3.0})]
    shapes += [("relaxation", {"exponent": 1.0}), ("relaxation", {"exponent": 4.0})]
    shapes += [("backlash", {"gap": 1e-4}), ("backlash", {"gap": 1e-3})]

    def seen(candidates):
        return np.concatenate(
            motor.signatures(st.Motion(position, np.zeros(2000), 1e-3), candidates), axis=1
        )

    together = seen(shapes)
    for each, row in zip(shapes, together, strict=True):
        assert np.any(row != 0.0), each
        assert np.array_equal(row, seen([each])[0]), each
