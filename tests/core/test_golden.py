"""Every law along one motion, against what its oracle wrote down."""

import json

import numpy as np
import pytest
from tests.reference import golden

import stiction as st

FILES = {path.stem: json.loads(path.read_text("utf-8")) for path in golden.FOLDER.glob("*.json")}
# Numbers of the file against numbers of another machine's library of elementary functions.
MAKING_SHARE = 1e-6


@pytest.mark.parametrize("law", [law.name for law in st.laws()])
def test_law_follows_its_golden_file(law):
    file = FILES[law]
    velocity, dt = golden.motion(file["reach"], file["speed"])
    assert dt == pytest.approx(file["dt_s"], rel=1e-12)
    model = st.FrictionModel(law, **file["parameters"], **file["options"])
    friction = np.asarray(file["friction"])
    ours = model.simulate(velocity, file["dt_s"])
    assert np.abs(ours - friction).max() < file["share"] * np.ptp(friction)


@pytest.mark.parametrize("law", sorted(FILES))
def test_golden_file_is_what_the_oracle_says(law):
    made, file = golden.make(law), dict(FILES[law])
    friction = np.asarray(file.pop("friction"))
    again = np.asarray(made.pop("friction"))
    assert np.abs(again - friction).max() < MAKING_SHARE * np.ptp(friction)
    assert made.pop("dt_s") == pytest.approx(file.pop("dt_s"), rel=1e-12)
    assert made == file
