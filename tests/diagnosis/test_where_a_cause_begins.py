"""Every cause begins where it was seen best: ordinary sessions of an independent simulator."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import stiction as st
from stiction.bench.ordinary.draw import Spec, ordinary
from stiction.bench.ordinary.files import write
from stiction.catalogue import effects
from stiction.diagnosis.screening.candidates import Candidate
from stiction.diagnosis.screening.signatures import gain_at
from stiction.diagnosis.selection.trials import _of_its_share


def told(folder: Path, **spec: Any) -> st.Diagnosis:
    made = Spec(law="coulomb", contact="dry", **spec)
    return st.diagnose(None, st.load(write(ordinary(made), folder)), threads=1)


# A base that makes up for what it lacks shows nothing of it by the slopes of its simulation.
@pytest.mark.parametrize(
    ("spec", "name", "gain"),
    [
        # Named along the readings, and lost in the simulation that followed.
        (
            {
                "seed": 7001000,
                "hidden": "viscous_quadratic",
                "size": 0.14707839888031987,
                "seconds": 27.705095963671603,
            },
            "viscous_quadratic",
            0.99,
        ),
        # Simulated from the first: tried along the readings because nothing had a name.
        (
            {
                "seed": 7004005,
                "hidden": "input_delay",
                "size": 0.17234763044550752,
                "seconds": 22.412611074434153,
            },
            "input_delay",
            0.99,
        ),
        # The size of what swings tells the share of the inertia, not the compliance.
        (
            {
                "seed": 7002013,
                "hidden": "shaft_compliance",
                "size": 0.21499895883603923,
                "seconds": 27.716652884881988,
            },
            "shaft_compliance",
            0.97,
        ),
        # The base had four times the inertia of the machine, and losing that was held against it.
        (
            {
                "seed": 7002019,
                "hidden": "cogging",
                "size": 0.2331065235346833,
                "seconds": 31.605616694390896,
            },
            "cogging",
            0.9,
        ),
    ],
    ids=lambda given: given if isinstance(given, str) else "",
)
def test_what_the_slopes_of_a_bent_base_hide_is_named(
    spec: dict[str, Any], name: str, gain: float, tmp_path: Path
) -> None:
    found = told(tmp_path, **spec)
    assert [(cause.name, cause.decided) for cause in found.effects] == [(name, True)]
    assert found.gain is not None
    assert found.gain.value > gain


def test_what_readings_leave_without_a_name_is_asked_of_a_simulation(tmp_path: Path) -> None:
    found = told(tmp_path, seed=7003001, seconds=37.675002222213216)
    assert found.verdict == "nothing_missing", found.sentence


def test_a_swinging_mass_begins_with_the_share_that_its_signature_tells() -> None:
    record = next(each for each in effects() if each.name == "shaft_compliance")
    shape = {"inertia_share": 0.5, "damping_ratio": 0.08}
    candidate = Candidate(record, shape, (), resonance=24.0)
    inertia, at = 0.007, gain_at(candidate, 0.007)
    like, gains = _of_its_share(candidate, 0.5 * at, inertia)
    # Half of the signature is half of the share at the same resonance of the load alone.
    assert like.shape["inertia_share"] == pytest.approx(0.25)
    assert gains[0] * like.shape["inertia_share"] == pytest.approx(0.5 * at)
