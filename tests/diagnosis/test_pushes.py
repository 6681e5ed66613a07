"""Pushes from outside: told by their time, left out, and named as no effect of the machine."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from tests.reference.coulomb_reference import simulate_coulomb

import stiction as st
from stiction.diagnosis.findings.words import push_words
from stiction.fitting.pushes import Watch
from stiction.fitting.rows import Push
from stiction.recording.blocks import Part
from stiction.residual.weak_form import WeakForm

DT, SECONDS = 1e-3, 10.0
TRUE = {"inertia": 0.006, "coulomb": 0.25, "viscous": 0.02}
COUNT = 2.0 * math.pi / 2**18
PLANT = st.Plant.from_dict({"drive": {"input": "torque_nm"}, "friction": {"law": "coulomb"}})
Times = tuple[tuple[float, float, float], ...]


def recorded(seed: int, pushes: Times = (), *, law: float = 0.0, **labels: object) -> st.Recording:
    """An independent dry machine that hands push (from, to, N·m) without the recorder's knowledge.

    ``law`` is a share by which friction grows at some places: an effect of the machine.
    """
    source = np.random.default_rng(seed)
    time = np.arange(round(SECONDS / DT)) * DT
    waves = [0.22 * np.sin(w * time + source.uniform(0, 6)) for w in (2.0, 5.3, 13.0)]
    effort = np.sum(waves, axis=0)
    hands = np.zeros_like(time)
    for start, end, size in pushes:
        inside = (time >= start) & (time < end)
        # Thrown and caught again.
        hands[inside] = size * np.sin(2.0 * np.pi * (time[inside] - start) / (end - start))
    run = simulate_coulomb(
        (effort + hands)[:-1],
        DT,
        inertia=TRUE["inertia"],
        coulomb=TRUE["coulomb"],
        breakaway=TRUE["coulomb"] * (1.0 + law),
        viscous=TRUE["viscous"],
    )
    position = np.concatenate([[0.0], run["position"]])
    measured = effort + 0.004 * source.standard_normal(len(time))
    return st.Recording(time, measured, np.round(position / COUNT) * COUNT, **labels)


@pytest.fixture(scope="module")
def pushed() -> list[st.Recording]:
    return [
        recorded(1, ((4.2, 4.9, 1.8),), role="train"),
        recorded(2, role="train"),
        recorded(3, ((7.0, 7.8, -1.6),), role="select"),
        recorded(4, ((2.5, 3.1, 2.0),), role="test"),
    ]


def times(found: st.Diagnosis) -> dict[str, tuple[float, float]]:
    told = [check for check in found.data["checks"] if check["name"] == "push"]
    return {
        check["recording"]: tuple(
            float(word) for word in check["what"].split() if word[:1].isdigit()
        )  # type: ignore[misc]
        for check in told
    }


def test_a_hand_is_told_by_its_time_and_named_as_nothing_else(pushed: list[st.Recording]) -> None:
    found = st.diagnose(PLANT, pushed, surrogates=6)
    assert found.effects == ()
    told = times(found)
    for name, start, end in (("1", 4.2, 4.9), ("3", 7.0, 7.8), ("4", 2.5, 3.1)):
        first, last = told[f"recording {name}"]
        assert first == pytest.approx(start, abs=0.4)
        assert last == pytest.approx(end, abs=0.4)
    assert len(told) == 3
    assert "omething pushed the machine from" in found.sentence
    assert "because the drive, as the plant has it, did not make that motion" in found.sentence


def test_pushes_of_one_recording_are_told_in_one_sentence() -> None:
    pushes = [
        Push(1, 2.0, 3.0),
        Push(1, 5.0, 6.5, sure=False),
        Push(0, 1.0, 2.0),
        Push(0, 7.0, 8.0),
    ]
    told = push_words(pushes, ("a.csv", "b.csv"))
    assert told.startswith(
        "Something pushed the machine from 2.0 s to 3.0 s in b.csv and from 1.0 s to 2.0 s in "
        "a.csv; these rows are left out, because the drive, as the plant has it, did not make that "
        "motion. Something pushed the machine, or it does there what it does nowhere else, from "
        "5.0 s to 6.5 s in "
        "b.csv; these rows are left out, because nothing shows that the drive made that motion. "
    )
    assert told.endswith("1 more stands among the data checks.")
    assert push_words([], ()) == ""


def test_a_fit_leaves_the_hand_out_and_finds_the_machine(pushed: list[st.Recording]) -> None:
    fitted = st.fit(PLANT, pushed)
    for name, value in TRUE.items():
        assert fitted[name].value == pytest.approx(value, rel=0.1 if name == "viscous" else 0.02)
    assert fitted.split.count("something pushed the machine") == 3


def test_nobody_pushes_where_the_machine_itself_lacks_something() -> None:
    session = [recorded(k, law=0.6, role=r) for k, r in enumerate(("train", "select", "test"))]
    assert "pushed" not in st.fit(PLANT, session).split


def test_what_comes_all_the_time_is_no_push() -> None:
    often = tuple((0.7 * k + 0.3, 0.7 * k + 0.6, 1.8) for k in range(13))
    assert "pushed" not in st.fit(PLANT, [recorded(5, often)]).split


def helped(recording: st.Recording, hands: Times, *, seconds: float = SECONDS) -> st.Recording:
    """The same motion, a part of which hands did for the drive."""
    rows = round(seconds / DT)
    time = recording.time[:rows]
    assert recording.input is not None
    assert recording.position is not None
    effort = recording.input[:rows].copy()
    for start, end, size in hands:
        effort[(time >= start) & (time < end)] -= size
    return st.Recording(time, effort, recording.position[:rows])


def test_a_weak_hand_that_stays_is_told_where_friction_is_known(pushed: list[st.Recording]) -> None:
    still = pushed[1]
    ((start, end),), *others = watched(PLANT, [helped(still, ((7.0, 9.0, 0.6),)), still])
    assert (start, end) == pytest.approx((7.0, 9.0), abs=0.3)
    assert others == [[]]


def test_what_would_be_left_out_of_a_recording_counts_as_a_whole(
    pushed: list[st.Recording],
) -> None:
    still, hands = pushed[1], ((0.8, 1.1, 2.5), (1.7, 2.0, 2.5), (2.6, 2.9, 2.5))
    assert watched(PLANT, [still, helped(still, hands, seconds=3.6)]) == [[], []]


@pytest.fixture
def pendulum(shared_data: Path) -> dict[str, list[tuple[float, float]]]:
    """Times in which something pushed, of each run; all of them learnt from."""
    paths = sorted((shared_data / "dfki_simple_pendulum").glob("*.csv"))
    columns = {"time": "time", "position": "position"}
    loaded = [
        st.Recording.load(
            path, columns | {"input": {"name": "torque", "unit": "Nm"}}, motion="rotary"
        )
        for path in paths
    ]
    seen = watched(PLANT, loaded)
    return {path.stem: seen[k] for k, path in enumerate(paths)}


def watched(plant: st.Plant, session: list[st.Recording]) -> list[list[tuple[float, float]]]:
    forms = [WeakForm(plant, each) for each in session]
    parts = [Part(k, 0, len(each)) for k, each in enumerate(session)]
    pushes = Watch(plant, forms, session, parts).look(parts)
    return [[(p.start, p.end) for p in pushes if p.recording == k] for k in range(len(session))]


# Where inertia, weight and friction need what the motor did not give, s, as far as it is told. Some
# hands are missed with all runs as one machine: energy_shaping_1kg 11.6 to 12.9, with another mass
# than the others, sac 6.5 to 7.6 and torque_limited_swingup 4.2 to 5.0, both weak.
HANDS = {
    "direct_collocation": (),
    "energy_shaping": ((6.8, 7.6), (11.2, 12.3), (15.95, 16.2)),
    "energy_shaping_1kg": ((17.0, 17.35),),
    "pd_system_identification": (),
    "sac": ((10.2, 10.9), (13.9, 15.0), (17.95, 18.2), (22.0, 22.25)),
    "torque_limited_swingup": ((6.75, 7.15), (10.0, 11.8)),
}


@pytest.mark.parametrize("run", HANDS)
def test_hands_at_a_pendulum_are_told_from_its_motor(
    pendulum: dict[str, list[tuple[float, float]]], run: str
) -> None:
    assert len(pendulum[run]) == len(HANDS[run])
    for (first, last), (start, end) in zip(HANDS[run], pendulum[run], strict=True):
        assert min(last, end) - max(first, start) > 0.75 * (last - first)


def test_nobody_pushes_a_screw_or_a_mounting_head(shared_data: Path) -> None:
    for name, columns, gain in (
        ("emps/DATA_EMPS.mat", ("t", "vir", "qm"), 35.15065),
        ("pick_and_place/headdata_first_10s.mat", ("t", "u", "y"), 1.0),
    ):
        time, volts, position = columns
        recording = st.Recording.load(
            shared_data / name,
            {"time": time, "input": {"name": volts, "unit": "V"}, "position": position},
            motion="linear",
        )
        plant = {"motion": {"kind": "linear"}, "drive": {"gain": gain}}
        plant |= {"friction": {"law": "coulomb"}}
        assert watched(st.Plant.from_dict(plant), [recording]) == [[]]
