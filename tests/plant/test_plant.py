"""Plant files: what they mean, that they survive a round trip, and what they refuse."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction import FrictionModel, InputError, Motor, Plant
from stiction.diagnosis.screening.candidates import present
from stiction.plant.overlap import REMEMBERS

WHOLE = """
[motion]
kind = "rotary"
[drive]
input = "current_a"
gain = 0.52
limit = 4.0
[body]
inertia = { value = 0.0076, min = 0.001, max = 0.1 }
gravity_amplitude = 0.1
gravity_zero_rad = 0.2
[friction]
law = "hsieh_pan"
breakaway = 0.5
viscous = { value = 0.05, fixed = true }
after_slip = "keep"
[[effects]]
name = "cogging"
cosine = 0.02
order = 24
[sensor]
counts_per_rev = 4096
[controller]
kind = "pd"
kp = 10.0
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "plant.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def whole(tmp_path: Path) -> Plant:
    return Plant.load(written(tmp_path, WHOLE))


def test_a_plant_survives_a_round_trip(whole: Plant, tmp_path: Path) -> None:
    assert Plant.load(whole.save(tmp_path / "again.toml")) == whole


def test_a_plant_simulates_as_the_motor_it_describes(whole: Plant) -> None:
    current = 2.0 * np.sin(np.arange(3000) * 0.01)
    by_hand = Motor(
        0.0076,
        0.52,
        FrictionModel("hsieh_pan", breakaway=0.5, viscous=0.05, after_slip="keep"),
        effects={"cogging": {"cosine": 0.02, "order": 24.0}},
        gravity_amplitude=0.1,
        gravity_zero=0.2,
        input_limit=4.0,
        count=2 * np.pi / 4096,
    ).simulate(current, 1e-3)
    run = whole.simulate(current, 1e-3)
    assert np.array_equal(run.position, by_hand.position)
    assert np.array_equal(run.measured, by_hand.measured)


def test_the_input_limit_and_the_count_reach_the_trajectory(whole: Plant) -> None:
    beyond = whole.simulate(np.full(500, 9.0), 1e-3)
    at_limit = whole.simulate(np.full(500, 4.0), 1e-3)
    assert np.array_equal(beyond.position, at_limit.position)
    counts = beyond.measured / (2 * np.pi / 4096)
    assert np.allclose(counts, np.round(counts), atol=1e-6)


def test_values_are_replaced_by_path_or_by_unique_name(whole: Plant) -> None:
    changed = whole.with_values({"inertia": 0.01, "effects.cogging.cosine": 0.5})
    assert changed.parameters["body.inertia"].value == 0.01
    assert changed.parameters["body.inertia"].max == 0.1
    assert changed.parameters["effects.cogging.cosine"].value == 0.5
    assert whole.parameters["body.inertia"].value == 0.0076
    with pytest.raises(InputError, match="breakawy"):
        whole.with_values({"breakawy": 1.0})


def test_naming_the_law_alone_is_a_plant(tmp_path: Path) -> None:
    plant = Plant.load(written(tmp_path, '[friction]\nlaw = "coulomb"\n'))
    assert plant.motion == "rotary"
    with pytest.raises(InputError, match="inertia is missing"):
        plant.motor()


REFUSED = {
    "not TOML": ("[friction", "is not TOML"),
    "empty": ("", "is empty"),
    "unknown table": ('[frictoin]\nlaw = "coulomb"', r"'frictoin' is unknown \(did you mean 'fri"),
    "no law": ("[friction]\ncoulomb = 1.0", "law is missing"),
    "unknown law": ('[friction]\nlaw = "coulom"', "'coulom' is unknown"),
    "unknown parameter": (
        '[friction]\nlaw = "coulomb"\ncoulom = 1.0',
        r"'coulom' is unknown \(did you mean 'coulomb'",
    ),
    "text for a number": (
        '[friction]\nlaw = "coulomb"\ncoulomb = "much"',
        "'much' is a str; allowed is a number",
    ),
    "true for a number": ('[friction]\nlaw = "coulomb"\ncoulomb = true', "True is a bool"),
    "nan": ('[friction]\nlaw = "coulomb"\ncoulomb = nan', "nan is not a number"),
    "out of bounds": ('[friction]\nlaw = "coulomb"\ncoulomb = -1.0', "coulomb = -1 is out of bou"),
    "wrong order": (
        '[friction]\nlaw = "coulomb"\ncoulomb = 1.0\nbreakaway = 0.5',
        "coulomb = 1 must not exceed breakaway = 0.5",
    ),
    "unknown option": (
        '[friction]\nlaw = "hsieh_pan"\ndamper = "floor"',
        "'floor' is unknown; allowed are hook, spring",
    ),
    "negative inertia": (
        '[body]\ninertia = -1.0\n[friction]\nlaw = "coulomb"',
        "inertia = -1.0 is out of bounds",
    ),
    "zero gain": ('[drive]\ngain = 0\n[friction]\nlaw = "coulomb"', "gain = 0"),
    "unknown input": (
        '[drive]\ninput = "current"\n[friction]\nlaw = "coulomb"',
        r"'current' is unknown \(did you mean 'current_a'",
    ),
    "unknown motion": ('[motion]\nkind = "round"\n[friction]\nlaw = "coulomb"', "'round' is unk"),
    "unknown effect": (
        '[friction]\nlaw = "coulomb"\n[[effects]]\nname = "coging"',
        r"'coging' is unknown \(did you mean 'cogging'",
    ),
    "nameless effect": ('[friction]\nlaw = "coulomb"\n[[effects]]\nbias = 1', "name is missing"),
    "effect twice": (
        '[friction]\nlaw = "coulomb"\n[[effects]]\nname = "cogging"\n[[effects]]\nname = "cogging"',
        "'cogging' is there twice",
    ),
    "effect of a machine that turns": (
        '[motion]\nkind = "linear"\n[friction]\nlaw = "coulomb"\n'
        '[[effects]]\nname = "gravity_unbalance"',
        r"1 \(gravity_unbalance\): only a machine that turns can have it; leave it out",
    ),
    "effect of a servo": (
        '[friction]\nlaw = "coulomb"\n[[effects]]\nname = "goal_rate_limit"',
        "only a servo has a goal",
    ),
    "effects as a table": ('[friction]\nlaw = "coulomb"\n[effects]\nname = "cogging"', "not a li"),
    "value out of its own bounds": (
        '[friction]\nlaw = "coulomb"\ncoulomb = { value = 2.0, max = 1.0 }',
        "out of its own bounds",
    ),
    "unknown key of a parameter": (
        '[friction]\nlaw = "coulomb"\ncoulomb = { value = 2.0, maximum = 1.0 }',
        "'maximum' is unknown",
    ),
    "count of the wrong motion": (
        '[sensor]\ncount_m = 1e-6\n[friction]\nlaw = "coulomb"',
        "'count_m' is unknown",
    ),
    "unknown gain of a controller": (
        '[controller]\nkind = "pd"\nzz = 1\n[friction]\nlaw = "coulomb"',
        "'zz' is unknown",
    ),
    "word for a gain": (
        '[controller]\nkind = "pd"\nkp = "abc"\n[friction]\nlaw = "coulomb"',
        "'abc' is a str",
    ),
    "force on a rotary plant": (
        '[drive]\ninput = "force_n"\n[friction]\nlaw = "coulomb"',
        "input of a rotary plant = 'force_n' is unknown",
    ),
    "controller without a kind": ('[controller]\nkp = 1\n[friction]\nlaw = "coulomb"', "kind is m"),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_a_faulty_plant_is_refused_in_one_sentence(tmp_path: Path, fault: str) -> None:
    text, sentence = REFUSED[fault]
    path = written(tmp_path, text)
    with pytest.raises(InputError, match=sentence) as caught:
        Plant.load(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_files_folders_and_other_encodings_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        Plant.load(tmp_path / "none.toml")
    with pytest.raises(InputError, match="directory"):
        Plant.load(tmp_path)
    (tmp_path / "latin.toml").write_bytes(b'[friction]\nlaw = "coulomb" # \xe9\n')
    with pytest.raises(InputError, match="UTF-8"):
        Plant.load(tmp_path / "latin.toml")


def test_prescribed_motion_has_nothing_to_simulate(tmp_path: Path) -> None:
    text = '[drive]\nkind = "prescribed_motion"\n[friction]\nlaw = "coulomb"\n'
    plant = Plant.load(written(tmp_path, text))
    assert plant.inertia == 0.0
    with pytest.raises(InputError, match="prescribed_motion"):
        plant.simulate(np.zeros(10), 1e-3)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        ({"motion": {"kind": "linear"}, "body": {"gravity_amplitude": 1.0}}, "for rotary plants"),
        ({"motion": {"kind": "linear"}, "body": {"gravity_zero_rad": 1.0}}, "for rotary plants"),
        ({"drive": {"kind": "prescribed_motion", "gain": 2.0}}, r"\[drive\] gain goes with an"),
        ({"drive": {"kind": "prescribed_motion", "input": "current_a"}}, r"\] input goes with an"),
        (
            {"drive": {"kind": "prescribed_motion", "limit": 2.0, "input": "torque_nm"}},
            r"\] input, limit goes with an input, .* leave it out",
        ),
    ],
)
def test_what_a_plant_of_its_kind_has_no_use_for_is_refused(table, told):
    with pytest.raises(InputError, match=told):
        Plant.from_dict({"friction": {"law": "coulomb"}, **table})


def test_bounds_that_leave_nothing_to_fit_fix_a_parameter():
    stated = {"value": 0.3, "min": 0.3, "max": 0.3}
    plant = Plant.from_dict({"friction": {"law": "coulomb", "coulomb": stated}})
    assert plant.parameters["coulomb"].fixed
    assert Plant.from_dict(plant.to_dict()) == plant


@pytest.mark.parametrize("effect", [each for each in st.effects() if each.law_terms])
def test_an_effect_that_law_or_body_state_as_well_is_told(
    effect: st.EffectRecord, caplog: pytest.LogCaptureFixture
) -> None:
    """The diagnosis looks for none of them again, and a fit cannot tell their shares."""
    term = effect.law_terms[0]
    laws = {law.name: [each.name for each in law.parameters] for law in st.laws()}
    memory = term == REMEMBERS
    table: dict[str, dict[str, object]] = {"friction": {"law": "coulomb"}}
    if memory:
        table = {"friction": {"law": "maxwell_slip"}}
    elif term.startswith("body."):
        table["body"] = {term.removeprefix("body."): 1.0}
    else:
        law = next(name for name, terms in laws.items() if term in terms)
        table["friction"] = {"law": law, term: 2.0}
    Plant.from_dict(table)
    assert caplog.text == ""
    doubled = Plant.from_dict({**table, "effects": [{"name": effect.name}]})
    assert f"[[effects]] 1 ({effect.name}) is stated by" in caplog.text
    assert (term.removeprefix("body.") in caplog.text) or memory
    assert caplog.text.count("drop one") == 1
    assert present(doubled, effect)


def test_an_effect_beside_a_law_that_does_not_state_it_is_not_told(
    caplog: pytest.LogCaptureFixture,
) -> None:
    level = {"law": "coulomb", "coulomb": 0.2}
    Plant.from_dict({"friction": level, "effects": [{"name": "stribeck"}]})
    assert caplog.text == ""
