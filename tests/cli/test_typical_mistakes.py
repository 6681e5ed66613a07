"""What new users mistype and mistake: each is one sentence that says what to do."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.cli.desk import Desk

import stiction as st
from stiction.cli import run

# Name: file to edit ("" for none), old text, new text, words of the command, what it says.
COMMANDS: dict[str, tuple[str, str, str, list[str], str]] = {
    "no file": ("", "", "", ["diagnose"], "SESSION is missing; write stiction diagnose SESSION"),
    "file mistyped": ("", "", "", ["diagnose", "rum.csv"], "did you mean 'run.csv'?"),
    "session mistyped": ("", "", "", ["fit", "sesion.toml"], "did you mean 'session.toml'?"),
    "verb mistyped": ("", "", "", ["diagnos", "run.csv"], "did you mean 'diagnose'?"),
    "option mistyped": ("", "", "", ["diagnose", "run.csv", "--gian", "1"], "mean '--gain'?"),
    "a spreadsheet": ("", "", "", ["diagnose", "notes.xlsx"], "save a spreadsheet or a log as CSV"),
    "plant for session": ("", "", "", ["fit", "plant.toml"], "is a plant file, and a session file"),
    "swapped": ("", "", "", ["simulate", "run.csv", "plant.toml"], "is a recording, and a plant"),
    "session for plant": (
        "", "", "", ["export", "session.toml", "--to", "urdf"], "is a session file, and a plant",
    ),
    "plant for recording": (
        "", "", "", ["simulate", "plant.toml", "plant.toml"], "is a plant file, and a recording",
    ),
    "recording for plant": ("", "", "", ["plan", "run.csv"], "is a recording, and a plant"),
    "one of two": (
        "", "", "", ["simulate", "plant.toml"], "write stiction simulate PLANT RECORDING",
    ),
    "a folder to watch": ("", "", "", ["watch", "run.csv"], "is no folder"),
    "no target": ("", "", "", ["export", "plant.toml"], "write --to and one of bam, c, fmu"),
    "unknown law": ("", "", "", ["diagnose", "run.csv", "--law", "LuGre"], "mean 'lugre'?"),
    "option of another": (
        "", "", "", ["diagnose", "session.toml", "--law", "dahl"], "write it there",
    ),
    "gain with a unit": (
        "", "", "", ["diagnose", "run.csv", "--gain", "0.1Nm/A"], "is not a number",
    ),
    "no such column": (
        "", "", "", ["diagnose", "run.csv", "--columns", "input=current"], "it has t, u, q",
    ),
    "columns turned round": (
        "", "", "", ["diagnose", "run.csv", "--columns", "u=input"], "write input=u",
    ),
    "quantity for role": (
        "", "", "", ["diagnose", "run.csv", "--columns", "torque=u"], "did you mean 'input'?",
    ),
    "no comma": (
        "", "", "", ["diagnose", "run.csv", "-c", "input=u [Nm] position=q [rad]"], "put a comma",
    ),
    "unknown unit": (
        "", "", "", ["diagnose", "run.csv", "--columns", "input=u [Amp]"], "did you mean 'A'?",
    ),
    "recording, singular": (
        "session.toml", "[[recordings]]", "[[recording]]", ["fit", "session.toml"],
        "did you mean 'recordings'?",
    ),
    "wrong file": (
        "session.toml", "run.csv", "rum.csv", ["fit", "session.toml"], "did you mean 'run.csv'?",
    ),
    "wrong plant": (
        "session.toml", '"plant.toml"', '"plants.toml"', ["fit", "session.toml"],
        "did you mean 'plant.toml'?",
    ),
    "no quotes": (
        "session.toml", '"plant.toml"', "plant.toml", ["fit", "session.toml"], "into quotes",
    ),
    "wrong unit": (
        "session.toml", '"Nm"', '"A"', ["fit", "session.toml"], "no unit of input",
    ),
    "unit in words": (
        "session.toml", '"rad"', '"degrees"', ["fit", "session.toml"], "did you mean 'deg'?",
    ),
    "wrong column": (
        "session.toml", '"q"', '"angle"', ["fit", "session.toml"], "the columns here are t, u, q",
    ),
    "validation": (
        "session.toml", "kind =", 'role = "validation"\nkind =', ["fit", "session.toml"],
        "it is called 'select' here",
    ),
    "decimal comma": (
        "plant.toml", "inertia = 0.01", "inertia = 0,01", ["plan", "plant.toml"], "decimal point",
    ),
    "number in quotes": (
        "plant.toml", "inertia = 0.01", 'inertia = "0.01"', ["plan", "plant.toml"],
        "leave out the quotes",
    ),
    "mass": (
        "plant.toml", "inertia = 0.01", "mass = 0.01", ["plan", "plant.toml"],
        "it is called inertia here",
    ),
    "symbol": (
        "plant.toml", "viscous = 0.05", "sigma2 = 0.05", ["plan", "plant.toml"],
        "it is called 'viscous' here",
    ),
    "input by quantity": (
        "plant.toml", '"torque_nm"', '"torque"', ["plan", "plant.toml"], "mean 'torque_nm'?",
    ),
    "help as a verb": ("", "", "", ["help"], "did you mean '--help'?"),
    "an ending left out": ("", "", "", ["diagnose", "run"], "did you mean 'run.csv'?"),
    "effect among laws": ("", "", "", ["laws", "stribeck"], "see stiction effects stribeck"),
    "law among effects": ("", "", "", ["effects", "lugre"], "see stiction laws lugre"),
    "laws with commas": ("", "", "", ["compare", "lugre,dah"], "law 'dah' is unknown (did you"),
    "effects with commas": (
        "", "", "", ["diagnose", "session.toml", "--without", "cogging,stribek"],
        "there is no effect stribek (did you mean 'stribeck'?)",
    ),
    "another shell": ("", "", "", ["completion", "powershel"], "did you mean 'powershell'?"),
    "an effect for a law": (
        "", "", "", ["diagnose", "run.csv", "--law", "stribeck"], "is an effect and no law",
    ),
    "an option that is like none": (
        "", "", "", ["plan", "plant.toml", "--limit", "5"], "there is no option --limit; there are",
    ),
    "an address": (
        "", "", "", ["diagnose", "https://example.org/run.csv"], "download the file and name the",
    ),
    "findings for a recording": (
        "", "", "", ["diagnose", "findings.json"], "holds what a diagnosis found",
    ),
    "a robot's description": (
        "", "", "", ["diagnose", "arm.urdf"], "stiction init arm.urdf LOGS drafts its session",
    ),
    "a pattern that finds nothing": ("", "", "", ["diagnose", "log*.csv"], "no such file"),
    "a column twice": (
        "", "", "", ["diagnose", "run.csv", "--columns", "input=u, input=q"], "drop one",
    ),
    "targets with commas": (
        "", "", "", ["export", "plant.toml", "--to", "c,simulink"], "to = 'simulink' is unknown",
    ),
    "an empty folder": ("", "", "", ["diagnose", "empty"], "no recording in this folder"),
    "results into a file": ("", "", "", ["fit", "run.csv", "-o", "run.csv"], "another one with"),
    "below 0": (
        "plant.toml", "coulomb = 0.2", "coulomb = -0.2", ["plan", "plant.toml"], "out of bounds",
    ),
    "a recording for a verb": ("", "", "", ["run.csv"], "write for instance stiction diagnose run"),
    "a folder for a verb": ("", "", "", ["empty"], "stiction watch empty"),
    "a verb of others": ("", "", "", ["identify", "run.csv"], "did you mean 'fit'?"),
    "a list": ("", "", "", ["list"], "did you mean 'laws'?"),
    "an option of others": (
        "", "", "", ["diagnose", "session.toml", "--jobs", "2"], "did you mean '--threads'?",
    ),
    "two laws": ("", "", "", ["fit", "run.csv", "--law", "coulomb,lugre"], "a plant has one; give"),
    "a law and an effect": (
        "", "", "", ["diagnose", "run.csv", "--law", "coulomb+stribeck"], "tries every effect by",
    ),
    "an effect for the law of a plant": (
        "plant.toml", '"coulomb"', '"stribeck"', ["plan", "plant.toml"], "under [[effects]]",
    ),
    "a law for an effect": (
        "plant.toml", '"torque_bias"', '"lugre"', ["plan", "plant.toml"],
        "is a law and no effect; write it under [friction]",
    ),
    "a part of a name": (
        "plant.toml", '"torque_bias"', '"bias"', ["plan", "plant.toml"], "mean 'torque_bias'?",
    ),
    "a kind of motion of others": (
        "plant.toml", '"rotary"', '"rotational"', ["plan", "plant.toml"], "did you mean 'rotary'?",
    ),
    "translational": (
        "plant.toml", '"rotary"', '"translational"', ["plan", "plant.toml"], "mean 'linear'?",
    ),
    "a unit for an input": (
        "plant.toml", '"torque_nm"', '"A"', ["plan", "plant.toml"], "did you mean 'current_a'?",
    ),
    "a number with its unit": (
        "plant.toml", "inertia = 0.01", 'inertia = "0.01 kg m2"', ["plan", "plant.toml"],
        "write it alone and in SI units",
    ),
    "no table": (
        "plant.toml", "[motion]", "inertia = 0.01\n[motion]", ["plan", "plant.toml"],
        "'inertia' stands outside a table; write it under [body]",
    ),
    "a colon": (
        "plant.toml", "inertia = 0.01", '"inertia": 0.01', ["plan", "plant.toml"],
        "write name = value, without a colon",
    ),
    "a semicolon": (
        "plant.toml", "gain = 1.0", "gain = 1.0;", ["plan", "plant.toml"], "leave out the semi",
    ),
    "a backslash": (
        "session.toml", '"run.csv"', '"C:\\data\\run.csv"', ["fit", "session.toml"],
        "write / in place of",
    ),
    "path for file": (
        "session.toml", 'file = "run.csv"', 'path = "run.csv"', ["fit", "session.toml"],
        "did you mean 'file'?",
    ),
    "a role behind its column": (
        "session.toml", 'time = "t"', 't = "time"', ["fit", "session.toml"], 'write time = "t"',
    ),
    "per cent": (
        "", "", "", ["diagnose", "run.csv", "--columns", "input=u [%]"], "share of a rated value",
    ),
    "a unit without brackets": (
        "", "", "", ["diagnose", "run.csv", "--columns", "position=q deg"], "position=q [deg]",
    ),
    "findings for a fit": ("", "", "", ["fit", "findings.json"], "holds what a diagnosis found"),
    "a plant for a draft": (
        "", "", "", ["init", "plant.toml", "-o", "new"], "is a TOML file, as plants and sessions",
    ),
    "a recording for an import": (
        "", "", "", ["import", "run.csv", "-o", "new"], "parameters of better-actuator-models",
    ),
    "one row": ("", "", "", ["simulate", "plant.toml", "one.csv"], "has 1 row, and at least 200"),
}  # fmt: skip


@pytest.mark.parametrize("name", COMMANDS)
def test_a_mistake_on_the_command_line_is_one_helpful_sentence(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file, old, new, words, told = COMMANDS[name]
    desk = Desk(tmp_path)
    (tmp_path / "notes.xlsx").write_bytes(b"PK")
    for other in ("findings.json", "arm.urdf"):
        (tmp_path / other).write_text("{}", encoding="utf-8")
    (tmp_path / "empty").mkdir()
    (tmp_path / "one.csv").write_text("time_s,torque_nm,position_rad\n0,1,0\n", encoding="utf-8")
    if file:
        desk.edit(tmp_path / file, old, new)
    monkeypatch.chdir(tmp_path)
    assert run(words) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert told in said.err, said.err


def motor() -> st.Motor:
    return st.Motor(0.0076, friction=st.FrictionModel("coulomb", coulomb=0.2))


def recording() -> st.Recording:
    rows = np.arange(300.0)
    return st.Recording(1e-3 * rows, np.sin(rows), np.cos(rows))


CALLS: dict[str, tuple[Callable[[], object], str]] = {
    "symbol": (lambda: st.FrictionModel("lugre", sigma0=1e5), "called 'initial_stiffness' here"),
    "torque for force": (lambda: st.FrictionModel("coulomb", Tc=0.2), "called 'coulomb' here"),
    "law mistyped": (lambda: st.FrictionModel("lugree"), "did you mean 'lugre'?"),
    "law by name": (lambda: st.laws()["Lugre"], "did you mean 'lugre'?"),
    "set in place": (
        lambda: motor().friction.parameters.update(coulomb=3.0), "make another one, as in",
    ),
    "array to a step": (
        lambda: motor().friction.step(np.ones(3), 1e-3), "simulate(velocity, dt) takes the samples",
    ),
    "no friction": (lambda: st.Motor(0.0076), "friction is missing; give a FrictionModel"),
    "law for friction": (lambda: st.Motor(0.0076, friction="coulomb"), "no FrictionModel; give"),
    "milliseconds": (lambda: motor().simulate(np.ones(5), 1e7), "at most 1e6"),
    "no time step": (lambda: motor().simulate(np.ones(5), 0.0), "a positive number of seconds"),
    "words for numbers": (lambda: motor().simulate(["a", "b"], 1e-3), "is not an array of numbers"),
    "swapped": (lambda: st.fit(recording(), st.Session([recording()])), "give a Plant"),
    "path for a session": (lambda: st.diagnose("session.toml"), "give what stiction.load("),
    "session without a plant": (lambda: st.fit(st.Session([recording()])), "plant"),
    "a path among recordings": (
        lambda: st.Session(["run.csv"]), "give what stiction.load('run.csv') returns",
    ),
    "several files at once": (
        lambda: st.load(["a.csv", "b.csv"]), "Session([load(a), load(b)])",
    ),
    "a table for a file": (lambda: st.load({"friction": {}}), "Plant.from_dict(...)"),
    "a name for an effect": (
        lambda: st.Plant.from_dict({"friction": {"law": "coulomb"}, "effects": ["stribeck"]}),
        '"effects": [{"name": "stribeck"}]',
    ),
    "findings": (lambda: st.load("findings.json"), "holds what a diagnosis found"),
    "unequal lengths": (lambda: st.Recording([0.0, 1.0], [1.0], [0.0, 0.0]), "1"),
    "figure for axes": (lambda: motor().simulate(np.ones(5), 1e-3).plot(3), "plot: ax"),
    "speed and friction apart": (lambda: st.fit_curve([1.0, 2.0], [1.0]), "of one length"),
    "torque for current": (
        lambda: motor().simulate(torque=np.ones(5), dt=1e-3),
        "'torque' is unknown; it is called 'current' here (input of each sample",
    ),
    "voltage for current": (
        lambda: motor().simulate(voltage=np.ones(5), dt=1e-3), "it is called 'current' here",
    ),
    "times for dt": (
        lambda: motor().simulate(np.ones(5), time=np.arange(5.0)),
        "it is called 'dt' here (duration of a sample in s",
    ),
    "no dt": (lambda: motor().simulate(np.ones(5)), "dt is missing (duration of a sample in s"),
    "dt before the input": (
        lambda: motor().simulate(1e-3, np.ones(5)), "dt is an array: the order is current, dt",
    ),
    "dt before the velocity": (
        lambda: st.FrictionModel("lugre").simulate(1e-3, np.ones(5)),
        "dt is an array: the order is velocity, dt",
    ),
    "an array for dt": (
        lambda: st.FrictionModel("lugre").simulate(np.ones(5), np.ones(5)), "dt is no number",
    ),
    "stamps for dt": (
        lambda: motor().simulate(np.ones(5), np.arange(5.0)),
        "dt rises from 0 to 4, so these are stamps: give durations, as numpy.diff does",
    ),
    "a level by place": (
        lambda: st.FrictionModel("coulomb", 0.3), "FrictionModel('coulomb', coulomb=0.3)",
    ),
    "no law": (lambda: st.FrictionModel(coulomb=0.3), "the law is missing; give its name first"),
    "a number for a law": (lambda: st.FrictionModel(3), "3 is no law; give a name"),
    "a name that is not there": (lambda: st.laws()["stribeck"], "there is no law 'stribeck'"),
    "speed for velocity": (
        lambda: st.FrictionModel("lugre").simulate(speed=np.ones(5), dt=1e-3),
        "it is called 'velocity' here",
    ),
    "position for velocity": (
        lambda: st.FrictionModel("lugre").simulate(position=np.ones(5), dt=1e-3),
        "it takes velocity, dt, load",
    ),
    "a symbol for inertia": (
        lambda: st.Motor(J=0.1), "it is called 'inertia' here (kg·m² (rotary) or kg (linear))",
    ),
    "mass": (lambda: st.Motor(mass=0.1), "it is called 'inertia' here"),
    "current of a recording": (
        lambda: st.Recording(time=[0.0], current=[1.0], position=[0.0]),
        "it is called 'input' here (A, V, N·m or N)",
    ),
    "friction by place": (
        lambda: st.Motor(0.1, st.FrictionModel("lugre")),
        "torque_constant is a FrictionModel, and that belongs to friction; write friction=",
    ),
    "a key outside its table": (
        lambda: st.Plant.from_dict({"law": "coulomb"}), 'in Python "friction": {"law": ...}',
    ),
    "an effect by its key": (
        lambda: st.Plant.from_dict(
            {"friction": {"law": "coulomb"}, "effects": [{"stribeck": {"excess": 0.1}}]}
        ),
        'name is missing; write name = "stribeck"',
    ),
    "an effect for a law": (
        lambda: st.fit_curve(np.arange(1.0, 9.0), np.ones(8), "Stribeck"),
        "'stribeck' is an effect",
    ),
    "a law for an effect": (lambda: st.effects()["lugre"], "('lugre' is a law)"),
    "a record of 0.3 s": (
        lambda: st.fit(
            st.Session([recording()], plant=st.Plant.from_dict({
                "drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"},
            }))
        ),
        "300 samples are too few for a kernel of 0.299 s, over which the effort is averaged",
    ),
    "a target by its name": (
        lambda: st.Plant.from_dict({"friction": {"law": "coulomb"}}).export(target="c"),
        "it is called 'to' here",
    ),
    "nothing to fit": (lambda: st.fit(), "plant is missing"),
    "law of a diagnosis": (
        lambda: st.diagnose(st.Session([recording()]), law="lugre"), "called 'laws' here",
    ),
    "recordings, singular": (lambda: st.Session(recording=[recording()]), "'recordings' here"),
    "jobs for threads": (
        lambda: st.diagnose(None, st.Session([recording()]), n_jobs=2), "called 'threads' here",
    ),
    "a symbol that is looked up": (
        lambda: motor().friction.parameters["sigma0"], "'sigma0' is not there; there are coulomb",
    ),
    "friction that drives": (
        lambda: st.fit_curve(np.arange(1.0, 9.0), -np.ones(8)), "turn one of the two signs round",
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    ("where", "name", "told"),
    [
        (st.Session, "open", "stiction.load(path) reads session, plant and recording files"),
        (st.Session, "load", "stiction.load(path) reads"),
        (st.Plant, "from_file", "stiction.load(path) reads"),
        (st.Recording, "from_csv", "stiction.load(path) reads"),
        (st.Plant, "from_dct", "stiction.load(path) reads"),
        (st.Plant, "simulat", "did you mean 'simulate'?"),
        (st.laws(), "lugre", "write laws()['lugre']"),
        (st.effects(), "cogging", "write effects()['cogging']"),
        (st, "diagnos", "did you mean 'diagnose'?"),
        (st, "Sesion", "did you mean 'Session'?"),
    ],
)
def test_a_name_that_is_not_there_is_answered_with_one_that_is(
    where: object, name: str, told: str
) -> None:
    with pytest.raises(AttributeError) as refused:
        getattr(where, name)
    assert told in str(refused.value)


@pytest.mark.parametrize("name", CALLS)
def test_a_mistake_in_python_is_one_helpful_sentence(name: str) -> None:
    call, told = CALLS[name]
    with pytest.raises(st.InputError) as refused:
        call()
    assert told in str(refused.value), str(refused.value)
    assert "\n" not in str(refused.value)
