"""Entries of the table that the literature or a closed form fixes."""

from __future__ import annotations

import math

import pytest

import stiction as st
from stiction.compare import PROPERTIES, Measured, compare
from stiction.compare.draws import draws
from stiction.compare.properties import creep, memory, passivity, robustness, sliding
from stiction.compare.result import CONDITIONAL, NO, UNDEFINED, YES, verdict_of
from stiction.compare.subject import Subject, variants
from stiction.errors import InputError

NAMES = {record.name for record in st.laws()}

# What is known of laws, whether they are in the catalogue yet or not.
ANCHORS = [
    ("hsieh_pan", "creep_that_stops", YES),
    ("hsieh_pan", "isotropic_hardening", YES),
    ("hsieh_pan", "infinite_mpw_slope", YES),
    ("hsieh_pan", "congruent_branches", YES),
    ("hsieh_pan", "reverse_points_recovered", YES),
    ("hsieh_pan", "loops_wiped_out", YES),
    ("hsieh_pan", "linear_near_reversal", YES),
    ("hsieh_pan", "holds_still", YES),
    ("hsieh_pan", "no_ratcheting", YES),
    ("hsieh_pan", "survives_noise", YES),
    ("maxwell_slip", "creep_that_stops", NO),
    ("maxwell_slip", "isotropic_hardening", NO),
    ("maxwell_slip", "reverse_points_recovered", YES),
    ("maxwell_slip", "loops_wiped_out", YES),
    ("maxwell_slip", "no_ratcheting", YES),
    ("maxwell_slip", "passive", YES),
    ("coulomb", "reverse_points_recovered", UNDEFINED),
    ("coulomb", "holds_still", YES),
    ("coulomb", "frictional_lag", NO),
    ("coulomb", "stribeck", CONDITIONAL),
    ("coulomb", "passive", YES),
    ("rate_and_state", "frictional_lag", YES),
    ("rate_and_state", "stribeck", YES),
    ("dahl", "reverse_points_recovered", NO),
    ("dahl", "survives_noise", NO),
    ("dahl", "congruent_branches", NO),
    ("dahl_with_memory", "reverse_points_recovered", YES),
    ("dahl_with_memory", "no_ratcheting", YES),
    ("lugre", "no_ratcheting", NO),
    ("lugre", "frictional_lag", YES),
    ("lugre", "breakaway_falls_with_rate", YES),
    ("lugre", "passive", CONDITIONAL),
    ("elasto_plastic", "no_ratcheting", YES),
    ("prandtl_ishlinskii", "reverse_points_recovered", YES),
    ("preisach", "loops_wiped_out", YES),
    ("gms", "no_ratcheting", YES),
]


@pytest.mark.slow
@pytest.mark.parametrize(("law", "name", "verdict"), ANCHORS)
def test_what_the_literature_fixes_comes_out(table, law, name, verdict):
    if law not in NAMES:
        pytest.skip(f"'{law}' is not in the catalogue")
    cell = table[law].cells[name]
    assert cell.verdict == verdict, f"{cell.note}: {cell.cases}"


@pytest.mark.slow
def test_every_law_has_every_property_and_a_cost(table):
    assert [row.law for row in table.rows] == [record.name for record in st.laws()]
    for row in table.rows:
        assert list(row.cells) == [each.name for each in PROPERTIES]
        assert all(c.verdict in (YES, NO, CONDITIONAL, UNDEFINED) for c in row.cells.values())
        assert row.cost > 0.0
    assert table["coulomb"].cost == pytest.approx(1.0)
    assert len(PROPERTIES) == 14


def test_creep_is_what_the_force_can_harden():
    subject = Subject("hsieh_pan", "own", {})
    measured = creep.creep(subject)
    force = 0.6 * subject.scale.level
    # The ramp lets a little creep pass before the clock starts.
    whole = 1.6e-3 * force**2 / subject.length
    assert 0.85 * whole < measured.numbers["creep in 1000 s, spans"] < whole


@pytest.mark.parametrize("exponent", [1.5, 2.0, 3.0])
def test_the_power_of_possible_hardening_is_that_of_the_law(exponent):
    measured = creep.possible_hardening(
        Subject("hsieh_pan", "own", {"hardening_exponent": exponent})
    )
    assert measured.numbers["power of force that creep follows"] == pytest.approx(
        exponent, abs=0.02
    )


def test_hardening_that_is_off_is_not_found():
    for keywords in ({"hardening_coefficient": 0.0}, {"creep_rate": 0.0}):
        assert creep.hardening(Subject("hsieh_pan", "own", keywords)).holds is False


def test_stiffness_behind_a_reversal_is_that_of_the_spring():
    subject = Subject("maxwell_slip", "own", {"initial_stiffness": 2000.0})
    measured = memory.linear(subject)
    found = measured.numbers["stiffness behind the reversal over level per span"]
    assert found * subject.stiffness == pytest.approx(2000.0, rel=1e-3)


def test_viscous_friction_does_not_lag_and_does_not_fall():
    subject = Subject("coulomb", "own", {"viscous": 0.05})
    assert sliding.lag(subject).holds is False
    assert sliding.stribeck(subject).holds is False


def test_a_stribeck_fall_is_as_deep_as_its_levels():
    measured = sliding.stribeck(Subject("coulomb", "own", {"breakaway": 0.5, "coulomb": 0.35}))
    fall = measured.numbers["greatest fall of steady friction with speed, share"]
    assert fall == pytest.approx(1.0 - 0.35 / 0.5, abs=0.01)


def test_break_away_falls_with_loading_rate_as_stated():
    slow = {"breakaway": 0.5, "coulomb": 0.35, "hardening_coefficient": 0.0}
    assert sliding.rate(Subject("hsieh_pan", "own", slow)).holds is False
    assert sliding.rate(Subject("hsieh_pan", "own", {**slow, "loading_rate": 2.0})).holds is True


def test_an_element_that_gives_energy_is_caught():
    class Pushing(Subject):
        """Friction that pushes along for a part of its way."""

        def model(self):
            law = super().model()

            class Law:
                def trial(self, velocity, dt):
                    force, slope = law.trial(velocity, dt)
                    return -force, slope

                def step(self, velocity, dt):
                    return -law.step(velocity, dt)

            return Law()

    subject = Pushing("coulomb", "own", {"coulomb": 0.4})
    subject.__dict__["scale"] = Subject("coulomb", "own", {"coulomb": 0.4}).scale
    measured = passivity.passive(subject, 2000)
    assert measured.holds is False
    assert measured.numbers["episodes that gave back more than they took, share"] == 1.0


def test_passivity_counts_the_steps_that_it_took():
    measured = passivity.passive(Subject("coulomb", "own", {}), 10_000)
    assert measured.numbers["random steps"] == pytest.approx(10_000, rel=0.1)


def test_lugre_ratchets_by_what_its_equation_gives():
    if "lugre" not in NAMES:
        pytest.skip("'lugre' is not in the catalogue")
    keywords = {"viscous": 0.0}
    subject = Subject("lugre", "own", keywords)
    drift = robustness.ratchet(subject).numbers["drift in 60 s, spans"] * subject.length
    # Slow limit of z' = v − σ_0·|v|·z/g: dF/dx = σ_0·(1 − F/F_s) up, σ_0·(1 + F/F_s) down, with
    # F from 20 to 80 % of F_c.
    p = subject.model().parameters
    assert subject.coulomb == pytest.approx(p["coulomb"], rel=1e-3)
    low, high = (share * p["coulomb"] / p["breakaway"] for share in (0.2, 0.8))
    cycle = math.log((1.0 - low) / (1.0 - high)) - math.log((1.0 + high) / (1.0 + low))
    expected = 300.0 * cycle * p["breakaway"] / p["initial_stiffness"]
    assert drift == pytest.approx(expected, rel=0.1)


def test_dahl_loses_its_force_to_noise():
    if "dahl" not in NAMES:
        pytest.skip("'dahl' is not in the catalogue")
    measured = robustness.noise(Subject("dahl", "own", {}))
    assert measured.numbers["share of the force that is left"] < 0.8


def test_draws_are_the_same_each_time_and_differ_from_each_other():
    record = next(record for record in st.laws() if record.name == "hsieh_pan")
    one, other = (
        [dict(subject.keywords) for subject in draws(record, 5)],
        [dict(subject.keywords) for subject in draws(record, 5)],
    )
    assert one == other
    assert len({repr(keywords) for keywords in one}) == 5


def test_verdicts_sum_up_the_cases():
    def over(*holds):
        return verdict_of({f"case {k}": Measured(h) for k, h in enumerate(holds)})[0]

    assert over(True, True) == YES
    assert over(False, None) == NO
    assert over(True, False) == CONDITIONAL
    assert over(True, None) == CONDITIONAL
    assert over(None, None) == UNDEFINED


def test_a_conditional_verdict_says_where_it_holds():
    cases = {"defaults": Measured(False), "typical values": Measured(True)}
    assert verdict_of(cases)[1] == "holds with typical values"
    drawn = {"defaults": Measured(True), "draw 1": Measured(True), "draw 2": Measured(False)}
    assert verdict_of(drawn) == (CONDITIONAL, "holds for 1 of 2 drawn sets of parameters")


@pytest.mark.parametrize("wrong", [{"laws": ["lugree"]}, {"steps": 10}, {"draws": -1}])
def test_a_wrong_request_says_what_is_wrong(wrong):
    with pytest.raises(InputError):
        compare(**wrong)


def test_measurements_do_not_depend_on_what_was_measured_before():
    subject = next(variants(next(r for r in st.laws() if r.name == "maxwell_slip")))
    assert memory.branches(subject) == memory.branches(subject)
    assert passivity.passive(subject, 2000) == passivity.passive(subject, 2000)
