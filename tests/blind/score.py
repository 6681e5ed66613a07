"""Diagnoses one session and compares what it says with what was hidden."""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import NamedTuple

import numpy as np

import stiction as st
from stiction.diagnosis.evidence import Evidence
from stiction.diagnosis.gain import residuals_of
from stiction.diagnosis.model import fitted
from stiction.fitting.solve import reweighted
from stiction.session import Session

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


def as_session(made, torque=None):
    """A reference session as a user would have it; `torque` takes the place of what was logged."""
    recordings = []
    for index, r in enumerate(made.recordings):
        effort = r.torque_nm if torque is None else torque[index]
        known = {"reference": r.reference_rad, "load": r.load_nm}
        if r.temperature_c is not None:
            known["temperature"] = r.temperature_c
        known = {name: values for name, values in known.items() if values is not None}
        recordings.append(
            st.Recording(
                r.time_s,
                effort,
                r.position_rad,
                role=r.role,
                kind=r.kind,
                start_s=r.start_s,
                cold=r.cold,
                **known,
            )
        )
    return Session(recordings)


def as_plant(made):
    """What a user states of the machine: the law, the drive and the encoder."""
    return st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "friction": {"law": made.spec.base},
            "sensor": {"counts_per_rev": made.spec.counts_per_rev},
        }
    )


def scored(case, made, threads=1):
    """Verdict, truth and comparison of one case: a line of the results."""
    plant, session = as_plant(made), as_session(made)
    found = st.diagnose(plant, session, without=case.without, threads=threads)
    families = {record.name: record.family for record in st.effects()}
    names = [effect.name for effect in made.effects]
    known = oracle(plant, session, made, found.baseline) if names else Known(0.0, [], 0.0)
    return {
        "key": case.key,
        "at": datetime.now(UTC).isoformat(timespec="seconds"),
        "kind": case.kind,
        "base": case.base,
        "seed": case.seed,
        "without": list(case.without),
        "hidden": [_truth(effect) for effect in made.effects],
        "names": names,
        "classes": sorted({families.get(name, "foreign") for name in names}),
        "verdict": found.verdict,
        "found": [_cause(cause, families) for cause in found.effects],
        "unexplained": [[each.coordinate, each.share] for each in found.unexplained],
        "gain": None if found.gain is None else found.gain.value,
        "clair": known.clair,
        "own_clairs": known.own_clairs,
        "distance": known.distance,
        "intervals": _intervals(made, found),
        "left": _left(found),
        "candidates": [row.to_dict() for row in found.candidates],
        "base_rms": found.baseline.train_rms,
        "floor_rms": found.baseline.noise_floor_rms,
        "seconds": found.seconds,
    }


class Known(NamedTuple):
    """What can be gained and seen by who knows the hidden torque."""

    clair: float
    """Gain once the hidden torque is taken off the input and the base is refitted; same weights,
    test rows."""
    own_clairs: list[float]
    """That of each effect alone, the others taken off already."""
    distance: float
    """Signal-to-noise ratio of the hidden torque over the rows of train, the base projected off:
    the square root of its power per sample over the noise of the torque."""


def oracle(plant, session, made, baseline):
    """What there is to be found in a session; `baseline` is where fits start from."""
    seen = Evidence(plant, session.recordings, threads=1)
    clean = _without_hidden(plant, made)
    base = fitted(seen, baseline.plant)
    reweighted(seen.train, base.plant, base.nuisances)
    seen.weigh()
    base = fitted(seen, base.plant, base.nuisances)

    def power(evidence):
        for rows, own in zip(evidence.train, seen.train, strict=True):
            rows.weight = own.weight
        evidence.weigh()
        best = fitted(evidence, base.plant, base.nuisances)
        opened = residuals_of(evidence, evidence.open_test(), [(best.plant, best.nuisances)])
        return float(np.sum(opened.residuals[0] ** 2))

    least = power(clean)
    clair = 1.0 - least / power(seen)
    kept = range(len(made.effects)) if len(made.effects) > 1 else ()
    own = [1.0 - least / power(_without_hidden(plant, made, kept=k)) for k in kept] or [clair]
    return Known(clair, own, _distance(made, seen, clean, base))


def _without_hidden(plant, made, kept=None):
    """The session with hidden torques taken off the input, all but that of effect `kept`."""
    torque = []
    for r in made.recordings:
        hidden = r.truth["hidden"]
        torque.append(r.torque_nm + (hidden if kept is None else hidden - r.truth["parts"][kept]))
    return Evidence(plant, as_session(made, torque).recordings, threads=1)


def _distance(made, seen, clean, base):
    signal, columns = [], []
    for own, other in zip(seen.train, clean.train, strict=True):
        moved = own.residual(base.plant, base.nuisances) - other.residual(
            base.plant, base.nuisances
        )
        # Every sample has the same noise: weights of recordings are of no use here.
        signal.append(np.sqrt(own.form.stride) * moved[own.mask])
    weights = np.concatenate([np.full(int(r.mask.sum()), r.weight) for r in seen.train])
    columns = base.fitted_columns / weights[:, None]
    signal = np.concatenate(signal)
    scale = np.sqrt(np.sum(columns**2, axis=0))
    live = columns[:, scale > 0.0] / scale[scale > 0.0]
    left = signal - live @ np.linalg.lstsq(live, signal, rcond=1e-8)[0]
    return float(np.linalg.norm(left)) / (made.spec.noise * made.plant["coulomb"])


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
    alike = [families[name] for name in (cause.name, *cause.look_alikes)]
    return {
        "name": cause.name,
        "decided": cause.decided,
        "look_alikes": list(cause.look_alikes),
        "class": cause.family,
        "classes": sorted(set(alike)),
        "gain": None if cause.gain is None else cause.gain.value,
        "parameters": {path: [p.value, *p.ci95] for path, p in cause.parameters.items()},
    }


def _left(found):
    """What is left above noise in each coordinate, whether it matters or not."""
    views = [view for view in found.pictures.after.views if view.share > view.threshold]
    return [[v.coordinate.name, v.share, v.threshold, v.size] for v in views]


def _intervals(made, found):
    """Truth and 95 % interval of each gain of a named effect that has the library's form."""
    causes = {cause.name: cause for cause in found.effects}
    intervals = []
    for effect in made.effects:
        known = STRENGTHS.get(effect.name)
        if known is None or effect.form != "library" or effect.name not in causes:
            continue
        parameters = causes[effect.name].parameters
        for name, true in known(effect.amplitude, effect.shape).items():
            fit = parameters[f"effects.{effect.name}.{name}"]
            intervals.append([f"{effect.name}.{name}", float(true), fit.value, *fit.ci95])
    return intervals
