"""A cause is more than the form in which it is looked for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.blind.draw import Case
from tests.blind.score import as_plant, as_session
from tests.diagnosis import builders
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.diagnosis.adequacy.omnibus import Rest
from stiction.diagnosis.findings import verdict
from stiction.diagnosis.screening.block_gains import heldout_gain, log_gain
from stiction.diagnosis.selection import sharpen
from stiction.diagnosis.selection.decide import PENALTY
from stiction.diagnosis.selection.search import Search
from stiction.diagnosis.selection.sharpen import has_free_shapes
from stiction.fitting.rows import Nuisances
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect

# Friction that repeats 8 and 24 times a turn, or once and three times, one wave nearly as large as
# the other: where they cancel, the first alone does harm, and the rows that decide do not want it.
# Three times a turn noise reaches a third of what that explains.
TWO_WAVES = {
    (8.0, 24.0): Case(
        "single", "maxwell_slip", 6110046, (("position_dependent_friction:foreign", 0.023703),)
    ),
    (3.0, 1.0): Case(
        "single", "coulomb", 12970046, (("position_dependent_friction:foreign", 0.014737),)
    ),
}
# The contact rests within 1 mrad, of a range of motion of 22 rad: neither a thousandth nor a
# ten-thousandth of that is near, and with the nearer one half of what was left was no noise.
RESTS = Case("single", "coulomb", 12970006, (("rate_dependent_breakaway", 0.010994),))


def found(case: Any) -> Any:
    (made,) = make_sessions([case.spec])
    return st.diagnose(as_plant(made), as_session(made))


@pytest.mark.slow
@pytest.mark.parametrize("orders", TWO_WAVES)
def test_two_waves_pass_together_where_one_does_not(orders: tuple[float, float]) -> None:
    diagnosis = found(TWO_WAVES[orders])
    assert [cause.name for cause in diagnosis.effects] == ["position_dependent_friction"]
    assert diagnosis.gain is not None
    assert diagnosis.gain.value > 0.8
    (effect,) = diagnosis.plant.effects
    assert tuple(effect.parameters[name].value for name in ("order", "order_2")) == orders


@pytest.mark.slow
def test_a_contact_rests_within_a_distance_of_its_own() -> None:
    (made,) = make_sessions([RESTS.spec])
    diagnosis = st.diagnose(as_plant(made), as_session(made))
    assert diagnosis.verdict == "missing_effect"
    (cause,) = diagnosis.effects
    assert (cause.name, cause.decided) == ("rate_dependent_breakaway", True)
    (hidden,) = made.effects
    true = {"strength": hidden.amplitude, "loading_rate": hidden.shape["rate"]}
    true |= {name: hidden.shape[name] for name in ("distance", "window")}
    for name, value in true.items():
        low, high = cause.parameters[f"effects.rate_dependent_breakaway.{name}"].ci95
        assert low - 0.1 * value < value < high + 0.1 * value, name


@pytest.mark.parametrize(
    ("gain", "z", "known", "kept"),
    [
        (0.2, 4.0, True, True),
        (0.2, 1.0, True, False),
        (0.01, 9.0, True, False),
        # A shape that exchanges for the gain.
        (0.2, 4.0, False, False),
    ],
)
def test_a_shape_of_its_own_has_to_gain(gain: float, z: float, known: bool, kept: bool) -> None:
    record = next(r for r in st.effects() if r.name == "stribeck")
    names = (*record.gains, *(shape.parameter for shape in record.shapes))
    stated = {n: Parameter(1.0, fixed=n == "exponent") for n in names}
    drive, friction = {"input": "torque_nm", "gain": 1.0}, {"law": "coulomb"}
    plant = st.Plant.from_dict({"drive": drive, "body": {"inertia": 0.01}, "friction": friction})
    plant = replace(plant, effects=(Effect("stribeck", stated),))
    # Four blocks, of which every other one gains more than the others, as uncertain as z says.
    one = np.ones(4)
    left = one - gain * (1.0 + np.sqrt(3.0) / z * np.array([1.0, -1.0, 1.0, -1.0]))
    before = builders.model(fitted=plant, blocks=(one, one))
    after = {"blocks": (left, left), "surely": known}
    bench = builders.screening(fits=lambda freed: builders.model(fitted=freed, **after))
    assert heldout_gain(before, after_of := bench.fit(plant, Nuisances())) == pytest.approx(
        (gain, z)
    )
    assert log_gain(before, after_of) > PENALTY
    model = sharpen._freed(bench, builders.trial("stribeck", refit=before))
    assert (model is not None) == kept
    if model is not None:
        (effect,) = model.plant.effects
        assert not effect.parameters["exponent"].fixed
        assert has_free_shapes(effect, record)
        assert not has_free_shapes(Effect("stribeck", stated), record)


def test_shapes_held_at_nothing_start_from_what_is_typical() -> None:
    record = next(r for r in st.effects() if r.name == "backlash")
    held = ("contact_time", "damping_ratio", "load_damping")
    assert sharpen._held(record) == held
    values = {"inertia_share": 0.2, "gap": 2e-3, "contact_time": 0.0, "damping_ratio": 0.6}
    stated = {n: Parameter(v, fixed=n in held) for n, v in values.items()}
    stated["load_damping"] = Parameter(0.0, fixed=True)
    drive, friction = {"input": "torque_nm", "gain": 1.0}, {"law": "coulomb"}
    plant = st.Plant.from_dict({"drive": drive, "body": {"inertia": 0.01}, "friction": friction})
    plant = replace(plant, effects=(Effect("backlash", stated),))
    starts = [p.effects[0].parameters for p in sharpen._with_shapes_free(plant, record, held)]
    assert len(starts) == 9
    assert len({(s["contact_time"].value, s["load_damping"].value) for s in starts}) == 9
    for start in starts:
        assert start["gap"] == stated["gap"]
        assert start["damping_ratio"] == Parameter(0.6)
        for name in ("contact_time", "load_damping"):
            low, value, high = start[name].min, start[name].value, start[name].max
            assert low is not None
            assert high is not None
            assert 0.0 < low < value < high
            assert not start[name].fixed
    # A shape that is held at a value of its own starts there.
    (one,) = sharpen._with_shapes_free(plant, record, ("damping_ratio",))
    assert one.effects[0].parameters["damping_ratio"] == Parameter(0.6)


def leaving(*powers: float) -> Search:
    """What a search found whose models leave these powers in each block."""
    models = [builders.model(blocks=(np.ones(4), np.full(4, power))) for power in powers]
    return builders.search(models=models)


def test_names_that_explain_less_than_one_coordinate_shows_imitate() -> None:
    def shown(share: float) -> Rest:
        return Rest((builders.view("acceleration", share),))

    named = leaving(1.0, 0.9)
    assert verdict._falls_short(named, shown(0.12))
    assert not verdict._falls_short(named, shown(0.08))
    # What noise reaches as well is no sign.
    assert not verdict._falls_short(named, shown(0.01))


def test_what_the_names_leave_as_it_was_is_no_sign_against_them() -> None:
    def seen(**shares: float) -> Rest:
        return Rest(tuple(builders.view(name, s, size=0.002) for name, s in shares.items()))

    before, after = seen(acceleration=0.04, effort=0.1), seen(acceleration=0.05, effort=0.06)
    assert verdict._touched(leaving(1.0, 0.8), before, after) == {"effort"}
