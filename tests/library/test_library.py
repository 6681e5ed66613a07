"""The library: what every entry has to be, and a unit of one's own beside one."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stiction as st
from stiction import library
from stiction.cli import run
from stiction.fitting import FitParameter
from stiction.library import Entry, EntryNumber
from stiction.library.comparison import plant_like, verdict_of
from stiction.library.entry_file import read_entry
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect

FILES = sorted((Path(library.__file__).parent / "entries").glob("*.toml"))
GOOD = """\
machine = "a motor"
kind = "published"
[source]
text = "A. Nobody, On a motor, Journal 1 (2020), table 2"
url = "https://example.org"
license = "none"
[numbers."friction.coulomb"]
ci95 = [0.2, 0.4]
unit = "N·m"
units = [0.25, 0.3, 0.35]
sessions = [0.28, 0.29]
[plant.drive]
input = "torque_nm"
gain = 1.0
[plant.body]
inertia = 0.01
[plant.friction]
law = "coulomb"
coulomb = 0.3
viscous = 0.02
"""


def recorded(plant, seconds=20.0, dt=2e-3, seed=0):
    """What a plant does under a sum of sines, read with a little noise."""
    rng = np.random.default_rng(seed)
    time = dt * np.arange(round(seconds / dt))
    waves = [(0.5, 0.3), (1.3, 0.25), (3.1, 0.2), (7.0, 0.15)]
    phases = rng.uniform(0.0, 6.0, len(waves))
    given = 3.0 * sum(
        a * np.sin(2.0 * np.pi * f * time + p) for (f, a), p in zip(waves, phases, strict=True)
    )
    position = plant.simulate(given[:-1], dt, outputs=["position"]).position
    position = np.concatenate([[0.0], position]) + 1e-6 * rng.standard_normal(len(time))
    return time, given, position


def entry_of(units=(0.25, 0.3, 0.35)):
    plant = st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.01},
            "friction": {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02},
        }
    )
    numbers = {
        "friction.coulomb": EntryNumber(0.3, (0.29, 0.31), "N·m", tuple(units)),
        "friction.viscous": EntryNumber(0.02, (0.018, 0.022), "N·m·s/rad"),
    }
    source = {"text": "here", "url": "none", "license": "ours"}
    return Entry("motor", "a motor", "published", plant, numbers, source)


# --- entries


def test_there_are_ten_entries_and_more():
    assert len(FILES) >= 10
    assert [each.name for each in library.entries()] == [path.stem for path in FILES]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_an_entry_says_where_its_numbers_come_from(path):
    found = read_entry(path)
    assert found.machine
    assert re.search(r"\b(19|20)\d\d\b", found.source["text"]), "a year"
    assert found.source["url"].startswith("https://")
    assert found.numbers
    assert json.dumps(found.to_dict(), allow_nan=False)
    assert found.machine in str(found)
    if found.kind == "recordings":
        assert found.made["command"].split()[-1] == found.name
        assert all(each.ci95 or found.notes for each in found.numbers.values())


@pytest.mark.long
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_an_entry_is_a_plant_that_moves_and_resists(path):
    plant = read_entry(path).plant
    curve = plant.friction_curve([-0.5, 0.5])
    assert np.all(np.isfinite(curve))
    assert curve[0] < 0.0 < curve[1]
    assert plant.export("table").held
    if not plant.prescribed_motion:
        trajectory = plant.simulate(np.full(200, 0.5), 1e-3)
        assert np.all(np.isfinite(trajectory.position))


def test_a_new_file_is_an_entry(tmp_path, monkeypatch):
    (tmp_path / "mine.toml").write_text(GOOD, encoding="utf-8")
    monkeypatch.setattr("stiction.library.entry_file._FOLDER", tmp_path)
    library.entries.cache_clear()
    try:
        assert [each.name for each in library.entries()] == ["mine"]
        number = library.entry("mine").numbers["friction.coulomb"]
        assert (number.value, number.units, number.sessions) == (
            0.3,
            (0.25, 0.3, 0.35),
            (0.28, 0.29),
        )
        assert number.expected.endswith("(3 units)")
    finally:
        monkeypatch.undo()
        library.entries.cache_clear()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('machine = "a motor"', "", "machine is missing"),
        ('machine = "a motor"', "machine = 3", "machine is 3; give a word"),
        ('kind = "published"', 'kind = "guessed"', "kind = 'guessed' is unknown"),
        ('kind = "published"', 'kind = "recordings"', "version, command, seed, units"),
        ('url = "https://example.org"', "", "url is missing; state where numbers come from"),
        ('unit = "N·m"', 'unit = "N·m"\ntimes = 3', "'times' is unknown"),
        ("[0.2, 0.4]", "[0.31, 0.4]", "0.3 is not in its interval"),
        ("[0.2, 0.4]", "[0.2]", "is no interval"),
        ("[0.2, 0.4]", "0.2", "is not a list"),
        ("friction.coulomb", "friction.breakaway", "the plant states no such number"),
        ('law = "coulomb"', 'law = "colomb"', r"law = 'colomb' is unknown"),
    ],
)
def test_what_is_no_entry_is_refused(old, new, words, tmp_path):
    assert GOOD.count(old) == 1
    path = tmp_path / "mine.toml"
    path.write_text(GOOD.replace(old, new), encoding="utf-8")
    with pytest.raises(st.InputError, match=words):
        read_entry(path)


def test_a_name_that_is_none_is_told_with_the_nearest():
    with pytest.raises(st.InputError, match=r"no entry 'emp' \(did you mean 'emps'\?\)"):
        library.entry("emp")


def test_a_band_holds_as_many_units_as_it_says():
    rng = np.random.default_rng(7)
    inside = []
    for _ in range(2000):
        units = rng.normal(2.0, 0.3, 5)
        low, high = EntryNumber(float(units[0]), None, "", tuple(units[:4])).band
        inside.append(low <= units[4] <= high)
    assert np.mean(inside) == pytest.approx(0.95, abs=0.015)
    assert EntryNumber(1.0, None, "", (1.0,)).band is None
    assert EntryNumber(1.0, None, "", (0.5, 2.0), least=0.0).band[0] == 0.0


# --- a unit of one's own


def found_at(value, half, at_bound=""):
    return FitParameter(value, half / 2.0, (value - half, value + half), "N·m", at_bound, value)


@pytest.mark.parametrize(
    ("own", "library_number", "word"),
    [
        (found_at(0.3, 0.01), EntryNumber(0.3, (0.29, 0.31), ""), "alike"),
        (found_at(0.33, 0.015), EntryNumber(0.3, (0.29, 0.31), ""), "beyond the interval"),
        (found_at(0.33, 0.015), EntryNumber(0.3, (0.29, 0.31), "", (0.25, 0.3, 0.35)), "alike"),
        (found_at(0.9, 0.015), EntryNumber(0.3, (0.29, 0.31), "", (0.25, 0.3, 0.35)), "differs"),
        (found_at(0.3, 0.01), EntryNumber(0.3, None, ""), "alike"),
        (found_at(0.35, 0.01), EntryNumber(0.3, None, ""), "beyond the interval"),
        (found_at(0.35, 0.01), EntryNumber(0.3, None, "", (), (0.27, 0.3, 0.36)), "alike"),
        (
            found_at(0.95, 0.01),
            EntryNumber(0.3, None, "", (), (0.27, 0.3, 0.36)),
            "beyond the interval",
        ),
        (found_at(0.3, np.inf), EntryNumber(0.3, (0.29, 0.31), ""), "not determined"),
        (found_at(0.9, 0.01, "upper"), EntryNumber(0.3, (0.29, 0.31), ""), "not determined"),
    ],
)
def test_two_numbers_differ_where_neither_interval_nor_spread_explains_it(
    own, library_number, word
):
    assert verdict_of(own, library_number) == word


def test_a_unit_that_is_alike_and_one_that_differs():
    entry = entry_of()
    same = library.compare(entry, st.Session([st.Recording(*recorded(entry.plant))]))
    assert same.seconds < 60.0
    assert same.differing == ()
    assert same.message == "agrees with motor in 2 numbers"
    worn = entry.plant.with_values({"friction.coulomb": 0.9, "friction.viscous": 0.03})
    other = library.compare(entry, st.Session([st.Recording(*recorded(worn))]))
    assert {e.path: e.said for e in other.numbers} == {
        "friction.coulomb": "differs",
        "friction.viscous": "beyond the interval",
    }
    assert other.result["coulomb"].value == pytest.approx(0.9, rel=0.02)
    text = str(other)
    assert "more than from unit to unit" in text
    assert other.kept > 5.0 * other.fitted
    assert same.kept < 1.1 * same.fitted
    assert "of the unit that is known" in text
    json.dumps(other.to_dict())


def test_numbers_that_explain_hardly_more_are_doubted():
    entry = entry_of(units=())
    # Two per cent more friction than the interval allows, and noise that hides it.
    worn = entry.plant.with_values({"friction.coulomb": 0.33})
    time, given, position = recorded(worn)
    shaken = given + 1.0 * np.random.default_rng(1).standard_normal(len(given))
    found = library.compare(entry, st.Recording(time, shaken, position))
    assert found.hardly_more
    clear = library.compare(entry, st.Recording(time, given, position))
    assert not clear.hardly_more
    assert "friction.coulomb" in clear.differing
    assert "hardly more" not in clear.message
    doubted = replace(clear, kept=1.1 * clear.fitted)
    assert "the entry as it is leaves hardly more" in doubted.message


def test_what_it_carries_is_told_apart():
    entry = entry_of()
    numbers = {**entry.numbers, "body.inertia": EntryNumber(0.01, (0.0099, 0.0101), "kg·m²")}
    entry = replace(entry, numbers=numbers)
    heavy = entry.plant.with_values({"body.inertia": 0.03})
    found = library.compare(entry, st.Recording(*recorded(heavy)))
    assert found.differing == ("body.inertia",)
    assert found.message == "agrees with motor in 2 numbers; what it carries differs: body.inertia"


def test_a_drive_that_may_give_nothing_is_held():
    entry = entry_of()
    band = Effect("drive_deadband", {"deadband": Parameter(0.2)})
    entry = replace(entry, plant=replace(entry.plant, effects=(band,)))
    found = library.compare(entry, st.Recording(*recorded(entry.plant)))
    assert found.held == ("drive_deadband",)
    assert "effects.drive_deadband.deadband" not in found.result.parameters
    assert found.result.plant.effects[0].parameters["deadband"].value == 0.2
    assert found.differing == ()
    assert "drive_deadband stays as it is in the entry" in str(found)


def test_the_fit_starts_at_the_entry():
    entry = entry_of()
    found = library.compare(entry, st.Session([st.Recording(*recorded(entry.plant))]))
    assert found.result["coulomb"].start == 0.3
    assert found.result["viscous"].start == 0.02


def test_ones_own_drive_and_load_take_the_place_of_the_entrys():
    own = st.Plant.from_dict(
        {
            "drive": {"input": "current_a", "gain": 0.5},
            "body": {"inertia": {"value": 0.04, "fixed": True}},
            "friction": {"law": "lugre"},
            "sensor": {"counts_per_rev": 4096},
        }
    )
    plant = plant_like(entry_of(), own)
    assert plant.gain == 0.5
    assert plant.body["inertia"].fixed
    assert plant.friction.law == "coulomb"
    assert plant.count > 0.0
    linear = st.Plant.from_dict({"motion": {"kind": "linear"}, "friction": {"law": "coulomb"}})
    with pytest.raises(st.InputError, match=r"is linear, and motor is rotary"):
        plant_like(entry_of(), linear)


# --- the command


def test_the_command_lists_shows_and_writes(tmp_path, capsys):
    assert run(["library"]) == 0
    listed = capsys.readouterr().out
    assert all(path.stem in listed for path in FILES)
    out = tmp_path / "out"
    assert run(["library", "emps", "-o", str(out)]) == 0
    said_of = capsys.readouterr().out
    assert "Janot" in said_of
    assert "python -m benches.library emps" in said_of
    made = st.Plant.load(out / "plant.toml")
    assert made.to_dict() == library.entry("emps").plant.to_dict()
    assert run(["library", "--json", "-o", str(out)]) == 0
    assert len(json.loads(capsys.readouterr().out)) == len(FILES)
    assert len(json.loads((out / "library.json").read_text())) == len(FILES)


def test_the_command_compares_a_unit_in_one_go(tmp_path, capsys):
    plant = library.entry("ur10e_wrist").plant
    worn = plant.with_values({"friction.coulomb": 3.0 * plant.parameters["friction.coulomb"].value})
    time, given, position = recorded(worn, seconds=30.0)
    # As much as moves it.
    factor = 4.0 * worn.parameters["friction.coulomb"].value / plant.gain
    position = worn.simulate(factor * given[:-1], 2e-3, outputs=["position"]).position
    table = np.column_stack([time[1:], factor * given[1:], position])
    head = "time_s,current_a,position_rad"
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header=head, comments="", fmt="%.12g")
    session = tmp_path / "session.toml"
    session.write_text('[[recordings]]\nfile = "run.csv"\n', encoding="utf-8")
    out = tmp_path / "out"
    assert run(["library", "ur10e_wrist", "--session", str(session), "-o", str(out)]) == 0
    text = capsys.readouterr().out
    assert "differs from ur10e_wrist" in text
    kept = json.loads((out / "comparison.json").read_text())
    assert "friction.coulomb" in kept["differing"]
    assert st.Plant.load(out / "plant.toml").friction.law == plant.friction.law


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nosuch"], "no entry 'nosuch'"),
        (["--session", "s.toml"], "no entry is given"),
        (["emps", "--session", "nowhere.toml"], "nowhere.toml: there is no such file"),
    ],
)
def test_the_command_refuses_in_a_sentence(arguments, words, tmp_path, capsys):
    assert run(["library", *arguments, "-o", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert len(told.strip().splitlines()) == 1
    assert words in told
