"""A session of the reference plant as objects of the package: what a user states and records."""

from __future__ import annotations

import stiction as st
from stiction.session import Session


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
