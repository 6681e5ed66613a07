"""What real machines lack, as far as it was looked at by hand."""

from __future__ import annotations

from pathlib import Path

import stiction as st


def test_emps_lacks_three_effects(shared_data: Path) -> None:
    """Names that were judged with the report at hand; a change that loses one has to say why."""
    columns = {
        "time": "t",
        "input": {"name": "vir", "unit": "V"},
        "position": {"name": "qm", "unit": "m"},
    }
    emps = st.Recording.load(
        shared_data / "emps" / "DATA_EMPS.mat", columns, motion="linear", drive="voltage_v"
    )
    plant = st.Plant.from_dict(
        {
            "motion": {"kind": "linear"},
            "drive": {"input": "voltage_v", "gain": 35.15065},
            "friction": {"law": "coulomb"},
        }
    )
    found = st.diagnose(plant, emps)
    assert [(cause.name, cause.decided) for cause in found.effects] == [
        ("direction_asymmetry", True),
        ("frictional_lag", True),
        ("reverse_point_memory", True),
    ]
    assert found.gain is not None
    assert found.gain.ci95[0] > 0.85
