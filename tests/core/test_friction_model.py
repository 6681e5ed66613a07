"""FrictionModel against its written contract."""

import copy
import pickle

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as hs

import stiction as st

from .rigs import CONTACTS, contact, pieces, same_state, wandering_velocity

DT = 1e-3
KINDS = list(CONTACTS)
SAMPLES = 600
# Round-off of a central difference whose force is of order 1 and whose step is 1e-6 of the speed.
SLOPE_TOLERANCE = 1e-6


def stepped(model, velocity, dt=DT, **channels):
    return np.array([model.step(float(v), dt, **channels) for v in velocity])


@pytest.fixture(params=KINDS)
def kind(request):
    return request.param


@pytest.mark.parametrize("seed", range(4))
def test_simulate_equals_looped_step_to_the_bit(kind, seed):
    velocity = wandering_velocity(seed, SAMPLES)
    whole, looped = contact(kind), contact(kind)
    assert np.array_equal(whole.simulate(velocity, DT), stepped(looped, velocity))
    assert same_state(whole.state, looped.state)
    assert whole == looped


def test_simulate_in_chunks_equals_one_call_to_the_bit(kind):
    velocity = wandering_velocity(11, SAMPLES)
    whole, chunked = contact(kind), contact(kind)
    parts = [chunked.simulate(velocity[part], DT) for part in pieces(SAMPLES, 3)]
    assert np.array_equal(whole.simulate(velocity, DT), np.concatenate(parts))
    assert whole == chunked


def test_batch_rows_start_at_the_present_state_and_leave_it(kind):
    model = contact(kind)
    model.simulate(wandering_velocity(5, 150), DT)
    before, kept = model.state, model.copy()
    rows = np.stack([wandering_velocity(seed, 200) for seed in (1, 2, 3)])
    forces = model.simulate(rows, DT)
    assert forces.shape == rows.shape
    assert same_state(model.state, before)
    assert model == kept
    for row, force in zip(rows, forces, strict=True):
        assert np.array_equal(kept.copy().simulate(row, DT), force)


def test_batch_of_one_row_leaves_the_object_as_it_was(kind):
    model = contact(kind)
    before = model.state
    model.simulate(wandering_velocity(1, 50)[None, :], DT)
    assert same_state(model.state, before)


def by_state(model):
    other = st.FrictionModel(model.law, **model.parameters, **model.options)
    other.state = model.state
    return other


DUPLICATES = {
    "copy()": lambda model: model.copy(),
    "copy.copy": copy.copy,
    "copy.deepcopy": copy.deepcopy,
    "pickle": lambda model: pickle.loads(pickle.dumps(model)),
    "oldest pickle": lambda model: pickle.loads(pickle.dumps(model, protocol=2)),
    "state": by_state,
}


@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES.keys())
@pytest.mark.parametrize("cut", [0, 1, 37, 200, 399])
def test_a_duplicate_continues_to_the_bit(kind, duplicate, cut):
    velocity = wandering_velocity(21, 400)
    model = contact(kind)
    stepped(model, velocity[:cut])
    other = duplicate(model)
    assert other is not model
    assert other == model
    assert same_state(other.state, model.state)
    continued = model.simulate(velocity[cut:], DT)
    assert np.array_equal(continued, other.simulate(velocity[cut:], DT))
    assert other == model


@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES.keys())
@pytest.mark.parametrize("kind", ["hook", "rated", "same", "spring damper", "kept"])
def test_a_duplicate_made_while_slipping_continues_to_the_bit(kind, duplicate):
    model = contact(kind)
    model.simulate(np.full(30, 0.05), DT)
    assert model.state["mode"] == 1.0
    other = duplicate(model)
    onward = np.concatenate((np.full(9, 0.02), np.full(20, -0.05), np.full(40, -1e-3)))
    assert np.array_equal(model.simulate(onward, DT), other.simulate(onward, DT))
    assert model == other


@pytest.mark.parametrize("duplicate", DUPLICATES.values(), ids=DUPLICATES.keys())
@pytest.mark.parametrize("kind", ["sticking", "elastic", "same", "spring damper"])
def test_a_duplicate_made_after_many_reversals_continues_to_the_bit(kind, duplicate):
    # A decaying swing nests ever smaller loops: more than the room prepared at the start.
    swing = 2e-3 * np.exp(-np.arange(1500) / 400.0) * np.where(np.arange(1500) % 2, -1.0, 1.0)
    model = contact(kind)
    model.simulate(swing, DT)
    assert len(model.state["reverse_points"]) > 1000
    other = duplicate(model)
    onward = wandering_velocity(4, 300) / 100.0
    assert np.array_equal(model.simulate(onward, DT), other.simulate(onward, DT))
    assert model == other


def test_state_given_back_rewinds_the_model(kind):
    model = contact(kind)
    model.simulate(wandering_velocity(2, 100), DT)
    kept = model.state
    first = model.simulate(wandering_velocity(3, 100), DT)
    model.state = kept
    assert np.array_equal(model.simulate(wandering_velocity(3, 100), DT), first)


def test_the_state_read_is_the_callers_own(kind):
    model = contact(kind)
    model.simulate(wandering_velocity(2, 100), DT)
    taken, kept = model.state, model.copy()
    for name, value in taken.items():
        if isinstance(value, np.ndarray):
            value[...] = 7.0
        taken[name] = 7.0
    assert model == kept


def test_trial_changes_nothing_and_commit_equals_step_to_the_bit(kind):
    tried, plain = contact(kind), contact(kind)
    passed = 0
    for v in wandering_velocity(31, SAMPLES).tolist():
        before = tried.state
        tried.trial(-2.0 * v, DT)  # a host's first guess, never accepted
        force, slope = tried.trial(v, DT)
        assert same_state(tried.state, before)
        assert np.isfinite(slope)
        tried.commit()
        assert force == plain.step(v, DT)
        assert same_state(tried.state, plain.state)
        passed += before["mode"] != plain.state["mode"]
    if "breakaways" in plain.state and CONTACTS[kind][1].get("breakaway"):
        assert passed > 10


def test_trial_never_accepted_leaves_the_model_equal(kind):
    model = contact(kind)
    model.simulate(wandering_velocity(8, 100), DT)
    kept = model.copy()
    for v in (0.1, -0.1, 0.0, 30.0, -1e-9):
        model.trial(v, DT)
    assert model == kept
    onward = wandering_velocity(9, 100)
    assert np.array_equal(model.simulate(onward, DT), kept.simulate(onward, DT))


def test_commit_without_a_fresh_trial_is_refused(kind):
    model = contact(kind)
    with pytest.raises(st.InputError, match="trial"):
        model.commit()
    for spoil in (
        lambda: model.commit(),
        lambda: model.step(0.01, DT),
        lambda: model.simulate([0.01], DT),
        lambda: model.reset(),
        lambda: setattr(model, "state", model.state),
    ):
        model.trial(0.1, DT)
        spoil()
        with pytest.raises(st.InputError, match="trial"):
            model.commit()


def test_a_batch_leaves_the_trial_standing_or_spoils_it_but_commits_nothing_else(kind):
    model, plain = contact(kind), contact(kind)
    model.trial(0.01, DT)
    model.simulate(np.full((2, 5), -0.3), DT)
    try:
        model.commit()
    except st.InputError:
        return
    plain.step(0.01, DT)
    assert model == plain


# Velocities from the pre-sliding of one step to a slide far past break-away.
SPEEDS = [1e-6, 1e-4, 3e-3, 0.03, 0.2, 0.6, -1e-6, -1e-4, -3e-3, -0.05, -0.4]


def worst_slope_error(model, speeds, dt):
    worst = 0.0
    for v in speeds:
        step = 1e-6 * abs(v)
        chord = (model.trial(v + step, dt)[0] - model.trial(v - step, dt)[0]) / (2.0 * step)
        force, slope = model.trial(v, dt)
        # Round-off of the force over the step, beside the error of second order.
        blur = 1e-15 * max(abs(force), 0.1) / step
        worst = max(worst, (abs(slope - chord) - 4.0 * blur) / (abs(chord) + 1e-3))
    return worst


@pytest.mark.parametrize("dt", [1e-5, 1e-3, 0.05])
@pytest.mark.parametrize("start", ["rest", "loaded", "slipping", "slipping back"])
def test_slope_is_the_central_difference_of_the_trial_force(kind, start, dt):
    model = contact(kind)
    motion = {
        "rest": [],
        "loaded": np.full(30, 3e-3),
        "slipping": np.full(40, 0.07),
        "slipping back": np.concatenate((np.full(40, 0.07), np.full(25, -0.11))),
    }[start]
    if len(motion):
        model.simulate(motion, DT)
    assert worst_slope_error(model, SPEEDS, dt) < SLOPE_TOLERANCE


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    kind=hs.sampled_from(KINDS),
    seed=hs.integers(0, 10_000),
    cut=hs.integers(0, 120),
    speed=hs.floats(-4.0, 0.0),
    sign=hs.sampled_from([-1.0, 1.0]),
    dt=hs.sampled_from([1e-4, 1e-3, 1e-2]),
)
def test_slope_holds_from_any_state(kind, seed, cut, speed, sign, dt):
    model = contact(kind)
    if cut:
        model.simulate(wandering_velocity(seed, cut), DT)
    assert worst_slope_error(model, [sign * 10.0**speed], dt) < SLOPE_TOLERANCE


def test_slope_is_exact_on_both_sides_of_break_away():
    model = contact("hook")
    model.simulate(np.full(100, 1e-3), DT)
    speeds = np.linspace(1e-3, 0.4, 200)
    modes = []
    for v in speeds:
        model.trial(float(v), DT)
        other = model.copy()
        other.commit()
        modes.append(other.state["mode"])
    assert {0.0, 1.0} <= set(modes)
    assert worst_slope_error(model, speeds.tolist(), DT) < SLOPE_TOLERANCE


@pytest.mark.parametrize("kind", ["coulomb", "stribeck"])
@pytest.mark.parametrize("effort", [0.0, 0.2, -0.2, 0.35, -3.0, 3.0])
def test_a_resting_contact_returns_the_effort_clipped_to_break_away(kind, effort):
    model = contact(kind)
    greatest = model.parameters["breakaway"]
    held = float(np.clip(effort, -greatest, greatest))
    assert model.step(0.0, DT, effort=effort) == held
    model.simulate(np.full(5, 0.2), DT)
    assert model.step(0.0, DT, effort=effort) == held
    assert model.trial(0.0, DT, effort=effort)[0] == held
    assert np.all(model.simulate(np.zeros(4), DT, effort=effort) == held)


def test_effort_and_load_may_be_scalars_or_shaped_like_velocity():
    effort = np.array([0.1, -0.2, 9.0, -9.0])
    model = contact("stribeck")
    want = [0.1, -0.2, 0.5, -0.5]
    zeros = np.zeros(4)
    assert model.simulate(zeros, DT, effort=effort).tolist() == want
    assert model.simulate(zeros, DT, effort=effort.tolist(), load=zeros).tolist() == want
    assert model.simulate(zeros, DT, effort=0.1, load=1.0, temperature=20.0).tolist() == [0.1] * 4
    batch = model.simulate(np.zeros((2, 4)), DT, effort=np.stack([effort, -effort]))
    assert batch.tolist() == [want, [-x for x in want]]
    one = model.simulate(np.zeros(1), DT, effort=np.array([0.1]), temperature=[20.0])
    assert one.tolist() == [0.1]


def test_channels_at_their_neutral_values_change_no_bit(kind):
    velocity = wandering_velocity(13, 200)
    plain, given_neutral = contact(kind), contact(kind)
    forces = plain.simulate(velocity, DT)
    neutral = given_neutral.simulate(velocity, DT, load=np.zeros(200), effort=0.0, temperature=None)
    assert np.array_equal(forces, neutral)
    looped = stepped(contact(kind), velocity, load=0.0, effort=0.0, temperature=None)
    assert np.array_equal(forces, looped)


ACCEPTED = {
    "list": lambda v: v.tolist(),
    "tuple": lambda v: tuple(v.tolist()),
    "every second of a longer array": lambda v: np.repeat(v, 2)[::2],
    "reversed view": lambda v: v[::-1].copy()[::-1],
    "column of a matrix": lambda v: np.stack([v, v], axis=1)[:, 0],
    "other byte order": lambda v: v.astype(">f8"),
    "read-only": lambda v: np.frombuffer(v.tobytes()),
    "objects": lambda v: v.astype(object),
}


@pytest.mark.parametrize("form", ACCEPTED.values(), ids=ACCEPTED.keys())
def test_input_of_any_form_is_converted(form):
    velocity = wandering_velocity(17, 100)
    want = contact("hook").simulate(velocity, DT)
    model = contact("hook")
    assert np.array_equal(model.simulate(form(velocity), DT), want)


def test_narrow_and_whole_numbers_are_converted():
    velocity = np.array([0.5, -0.25, 0.0, 1.0])
    want = contact("hook").simulate(velocity, DT)
    for dtype in (np.float32, np.float16):
        assert np.array_equal(contact("hook").simulate(velocity.astype(dtype), DT), want)
    whole = np.array([1, 0, -2])
    want = contact("hook").simulate(whole.astype(float), DT)
    assert np.array_equal(contact("hook").simulate(whole, DT), want)
    assert np.array_equal(contact("hook").simulate(whole.tolist(), DT), want)


def test_a_transposed_batch_is_read_by_its_rows():
    rows = np.stack([wandering_velocity(seed, 30) for seed in range(4)])
    want = contact("hook").simulate(rows, DT)
    assert np.array_equal(contact("hook").simulate(np.asfortranarray(rows), DT), want)


def test_input_arrays_are_left_as_they_were(kind):
    velocity = wandering_velocity(6, 100)
    kept = velocity.copy()
    result = contact(kind).simulate(velocity, DT)
    assert np.array_equal(velocity, kept)
    assert result.dtype == np.float64
    assert result.flags.c_contiguous
    assert not np.shares_memory(result, velocity)


def test_reset_is_a_new_model(kind):
    model = contact(kind)
    model.simulate(wandering_velocity(1, 200), DT)
    assert model != contact(kind)
    model.reset()
    assert model == contact(kind)
    assert same_state(model.state, contact(kind).state)


def test_repr_evaluates_to_an_equal_model(kind):
    model = contact(kind)
    again = eval(repr(model), {"FrictionModel": st.FrictionModel})
    assert again == model
    assert again.parameters == model.parameters
    assert again.options == model.options


def test_equality_looks_at_law_parameters_options_and_state(kind):
    model = contact(kind)
    assert model == contact(kind)
    assert (model != contact(kind)) is False
    assert model != "a word"
    assert model != None  # noqa: E711 -- the operator is what is tested
    others = [contact(other) for other in KINDS if other != kind]
    assert all(model != other for other in others)
    moved = contact(kind)
    moved.step(0.01, DT)
    assert moved != model
    with pytest.raises(TypeError):
        hash(model)
    with pytest.raises(TypeError):
        model < contact(kind)  # noqa: B015


def test_attributes_cannot_be_overwritten():
    model = contact("hook")
    for name in ("parameters", "options", "law", "anything"):
        with pytest.raises(AttributeError):
            setattr(model, name, 1.0)
    with pytest.raises(st.InputError, match="cannot be set in place"):
        model.parameters["breakaway"] = 3.0
    assert model.parameters["breakaway"] == 0.5


def test_defaults_are_ratios_of_what_is_stated():
    parameters = st.FrictionModel("hsieh_pan", initial_stiffness=1000.0, breakaway=2.0).parameters
    assert parameters["final_stiffness"] == pytest.approx(270.0, rel=1e-15)
    assert parameters["coulomb"] == pytest.approx(1.4, rel=1e-15)
    assert st.FrictionModel("hsieh_pan", coulomb=0.4).parameters["breakaway"] == 0.4
    assert st.FrictionModel("hsieh_pan").parameters["breakaway"] == np.inf
    assert st.FrictionModel("coulomb", coulomb=0.4).parameters["breakaway"] == 0.4


def test_a_step_is_split_without_trace_while_the_spring_alone_resists():
    # Without creep and damper the force is a function of the path, not of its samples.
    whole, halves = contact("elastic"), contact("elastic")
    damping = whole.parameters["damping"]
    velocity = wandering_velocity(3, 200) / 30.0
    one = whole.simulate(velocity, DT)
    two = halves.simulate(np.repeat(velocity, 2), DT / 2.0)[1::2]
    scale = np.ptp(one - damping * velocity)
    assert np.abs(one - two).max() < 1e-12 * scale


@pytest.mark.parametrize("dt", [1e-3, 0.1, 1.0])
def test_a_contact_all_but_at_rest_relaxes_like_one_at_rest(dt):
    # Creep takes the spring back faster than this motion loads it, so the spring unloads.
    forces = []
    for velocity in (0.0, 1e-15, -1e-15):
        model = contact("sticking")
        model.simulate(np.full(100, 1e-4), 1e-2)
        forces.append(model.step(velocity, dt))
    assert np.ptp(forces) < 1e-9 * forces[0]
