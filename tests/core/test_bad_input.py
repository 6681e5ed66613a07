"""What cannot be used is refused with a sentence, and its good twin is taken."""

import pickle

import numpy as np
import pytest

import stiction as st

from .refused_by_contacts import CONTACTS, DT, NAN, machine, model
from .refused_by_motors import MOTORS
from .rigs import contact, motor, same_state

REFUSED = CONTACTS | MOTORS


@pytest.mark.parametrize(("bad", "good", "words"), REFUSED.values(), ids=REFUSED.keys())
def test_bad_input_is_refused_in_words_and_its_good_twin_taken(bad, good, words):
    good()
    with pytest.raises(st.InputError) as caught:
        bad()
    sentence = str(caught.value)
    for word in words:
        assert word in sentence
    # What was given, what is allowed or what to do: one sentence, no traceback, no Rust.
    assert "\n" not in sentence
    assert "Number(" not in sentence
    assert "Pairs(" not in sentence
    assert isinstance(caught.value, ValueError)


WRONG_TYPES = {
    "law not a word": lambda: st.FrictionModel(3),
    "no law": lambda: st.FrictionModel(),
    "velocity a word": lambda: model().step("fast", DT),
    "velocity an array": lambda: model().step(np.zeros(2), DT),
    "no dt": lambda: model().step(0.1),
    "dt a list": lambda: model().simulate([0.1], [DT]),
    "load by position": lambda: model().step(0.1, DT, 0.3),
    "unknown keyword": lambda: model().step(0.1, DT, torque=0.3),
    "state not a dict": lambda: setattr(model(), "state", [1.0]),
    "state deleted": lambda: delattr(model(), "state"),
    "friction not a model": lambda: st.Motor(inertia=1.0, friction="hsieh_pan"),
    "effects not a dict": lambda: machine(effects=["cogging"]),
    "outputs of numbers": lambda: machine().simulate([0.1], DT, outputs=[1]),
    "out not a dict": lambda: machine().simulate([0.1], DT, out=[np.zeros(1)]),
    "out keyed by numbers": lambda: machine().simulate([0.1], DT, out={1: np.zeros(1)}),
    "integrator a number": lambda: machine(integrator=1),
}


@pytest.mark.parametrize("call", WRONG_TYPES.values(), ids=WRONG_TYPES.keys())
def test_wrong_types_raise_ordinary_errors(call):
    with pytest.raises((TypeError, ValueError, AttributeError)):
        call()


def test_a_refused_step_changes_nothing():
    contact_, body = model(), machine()
    contact_.simulate(np.full(50, 0.01), DT)
    body.simulate(np.full(50, 0.4), DT)
    before, body_before = contact_.state, body.state
    for bad in ([0.01, NAN], [], [[[0.1]]]):
        with pytest.raises(st.InputError):
            contact_.simulate(bad, DT)
        with pytest.raises(st.InputError):
            body.simulate(bad, DT)
    with pytest.raises(st.InputError):
        body.simulate([0.1, 0.1], [DT, -DT])
    with pytest.raises(st.InputError):
        contact_.state = before | {"hardening": NAN}
    with pytest.raises(st.InputError):
        body.state = body_before | {"hardening": NAN, "position": 5.0}
    assert same_state(contact_.state, before)
    assert same_state(body.state, body_before)


def test_a_refused_step_leaves_the_trial_standing():
    tried, plain = model(), model()
    tried.trial(0.05, DT)
    with pytest.raises(st.InputError):
        tried.step(NAN, DT)
    tried.commit()
    plain.step(0.05, DT)
    assert tried == plain


HUGE = [1e30, 1e150, 1e300, 1.7e308, -1.7e308]


@pytest.mark.parametrize("kind", ["coulomb", "stribeck", "sticking", "hook", "spring damper"])
def test_a_huge_velocity_never_leaves_a_model_that_cannot_be_pickled(kind):
    for value in HUGE:
        for dt in (1e-9, 1.0, 1e30):
            target = contact(kind)
            for v in (value, -value, 0.0, 1.0, value):
                try:
                    target.step(v, dt)
                except st.InputError:
                    break
            assert isinstance(target.copy(), st.FrictionModel)
            assert pickle.loads(pickle.dumps(target)) == target


def test_a_sample_far_too_long_for_the_machine_is_refused():
    body = motor("elastic")
    for call in (
        lambda: body.simulate(np.full(5, 0.3), 1e4),
        lambda: body.step(0.3, 1e4),
        lambda: body.simulate(np.full(5, 0.3), np.array([1e-3, 1e-3, 1e4, 1e-3, 1e-3])),
    ):
        with pytest.raises(st.InputError, match="too long for this machine"):
            call()
    body.simulate(np.full(5, 0.3), 1e-3)


def test_a_motor_that_ran_away_says_so_and_can_still_be_copied_and_reset():
    body = motor("elastic")
    run = body.simulate(np.full(5, 1e308), 1e-3)
    assert not run.success
    assert "ran away" in run.message
    assert repr(body)
    assert isinstance(body.copy(), st.Motor)
    body.reset()
    assert body == motor("elastic")
