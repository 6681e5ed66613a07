"""What there is to be found in a session, by who knows the truth; alone in using inner objects."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stiction.diagnosis.data.evidence import Evidence
from stiction.diagnosis.data.gain import residuals_of
from stiction.diagnosis.screening.model import fit_model
from stiction.fitting.solve import reweight

from .stated import as_session


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
    """What there is to be found in a session; `baseline` is the plant where fits start from."""
    seen = Evidence(plant, session.recordings)
    clean = _without_hidden(plant, made)
    base = fit_model(seen, baseline)
    reweight(seen.train, base.plant, base.nuisances)
    seen.weigh()
    base = fit_model(seen, base.plant, base.nuisances)

    def power(evidence):
        for rows, own in zip(evidence.train, seen.train, strict=True):
            rows.weight = own.weight
        evidence.weigh()
        best = fit_model(evidence, base.plant, base.nuisances)
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
    return Evidence(plant, as_session(made, torque).recordings)


def _distance(made, seen, clean, base):
    signal, columns = [], []
    for own, other in zip(seen.train, clean.train, strict=True):
        moved = own.residual(base.plant, base.nuisances) - other.residual(
            base.plant, base.nuisances
        )
        # Every sample has the same noise: weights of recordings are of no use here.
        signal.append(np.sqrt(own.form.stride) * moved[own.mask])
    weights = np.concatenate([np.full(int(r.mask.sum()), r.weight) for r in seen.train])
    columns = base.fitted_columns.matrix() / weights[:, None]
    signal = np.concatenate(signal)
    scale = np.sqrt(np.sum(columns**2, axis=0))
    live = columns[:, scale > 0.0] / scale[scale > 0.0]
    left = signal - live @ np.linalg.lstsq(live, signal, rcond=1e-8)[0]
    return float(np.linalg.norm(left)) / (made.spec.noise * made.plant["coulomb"])
