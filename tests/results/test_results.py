"""Results: frozen, named as the interface says, and able to travel to another process."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from tests.reference.coulomb_reference import simulate_coulomb

import stiction as st
from stiction._support.frozen import ByPath, Frozen
from stiction.closed_loop import ClosedLoop
from stiction.compare.result import Comparison, Row
from stiction.diagnosis.records import CandidateRow, LawRow
from stiction.errors import UnknownName
from stiction.paper.result import Number, Result
from stiction.plan.result import Plan
from stiction.residual.effort import effort_residual, free_run

DT = 1e-3
AGAIN = [copy.deepcopy, lambda item: pickle.loads(pickle.dumps(item))]


@cache
def session() -> st.Session:
    """Two short recordings of an independent Coulomb machine, N·m and rad."""
    rng = np.random.default_rng(0)
    time = np.arange(9000) * DT
    recordings = []
    for role in ("train", "test"):
        effort = sum(
            0.45 * np.sin(2 * np.pi * f * time + rng.uniform(0, 6)) for f in (0.4, 1.1, 2.3)
        )
        run = simulate_coulomb(
            effort[:-1], DT, inertia=0.0076, coulomb=0.3, breakaway=0.3, viscous=0.05
        )
        position = np.concatenate([[0.0], run["position"]])
        measured = effort + 2e-3 * rng.standard_normal(len(time))
        recordings.append(st.Recording(time, measured, np.round(position / 2e-5) * 2e-5, role=role))
    return st.Session(recordings, plant(), {1: 0})


@cache
def plant() -> st.Plant:
    return st.Plant.from_dict(
        {
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"inertia": 0.007},
            "friction": {"law": "coulomb", "coulomb": {"value": 0.2, "min": 0.0}},
            "effects": [
                {"name": "cogging", "cosine": {"value": 0.0, "fixed": True}, "order": 12.0}
            ],
        }
    )


@cache
def fitted() -> st.FitResult:
    return st.fit(plant(), session())


@cache
def diagnosed() -> st.Diagnosis:
    # Which effects are tried does not matter here, and each takes its time.
    without = [effect.name for effect in st.effects()][1:]
    return st.diagnose(plant(), session(), without=without, surrogates=4)


def ensemble_run() -> st.EnsembleRun:
    motor = st.Motor(0.0076, friction=st.FrictionModel("coulomb"))
    return st.simulate_ensemble(motor, np.ones(5), 1e-3, parameters={"coulomb": [0.1, 0.2]})


@pytest.mark.long
@pytest.mark.parametrize("again", AGAIN)
def test_plants_sessions_and_results_come_back_from_copies_and_pickles(again) -> None:
    assert again(plant()) == plant()
    assert again(session()).hashes == session().hashes
    assert again(session()).replicates == {1: 0}
    assert again(fitted()).to_dict() == fitted().to_dict()
    assert again(diagnosed()).to_json() == diagnosed().to_json()
    assert again(diagnosed()).plot().axes
    assert np.array_equal(again(ensemble_run()).position, ensemble_run().position)


def test_a_fit_runs_in_another_process() -> None:
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=spawn) as pool:
        found = pool.submit(st.fit, plant(), session()).result()
    assert found.to_dict() == fitted().to_dict()


def test_the_bare_last_word_of_a_path_does_where_it_is_unique() -> None:
    found = fitted()
    assert found.parameters["inertia"] is found.parameters["body.inertia"] is found["inertia"]
    assert found.stderr["inertia"] == found.parameters["body.inertia"].stderr
    assert list(found.stderr) == list(found.parameters)
    assert plant().parameters["inertia"].value == 0.007
    baseline = diagnosed().baseline
    assert baseline is not None
    assert baseline.parameters["inertia"] is baseline.parameters["body.inertia"]
    values = ByPath({"friction.a": 1, "effects.x.a": 2, "body.b": 3})
    assert values.get("b") == 3
    assert "a" not in values  # the word alone may be either
    assert values.get("c") is None
    with pytest.raises(st.InputError, match=r"'a' may be friction\.a, effects\.x\.a; give the"):
        values["a"]
    with pytest.raises(KeyError, match="parameter 'c' is unknown"):
        values["c"]


def test_a_diagnosis_is_not_saved_nowhere() -> None:
    with pytest.raises(st.InputError, match="None is not a path"):
        diagnosed().save(None)  # type: ignore[arg-type]


def test_a_cold_start_that_is_doubtful_is_told_in_the_sentence_and_among_the_checks() -> None:
    first, second = session().recordings
    without = [effect.name for effect in st.effects()][1:]
    found = st.diagnose(plant(), [first, second.from_cold()], without=without, surrogates=4)
    assert "recording 2: it begins cold, 0.001 s after the one before it ended" in found.sentence
    (told,) = (c for c in found.data["checks"] if c["name"] == "doubtful cold start")
    assert told["recording"] == "recording 2"
    assert "cold" not in diagnosed().sentence


def test_a_diagnosis_has_what_findings_json_has() -> None:
    found = diagnosed()
    content = found.to_dict()
    assert all(hasattr(found, name) for name in content)
    assert found.schema == content["schema"] == 1
    assert found.baseline is not None
    assert all(hasattr(found.baseline, name) for name in content["baseline"])
    assert found.baseline.law == "coulomb"
    assert found.baseline.effects == ("cogging",)
    for row in (LawRow("dahl", None, ""), CandidateRow("cogging", None, None, None, "")):
        assert all(hasattr(row, name) for name in row.to_dict())


@pytest.mark.parametrize(
    "mapping",
    [
        lambda: fitted().parameters,
        lambda: fitted().starts,
        lambda: diagnosed().data,
        lambda: plant().body,
        lambda: ensemble_run().columns,
        lambda: session().replicates,
    ],
)
def test_what_a_result_holds_by_name_cannot_be_changed(mapping) -> None:
    with pytest.raises(TypeError):
        mapping()["inertia"] = 1.0
    with pytest.raises(AttributeError, match="frozen"):
        mapping()._items = {}


def test_what_a_frozen_mapping_was_made_of_may_change() -> None:
    made_of = {"a": 1}
    frozen = Frozen(made_of)
    made_of["a"] = 2
    assert frozen == {"a": 1}
    assert frozen | {"b": 3} == {"a": 1, "b": 3}


def test_a_run_of_many_machines_shows_itself() -> None:
    shown = ensemble_run()._repr_html_()
    assert "2 machines ran to the end" in shown
    assert "<th>position</th><td>(2, 5)</td>" in shown


def test_a_share_that_is_not_known_is_not_shown() -> None:
    assert ", r² " in str(fitted())
    assert "r²" not in str(replace(fitted(), r2=float("nan")))


def test_a_trajectory_that_holds_nothing_yet_has_no_columns() -> None:
    # As while it is unpickled: asking for what it is made of must come to an end.
    empty = st.Trajectory.__new__(st.Trajectory)
    with pytest.raises(AttributeError, match="has no column"):
        _ = empty.position


def test_columns_of_a_trajectory_cannot_be_written_to_and_those_of_out_can() -> None:
    motor = st.Motor(0.0076, friction=st.FrictionModel("coulomb"))
    kept = {"position": np.zeros(5), "velocity": np.zeros(5)}
    run = motor.simulate(np.ones(5), np.full(5, 1e-3), out=kept)
    for values in (run.position, run["position"], run.columns["position"], run.dt):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 1.0
    kept["position"][0] = 3.0
    assert run.position[0] == 3.0
    motor.reset()
    again = motor.simulate(np.ones(5), 1e-3, out=kept)
    assert np.shares_memory(again.position, kept["position"])


def test_counts_that_go_on_from_run_to_run_say_so() -> None:
    motor = st.Motor(0.0076, friction=st.FrictionModel("coulomb"))
    pushed = np.tile([2.0, -2.0, 0.0], 20)
    first, second = motor.simulate(pushed, 1e-2), motor.simulate(pushed, 1e-2)
    assert "since" not in first.message
    assert second.statistics["breakaways"] > first.statistics["breakaways"]
    assert second.message.endswith("stops since the last reset")
    assert "since" in pickle.loads(pickle.dumps(second)).message
    motor.reset()
    assert motor.simulate(pushed, 1e-2).message == first.message


def test_a_chunk_without_rows_shows_itself() -> None:
    motor = st.Motor(0.0076, friction=st.FrictionModel("coulomb"))
    (part,) = st.stream(motor, [np.ones(5)], 1e-3, every=10)
    assert len(part) == 0
    assert part.success
    assert "0 samples" in part._repr_html_()
    assert "0 samples" in repr(part)


def test_a_name_that_is_not_there_is_the_same_error_everywhere() -> None:
    run = st.Motor(0.0076, friction=st.FrictionModel("coulomb")).simulate(np.ones(5), 1e-3)
    row = Row("coulomb", 0.3, 0.0, True, {}, 5.0, 1.0)
    made = Plan(plant(), ())
    for found in (run, made, Comparison((), (row,), 0, 0), ensemble_run()):
        with pytest.raises(UnknownName, match="no such") as raised:
            found["no such"]
        assert isinstance(raised.value, KeyError)
        assert isinstance(raised.value, st.InputError)


def test_what_is_compared_says_success_and_message() -> None:
    recording = session().recordings[0]
    free, effort = free_run(plant(), recording), effort_residual(plant(), recording)
    position = np.zeros(3)
    loop = ClosedLoop(position, position, position, position, position, "rad", None)
    row = Row("coulomb", 0.3, 0.0, True, {}, 5.0, 1.0)
    compared = Comparison((), (row,), 0, 0)
    read = Result(title="t", source="s", shows="w", numbers={"a": Number(1.0, "1")})
    for found in (free, effort, loop, compared, read):
        assert found.success, found
        assert found.message
        assert found._repr_html_()
    nothing = np.full(3, np.nan)
    lost = (
        replace(free, trajectory=st.Trajectory({"position": nothing}, 1e-3, 3, 0.0, {})),
        replace(free, measured=np.full_like(free.measured, np.nan)),
        replace(effort, model=np.full_like(effort.model, np.nan)),
        replace(loop, simulated=nothing),
        replace(compared, rows=(replace(row, level=float("nan")),)),
        replace(read, numbers={"a": Number(float("inf"), "1")}),
    )
    for found in lost:
        assert not found.success
        assert "finite" in found.message
