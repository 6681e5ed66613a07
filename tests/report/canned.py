"""Small diagnoses of each kind, made by hand, for what is written and drawn of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import stiction as st
from stiction.diagnosis import Diagnosis
from stiction.diagnosis.adequacy.coordinates import COORDINATES
from stiction.diagnosis.adequacy.omnibus import Rest, View
from stiction.diagnosis.data.gain import Gain
from stiction.diagnosis.findings.bets import Bet, Bets
from stiction.diagnosis.findings.pictures import Pictures, Stretch, Trace
from stiction.diagnosis.records import (
    Advice,
    CandidateRow,
    Cause,
    LawRow,
    ModelSummary,
    Unexplained,
    Verdict,
)
from stiction.fitting.result import FitParameter

FITTED: tuple[Verdict, ...] = ("unexplained", "ambiguous", "missing_effect", "nothing_missing")
VERDICTS: tuple[Verdict, ...] = (*FITTED, "not_testable", "data_fault")
# Each further coordinate costs time and shows nothing new.
SEEN = {"speed", "position", "effort", "distance since the reversal", "time since the reversal"}


def plant(*, effects: bool = False) -> st.Plant:
    table = {
        "motion": {"kind": "rotary"},
        "drive": {"input": "torque_nm"},
        "body": {"inertia": 0.0076},
        "friction": {"law": "coulomb", "coulomb": 0.3, "viscous": 0.05},
    }
    if effects:
        table["effects"] = [{"name": "torque_bias", "bias": 0.02}]
    return st.Plant.from_dict(table)


def parameter(value: float, half: float, unit: str, at_bound: str = "") -> FitParameter:
    return FitParameter(value, half / 2, (value - half, value + half), unit, at_bound, value)


def model(*, effects: bool, held_out: float | None = 0.02) -> ModelSummary:
    own = {
        "body.inertia": parameter(0.0076, 0.0002, "kg·m²"),
        "friction.coulomb": parameter(0.3, 0.004, "N·m", "lower"),
        "friction.viscous": parameter(0.001, 0.02, "N·m·s/rad"),
    }
    if effects:
        own["effects.torque_bias.bias"] = parameter(0.02, 0.003, "N·m")
    return ModelSummary(
        plant=plant(effects=effects),
        parameters=own,
        unit="N·m",
        train_rms=0.01 if effects else 0.02,
        select_rms=0.011 if effects else 0.021,
        heldout_rms=held_out,
        train_relative=0.03 if effects else 0.06,
        heldout_relative=None if held_out is None else 0.03,
        noise_floor_rms=0.008,
        remarks=("friction.viscous is not determined by these data: its standard error 0.01",),
    )


def rest(size: float) -> Rest:
    """Views with repeated places, zeros and many decades, as machines that run steadily give."""
    at = np.linspace(-1.0, 1.0, 24).round(1)
    places = {
        "speed": np.geomspace(1e-4, 10.0, 24),
        "distance since the reversal": np.concatenate([[0.0], np.geomspace(1e-7, 1e-2, 23)]),
        "time since the reversal": np.full(24, 0.5),
    }
    return Rest(
        tuple(
            View(
                coordinate,
                places.get(coordinate.name, at),
                size * np.sin(3.0 * at + k),
                np.full(24, -0.002),
                np.full(24, 0.002),
                share=size * (12 - k),
                threshold=0.02 - 0.01 * k,
                size=0.02,
            )
            for k, coordinate in enumerate(COORDINATES)
            if coordinate.name in SEEN
        )
    )


def pictures(*, effects: bool, names: tuple[str, ...]) -> Pictures:
    time = np.arange(4000) * 0.005
    gap = np.where((time > 4.0) & (time < 6.0), np.nan, 1.0)
    noise = 0.008 * np.random.default_rng(1).standard_normal(4000) * gap
    before = noise + 0.02 * np.sin(time) if effects else noise
    effort = 0.4 * np.sin(2.0 * time) * gap
    return Pictures(
        stretches=tuple(Stretch(name, time, effort, before, noise) for name in names),
        before=rest(0.02 if effects else 0.001),
        after=rest(0.001),
        effort_unit="N·m",
        position_unit="rad",
        floor=0.008,
        traces=tuple(trace(name, 1 + k % 3, effects=effects) for k, name in enumerate(names)),
        causes=((rest(0.02).views[0], rest(0.001).views[0]),) if effects else (),
    )


def trace(name: str, role: int, *, effects: bool, rows: int = 1000) -> Trace:
    """A recording to and fro, of which a fifth is left out; ``role`` is that of the others."""
    time = 0.015 + 0.005 * np.arange(rows)
    noise = 0.008 * np.random.default_rng(role).standard_normal((3, rows))
    position, velocity = np.sin(time), np.cos(time)
    missed = 0.02 * np.sin(time) if effects else np.zeros(rows)
    return Trace(
        name=name,
        time=time,
        position=position,
        velocity=velocity,
        effort=0.3 * np.sign(velocity) + missed + noise[0],
        inertial=-0.0076 * position,
        before=missed + noise[1],
        after=noise[2],
        role=np.where(np.arange(rows) < rows // 5, 0, role),
        simulated=(position + 0.01 * time, position + 0.001 * time),
        contributions={"torque_bias": missed} if effects else {},
        step=1e-5,
    )


def cause(*, decided: bool) -> Cause:
    return Cause(
        name="torque_bias",
        family="offset",
        decided=decided,
        look_alikes=() if decided else ("direction_asymmetry",),
        parameters={"effects.torque_bias.bias": parameter(0.02, 0.003, "N·m")},
        gain=Gain(0.412, (0.35, 0.47)),
        what="constant effort, at rest as well as in motion: bias 0.02 N·m (0.017 to 0.023)",
        means="a constant effort pulls one way, at rest too",
        try_="add it as a feed-forward",
        coordinate="everywhere, also at rest",
    )


def data(name: str, *, fault: bool = False) -> dict[str, object]:
    def check(what: str, verdict: str) -> dict[str, str]:
        told = {"means": f"{what} means", "try": f"{what} try"}
        return {"recording": name, "name": what, "verdict": verdict, "what": f"{what} told"} | told

    part = {"recording": 0, "name": name, "rows": [0, 4000], "seconds": [0.0, 20.0]}
    split = {"rules": ["The rule of the split."], "train": [part, part], "select": [],
             "test": [part], "folds": [{"fit": [part], "held": [part]}] * 2}  # fmt: skip
    return {
        "checks": [
            check("gaps", "fine"),
            check("spikes", "note"),
            check("stuck channel", "fault" if fault else "fine"),
        ],
        "split": None if fault else split,
        "hashes": ["d29e801c" * 8],
        "noise": []
        if fault
        else [{"recording": name, "position": 2.1e-8, "count": 0.0, "effort": 0.011}],
    }


def diagnosis(verdict: Verdict, *, name: str = "run.csv", names: int = 2) -> Diagnosis:
    """A small diagnosis of each kind."""
    if verdict not in FITTED:
        fault = verdict == "data_fault"
        return Diagnosis(
            verdict=verdict,
            sentence=f"The data cannot be used: {name}: stuck channel told.",
            plant=plant(),
            data=data(name, fault=fault),
            advice=(Advice("stuck channel try", f"{name}: stuck channel told", ()),),
            version="0.1.0",
        )
    effects = verdict != "nothing_missing"
    reason = "noise alone reaches it"
    return Diagnosis(
        verdict=verdict,
        sentence=f"The sentence of {verdict}: 41.2 % of the residual's power.",
        plant=plant(effects=effects),
        effects=(cause(decided=verdict != "ambiguous"),) if effects else (),
        gain=Gain(0.412, (0.35, 0.47)) if effects else None,
        candidates=(
            CandidateRow("torque_bias", 0.4, 0.03, 0.41, "accepted" if effects else reason),
            CandidateRow("cogging", -0.001, 0.05, None, reason),
            CandidateRow("stribeck", None, None, None, "part of the law"),
        ),
        laws=(
            LawRow("maxwell_slip", Gain(0.01, (-0.02, 0.03)), "explains about as much"),
            LawRow("hsieh_pan", None, "could not be fitted to these data"),
        ),
        baseline=model(effects=False, held_out=0.02),
        extended=model(effects=effects, held_out=0.01),
        unexplained=(Unexplained("speed", 0.34),) if verdict == "unexplained" else (),
        advice=(Advice("slow full turns", "it tells cogging apart", ("cogging",)),),
        data=data(name),
        version="0.1.0",
        evidence=Bets(tuple(Bet(f"{k} {name}", 0.02, 0.01) for k in range(names * effects))),
        pictures=pictures(effects=effects, names=tuple(f"{k} {name}" for k in range(names))),
    )


def undrawn(verdict: Verdict, *, name: str = "run.csv") -> Diagnosis:
    """Without most of its figures, which take the time."""
    return replace(diagnosis(verdict, name=name), pictures=None)
