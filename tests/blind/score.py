"""Diagnoses one session as a user does and compares what its files say with what was hidden."""

from __future__ import annotations

import math
import tempfile
from datetime import UTC, datetime
from pathlib import Path

import stiction as st

from .oracle import Known, oracle
from .stated import as_plant, as_session
from .way import walked

# Gains of the library's effects from amplitude and shape of the reference plant's.
STRENGTHS = {
    "stribeck": lambda a, s: {"excess": a},
    "viscous_quadratic": lambda a, s: {"quadratic": a / s["velocity"] ** 2},
    "direction_asymmetry": lambda a, s: {
        "coulomb": a * s["sign"],
        "viscous": a * s["sign"] * s["viscous_part"],
    },
    "torque_bias": lambda a, s: {"bias": a * s["sign"]},
    "position_dependent_friction": lambda a, s: _wave(a, s),
    "cogging": lambda a, s: _wave(a, s),
    "torque_constant_ripple": lambda a, s: _wave(a, s),
    "input_delay": lambda a, s: {"delay": a * s["sign"]},
    "drive_deadband": lambda a, s: {"deadband": a},
    "dwell_strengthening": lambda a, s: {"strength": a},
    "rate_dependent_breakaway": lambda a, s: {"strength": a},
    "warm_up": lambda a, s: {"coulomb": a, "viscous": a * s["viscous_part"]},
    "run_in": lambda a, s: {"coulomb": a},
    "encoder_eccentricity": lambda a, s: _wave(a, s),
    "creep_hardening": lambda a, s: {"creep": a},
    "relaxation": lambda a, s: {"speed": a},
    "gravity_unbalance": lambda a, s: _wave(a, s),
    "drive_saturation": lambda a, s: {"share": a},
    "back_emf": lambda a, s: {"slope": a},
    "voltage_limit": lambda a, s: {"share": a},
    "current_loop_lag": lambda a, s: {"time": a},
    "frictional_lag": lambda a, s: {"excess": a},
    "reverse_point_memory": lambda a, s: {"share": a},
    "temperature_dependent_friction": lambda a, s: {"coulomb": a, "viscous": a * s["viscous_part"]},
    "load_dependent_friction": lambda a, s: {"drive": a, "back_drive": a * s["back"]},
    "backlash": lambda a, s: {"inertia_share": a},
}


def _wave(amplitude, shape):
    phase = shape["phase"]
    return {"cosine": amplitude * math.cos(phase), "sine": amplitude * math.sin(phase)}


def scored(case, made, threads=1):
    """Verdict, truth and comparison of one case: a line of the results."""
    with tempfile.TemporaryDirectory(prefix="stiction-blind-") as name:
        folder = made.write(Path(name) / "session")
        options = ["--threads", str(threads)]
        options += [word for effect in case.without for word in ("--without", effect)]
        answer = walked(folder / "session.toml", Path(name) / "out", options)
    families = families_of()
    names = [effect.name for effect in made.effects]
    row = {
        "key": case.key,
        "kind": case.kind,
        "base": case.base,
        "seed": case.seed,
        "without": list(case.without),
        "hidden": [_truth(effect) for effect in made.effects],
        "names": names,
        "classes": sorted({families.get(name, "foreign") for name in names}),
        **told(answer),
    }
    if answer.findings is None:
        return row
    known = _known(made, answer.findings) if names else Known(0.0, [], 0.0)
    return row | {
        "clair": known.clair,
        "own_clairs": known.own_clairs,
        "distance": known.distance,
        "intervals": _intervals(made, answer.findings),
    }


def families_of():
    """Class of each effect of the library."""
    return {record.name: record.family for record in st.effects()}


def told(answer):
    """What a diagnosis left on the disk, as part of a line of the results."""
    lost = [str(loss) for loss in answer.losses]
    row = {
        "at": datetime.now(UTC).isoformat(timespec="seconds"),
        "lost": lost,
        "lost_kinds": list(dict.fromkeys(loss.kind for loss in answer.losses)),
        "walk_seconds": round(answer.seconds, 2),
    }
    findings = answer.findings
    if findings is None:
        return row
    families = families_of()
    base = findings["baseline"] or {}
    return row | {
        "verdict": findings["verdict"],
        "found": [_cause(cause, families) for cause in findings["effects"]],
        "unexplained": [[each["coordinate"], each["share"]] for each in findings["unexplained"]],
        "better_law": findings.get("better_law"),
        "gain": None if findings["gain"] is None else findings["gain"]["value"],
        "candidates": findings["candidates"],
        "base_rms": base.get("train_rms"),
        "floor_rms": base.get("noise_floor_rms"),
        "seconds": findings["seconds"],
    }


def _known(made, findings):
    """What there is to be found, with fits that start where the baseline ended."""
    plant = as_plant(made)
    if findings["baseline"] is None:
        return Known(0.0, [0.0] * len(made.effects), 0.0)
    return oracle(plant, as_session(made), made, baseline_of(plant, findings))


def baseline_of(plant, findings):
    """The plant with the values that findings.json gives its baseline."""
    table = plant.to_dict()
    for path, parameter in findings["baseline"]["parameters"].items():
        part, name = path.split(".")
        table.setdefault(part, {})[name] = parameter["value"]
    return st.Plant.from_dict(table)


def _truth(effect):
    return {
        "name": effect.name,
        "form": effect.form,
        "size": effect.size,
        "reached": effect.reached,
        "smoothed": effect.smoothed,
        "amplitude": effect.amplitude,
        "shape": {k: v for k, v in effect.shape.items() if isinstance(v, (int, float))},
    }


def _cause(cause, families):
    alike = [families[name] for name in (cause["name"], *cause["look_alikes"])]
    return {
        "name": cause["name"],
        "decided": cause["decided"],
        "look_alikes": cause["look_alikes"],
        "class": cause["class"],
        "classes": sorted(set(alike)),
        "gain": cause["heldout_gain"],
        "parameters": {
            path: [p["value"], *_interval(p["ci95"])] for path, p in cause["parameters"].items()
        },
    }


def _interval(ci95):
    """Ends of an interval; findings.json has null for one that the data leave open."""
    low, high = ci95
    return (-math.inf if low is None else low, math.inf if high is None else high)


def _intervals(made, findings):
    """Truth and 95 % interval of each gain of a named effect that has the library's form."""
    causes = {cause["name"]: cause for cause in findings["effects"]}
    intervals = []
    for effect in made.effects:
        known = STRENGTHS.get(effect.name)
        if known is None or effect.form != "library" or effect.name not in causes:
            continue
        parameters = causes[effect.name]["parameters"]
        for name, true in known(effect.amplitude, effect.shape).items():
            fit = parameters[f"effects.{effect.name}.{name}"]
            ends = _interval(fit["ci95"])
            intervals.append([f"{effect.name}.{name}", float(true), fit["value"], *ends])
    return intervals
