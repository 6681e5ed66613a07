"""Other laws as causes: what a law lacks is not put down to an effect."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis.builders import cells, evidence, model, plant, recordings
from tests.reference.ladder_spring import LadderSpring
from tests.reference.laws import lugre
from tests.reference.session_reference import make_sessions

import stiction as st
from stiction.diagnosis.adequacy.lone import Lone
from stiction.diagnosis.data.evidence import Evidence
from stiction.diagnosis.data.gain import HeldOut
from stiction.diagnosis.screening.model import Model
from stiction.diagnosis.selection import laws
from stiction.plant.stated import Friction

SECONDS = 72.0


@cache
def made(base: str, flicker: float = 0.0) -> Any:
    session = {"seed": 31, "seconds": SECONDS, "base": base, "flicker": flicker}
    return make_sessions([session])[0]


def with_law(base: str, law: str, **keywords: Any) -> st.Diagnosis:
    plant = replace(as_plant(made(base)), friction=Friction(law))
    return st.diagnose(plant, as_session(made(base)), surrogates=6, **keywords)


@pytest.mark.parametrize("base", ["maxwell_slip", "hsieh_pan"])
def test_a_contact_that_yields_is_no_effect_beside_coulomb(base: str) -> None:
    found = with_law(base, "coulomb")
    assert not any(cause.decided for cause in found.effects)
    assert found.verdict in ("ambiguous", "unexplained")
    if found.effects:
        assert "maxwell_slip" in found.sentence
        assert [row.law for row in found.laws] == ["maxwell_slip"]


def test_a_dead_band_that_takes_the_input_away_makes_no_better_law() -> None:
    # Beside the other law that dead band comes to hold back all of the input, and nothing is left.
    session = {"seed": 32, "seconds": SECONDS, "base": "coulomb"}
    hidden = make_sessions([{**session, "hidden": (("drive_deadband", 0.011),)}])[0]
    found = st.diagnose(as_plant(hidden), as_session(hidden), surrogates=6)
    assert found.verdict == "missing_effect"
    assert [(cause.name, cause.decided) for cause in found.effects] == [("drive_deadband", True)]
    assert found.better_law == ""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("true", "stated", "flicker"),
    [("maxwell_slip", "coulomb", 0.3), ("coulomb", "maxwell_slip", 0.0)],
)
def test_each_law_is_driven_as_its_own_contact_has_to_be(
    true: str, stated: str, flicker: float
) -> None:
    """Along the motion of the other contact the true law explained .96 and .14 of it."""
    plant, session = as_plant(made(true, flicker)), as_session(made(true, flicker))
    other = replace(plant, friction=Friction(stated))
    found = st.diagnose(other, session, surrogates=6, laws=(true,))
    (row,) = (row for row in found.laws if row.law == true)
    assert row.gain is not None
    left = {}
    for each in (plant, other):
        heldout = st.fit(each, session).heldout_rms
        assert heldout is not None
        left[each.friction.law] = heldout**2
    known = 1.0 - left[true] / left[stated]
    assert known > 0.9
    assert row.gain.value > 0.98 * known
    assert found.better_law == true


def test_rows_that_test_take_a_law_away_that_is_surely_worse_there() -> None:
    source = np.random.default_rng(4)
    own, worse, better = (size * source.standard_normal(4000) for size in (1.0, 1.5, 0.7))
    ones = np.ones(4000)
    test = HeldOut((own, worse, better), ones, ones, cells(np.arange(4000) // 100), ())
    gained = {"beside": 0.8, "z": 9.0, "counts": True}
    first = replace(rival("load_dependent", 1.0), **gained)
    second = replace(rival("dahl", 1.0), **{**gained, "beside": 0.5})
    assert laws.better_laws([first, second], 0, None, 0) == [first]
    assert laws.better_laws([first, second], 0, test, 0) == [second]
    assert laws.better_laws([first], 0, test, 0) == []
    # What it removes beside the friction is too little to be worth a name.
    assert laws.better_laws([replace(first, counts=False)], 0, None, 0) == []
    # Nor is it named beside another one.
    near = replace(first, beside=0.5)
    assert laws.better_laws([near, second], 0, None, 0) == [near, second]
    assert laws.better_laws([near, second], 0, test, 0) == [second]
    # What was tested without the effects that it needs is not judged by that.
    needs = replace(first, kept=("cogging",))
    assert laws.better_laws([needs], 0, test, 0) == [needs]


def test_of_laws_that_leave_as_little_the_simpler_one_is_named() -> None:
    """A law that holds another one within it leaves a little less of what that one made."""

    simple, holding, worse = (
        replace(rival(law, 1.0), beside=beside, z=9.0, counts=True)
        for law, beside in (("dahl", 0.9990), ("leuven", 0.9991), ("coulomb", 0.95))
    )
    assert worse.parameters < simple.parameters < holding.parameters
    assert laws.better_laws([holding, simple, worse], 0, None, 0) == [simple, holding]


def test_no_law_is_said_to_leave_nothing() -> None:
    found = replace(rival("leuven", 1.0), beside=0.9996, z=9.0)
    said = found.words("coulomb", added="", alike=["lugre"])
    assert said.endswith("leaves over 99 % less than coulomb; lugre leaves about as little.")


@pytest.mark.slow
def test_a_better_law_is_told_with_its_gain() -> None:
    found = with_law("hsieh_pan", "maxwell_slip", laws=("all",))
    first = found.laws[0]
    assert first.law == "hsieh_pan"
    assert first.gain is not None
    assert first.gain.ci95[0] > 0.5
    # Creep beside the law is the effect that the better law has: told, and not for sure.
    assert "hsieh_pan" in found.sentence or found.verdict == "missing_effect"


@pytest.mark.slow
def test_the_right_law_is_not_beaten() -> None:
    found = with_law("maxwell_slip", "maxwell_slip", laws=("all",))
    assert found.verdict == "nothing_missing"
    assert all(row.gain is None or row.gain.value < 0.1 for row in found.laws)
    assert {row.law for row in found.laws} == {law.name for law in st.laws()} - {"maxwell_slip"}
    assert "law" not in found.sentence


def test_a_fit_of_a_law_that_was_interrupted_is_not_compared(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = laws._fitted

    def stopped(base: Model, law: str, hopeless: float) -> Model | None:
        model = whole(base, law, hopeless)
        assert model is not None
        return replace(model, solution=replace(model.solution, interrupted=True))

    monkeypatch.setattr(laws, "_fitted", stopped)
    found = with_law("maxwell_slip", "maxwell_slip", laws=("all",))
    assert not found.success
    assert found.message.startswith("interrupted")
    assert found.laws == ()
    assert found.verdict == "nothing_missing"


@pytest.mark.parametrize("asked", [False, True])
def test_a_law_that_leads_nowhere_is_fitted_to_its_end_only_where_it_was_asked_for(
    asked: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # A dry contact rests, and one that yields follows no rest whose effort changes.
    hidden = (("torque_bias", 0.02),)
    session = {"seed": 32, "seconds": SECONDS, "base": "coulomb", "hidden": hidden}
    machine = make_sessions([session])[0]
    seen: list[laws.Rival] = []
    whole = laws.rivals_of

    def looks(*given: Any, **named: Any) -> list[laws.Rival]:
        seen.extend(whole(*given, **named))
        return seen

    monkeypatch.setattr("stiction.diagnosis.findings.conclude.rivals_of", looks)
    names = ("maxwell_slip",) if asked else ()
    found = st.diagnose(as_plant(machine), as_session(machine), surrogates=6, laws=names)
    assert found.effects
    (law,) = seen
    assert (law.law, law.asked, law.model is not None) == ("maxwell_slip", asked, asked)
    assert len(found.laws) == asked
    assert found.better_law == ""


EVENT = Lone("recording 1", 1.0, 2.0, "were fitted")


def rival(law: str, power: float, *, session: Evidence | None = None, **terms: float) -> laws.Rival:
    """Another law that leaves so much power in each row of ``EVENT``, and of others what all do."""
    record = next(each for each in st.laws() if each.name == law)
    own = {each.name: each.typical for each in record.parameters if not each.optional}
    session = session or evidence(simulated=True)
    inside = EVENT.rows(session.shown, session.names)
    stated = plant(friction={"law": law, **own, **terms})
    residual = np.where(inside, np.sqrt(power), 3.0)
    return laws.Rival(law, True, model(session, stated, residual=residual))


def test_advice_to_state_a_law_names_the_terms_that_made_it_better() -> None:
    with_spring = rival("rate_and_state", 1.0, compliance=3.6e-7)
    assert 'law = "rate_and_state" and compliance = 3.6e-07' in with_spring.advice().experiment
    assert rival("rate_and_state", 1.0).terms == ()
    row = laws.law_rows([with_spring], 1, None, 0)[0]
    assert row.reason.endswith("with compliance = 3.6e-07")


def read_coarsely() -> Evidence:
    """A contact that yields, moved by sines and read by an encoder of 500 counts."""
    yielding = {"law": "dahl", "coulomb": 0.2, "viscous": 0.02, "initial_stiffness": 100.0}
    machine = plant(friction=yielding, sensor={"counts_per_rev": 500})
    step, read = 2.0 * np.pi / 500, []
    for each in recordings():
        moved = machine.motor().simulate(each.input[:-1], each.dt).position
        position = step * np.round(np.concatenate([[0.0], moved]) / step)
        read.append(st.Recording(each.time, each.input, position, role=each.role))
    return Evidence(machine, read)


def test_a_law_is_not_compared_along_readings_too_coarse_to_drive_it() -> None:
    """A lugre that yielded within four counts "left eighty times" what coulomb did."""
    coarse = read_coarsely()
    yields = rival("dahl", 3.0, session=coarse, coulomb=0.2, initial_stiffness=100.0)
    rigid = rival("rigid_perfectly_plastic", 2.0, session=coarse)
    rows = laws.law_rows([yields, rigid], 1, None, 0)
    told = {row.law: row.reason for row in rows}
    assert told["dahl"].startswith("cannot be compared here: it yields within a few counts")
    assert told["rigid_perfectly_plastic"].startswith("fitted")
    assert all(row.gain is None for row in rows)
    # What is simulated is no motion that was read.
    moves = rival("dahl", 3.0, coulomb=0.2, initial_stiffness=100.0)
    assert laws.law_rows([moves], 1, None, 0)[0].reason.startswith("fitted")


def test_the_law_that_follows_a_single_event_is_named_and_comes_first() -> None:
    own = rival("coulomb", 1.0).model
    assert own is not None
    tried = [rival("dahl", 0.95), rival("bristle", 860.0), rival("rate_and_state", 0.445)]
    said = laws.event_words([*tried, rival("gms", 1.0)], own, EVENT, lambda *_: 0.5)
    assert "rate_and_state follows it most closely" in said
    assert "0.445 times the power that coulomb leaves there, and 0.5 times the power in" in said
    short = laws.event_words(tried, own, EVENT, lambda *_: None)
    assert short.endswith("leaves there. No other event confirms that.")
    assert laws.event_words(tried[:2], own, EVENT) == ""
    rows = laws.law_rows(tried, 1, None, 0, beside=(own, EVENT))
    assert [row.law for row in rows] == ["rate_and_state", "dahl", "bristle"]
    assert rows[-1].reason.endswith("over 100 times the power")
    alike = laws.law_rows([rival("gms", 1.001)], 1, None, 0, beside=(own, EVENT))[0]
    assert alike.reason.endswith("the same power")


def moved_over_a_ladder(seed: int, role: str, offset: float = 0.0) -> st.Recording:
    """A damper on a shaking table: elements that stick and slide, oil, and a reading of force."""
    rng = np.random.default_rng(seed)
    time = np.arange(0.0, 40.0, 0.01)
    swings = zip((0.006, 0.003, 0.002), (0.13, 0.31, 0.83), rng.uniform(0.0, 6.28, 3), strict=True)
    position = sum(size * np.sin(2.0 * np.pi * rate * time + at) for size, rate, at in swings)
    spring = LadderSpring(initial_stiffness=8e4, final_stiffness=50.0, decay_distance=4e-4)
    force = np.array([spring.advance(way) for way in np.diff(position, prepend=0.0)])
    oil = 150.0 * np.gradient(position, time)
    effort = offset + force + oil + 0.3 * rng.standard_normal(len(time))
    read = position + 2e-7 * rng.standard_normal(len(time))
    return st.Recording(time, None, read, effort=effort, role=role)


def moved_damper(offset: float = 0.0) -> tuple[st.Plant, st.Session]:
    """A plant that is moved, without memory, and recordings of a damper that has one."""
    table = {
        "motion": {"kind": "linear"},
        "drive": {"kind": "prescribed_motion"},
        "friction": {"law": "coulomb"},
    }
    roles = ("train", "train", "select", "test")
    recordings = [moved_over_a_ladder(k, role, offset) for k, role in enumerate(roles)]
    return st.Plant.from_dict(table), st.Session(recordings)


def test_laws_of_a_contact_that_is_moved_are_fitted_and_told_by_what_they_gain() -> None:
    plant, session = moved_damper()
    rivals = ("maxwell_slip", "hsieh_pan", "lugre", "dahl")
    found = st.diagnose(plant, session, laws=rivals, surrogates=6)
    gains = {row.law: row.heldout_gain for row in found.laws}
    assert set(gains) == set(rivals), found.laws
    assert all(gain is not None for gain in gains.values()), found.laws
    assert found.laws[0].law in ("maxwell_slip", "hsieh_pan")
    assert gains["maxwell_slip"] > 0.5


def test_a_law_is_not_outdone_by_an_offset_that_has_nothing_to_do_with_it() -> None:
    found = st.diagnose(*moved_damper(offset=3.0), laws=("maxwell_slip",), surrogates=6)
    assert "The friction law itself lacks something: maxwell_slip" in found.sentence
    assert not any(cause.decided for cause in found.effects), found.sentence
    (row,) = (row for row in found.laws if row.law == "maxwell_slip")
    # Alone it may do as badly as any other law: the row tells what it does beside the offset.
    (beside,) = re.findall(r"; with torque_bias.* it leaves (\S+) times", row.reason)
    assert float(beside) < 0.9, row.reason


def test_a_contact_that_never_breaks_away_hides_no_offset() -> None:
    _, session = moved_damper(offset=3.0)
    moved = {"motion": {"kind": "linear"}, "drive": {"kind": "prescribed_motion"}}
    plant = st.Plant.from_dict({**moved, "friction": {"law": "hsieh_pan"}})
    found = st.fit(plant, session)
    # What a contact brought along for a whole recording is in no other one.
    assert found.heldout_relative is not None
    assert found.train_relative > 0.9 * found.heldout_relative


def moved_over_bristles(seed: int, role: str) -> st.Recording:
    """A contact of the law of LuGre with its fall, on a rig that moves it."""
    rng = np.random.default_rng(seed)
    dt = 2e-3
    time = np.arange(0.0, 12.0, dt)
    swings = zip((0.4, 0.15, 0.02), (0.21, 0.55, 1.3), rng.uniform(0.0, 6.28, 3), strict=True)
    speed = sum(size * np.cos(2.0 * np.pi * rate * time + at) for size, rate, at in swings)
    law = {**lugre.GOLDEN.parameters, "initial_stiffness": 400.0}
    effort = lugre.along(speed, dt, **law) + 1e-3 * rng.standard_normal(len(time))
    position = np.cumsum(speed) * dt
    return st.Recording(time, None, position, effort=effort, role=role)


@pytest.mark.slow
def test_a_law_is_compared_with_the_fall_that_it_may_have() -> None:
    """Without it the law that these data were made with would leave much, and say nothing of it."""
    roles = ("train", "train", "select", "test")
    session = st.Session([moved_over_bristles(k, role) for k, role in enumerate(roles)])
    table = {"drive": {"kind": "prescribed_motion"}, "friction": {"law": "dahl"}}
    found = st.diagnose(st.Plant.from_dict(table), session, laws=("lugre",), surrogates=6)
    assert found.better_law == "lugre"
    (row,) = found.laws
    assert "with breakaway = 0.5 and stribeck_velocity = 0.0" in row.reason
    assert row.gain is not None
    assert row.gain.ci95[0] > 0.9
    # The diagnosis has gone on with it, and says so last.
    assert "breakaway = 0.5" in found.advice[-1].experiment
