"""What following readings, noise of the log and the form of a name leave is no further cause.

Sessions of the stranger's axis (`tests/reference/axis4`) in which a wrong name was told without
doubt, and one in which the same name is right.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.blind.plants import PLANTS

import stiction as st


def found_in(folder: Path, kind: str, draw: int, seed: int) -> st.Diagnosis:
    cases = PLANTS["axis4"]((kind,), 204, draw, None)
    (case,) = (each for each in cases if each.bench.seed == seed)
    return st.diagnose(st.load(case.lay(folder / "session").path))


@pytest.mark.parametrize(
    ("draw", "seed"),
    [
        # A damped bristle at 10 ms, followed between stamps, looks like a shaft that gives.
        (26009, 26009169),
        # Where the machine coasts, a dead zone as wide as the noise takes that off the log.
        (4711, 4711008),
    ],
)
def test_nothing_is_named_where_nothing_is_missing(tmp_path: Path, draw: int, seed: int) -> None:
    assert found_in(tmp_path, "null", draw, seed).effects == ()


@pytest.mark.parametrize(
    ("draw", "seed", "name"),
    [
        # A cogging beside it is what the fit leaves of a machine that has nothing else.
        (2911, 2911575, "position_dependent_friction"),
        # Beside it a cogging explained less of what its form leaves than a lag that was taken back.
        (2911, 2911557, "stribeck"),
        # A dead zone beside it, as wide as the noise of the log.
        (2911, 2911541, "torque_constant_saturation"),
        # Memory over a way that the machine leaves between two stamps.
        (2911, 2911566, "input_delay"),
        # And a dead zone that is one.
        (4711, 4711526, "drive_deadband"),
        # A share of the effort, which a fit of the effort itself would make all of it.
        (3023, 3023527, "effort_dependent_friction"),
    ],
)
def test_the_cause_alone_is_named(tmp_path: Path, draw: int, seed: int, name: str) -> None:
    assert [cause.name for cause in found_in(tmp_path, "hidden", draw, seed).effects] == [name]
