"""Words and paths that no encoding has (lone surrogates) are refused in a sentence."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import stiction as st

LONE = "\ud800"
DT = 1e-3


def motor(**settings: Any) -> st.Motor:
    return st.Motor(1.0, friction=st.FrictionModel("coulomb"), **settings)


def run() -> st.Trajectory:
    return motor().simulate([0.1], DT)


WORDS: dict[str, Callable[[], Any]] = {
    "a law": lambda: st.FrictionModel(LONE),
    "a parameter": lambda: st.FrictionModel("coulomb", **{LONE: 1.0}),
    "an option": lambda: st.FrictionModel("hsieh_pan", damper=LONE),
    "an effect": lambda: motor(effects={LONE: {}}),
    "a parameter of an effect": lambda: motor(effects={"cogging": {LONE: 1.0}}),
    "a number of a servo": lambda: motor(servo={LONE: 1.0}),
    "an output": lambda: motor().simulate([0.1], DT, outputs=[LONE]),
    "an output of segments": lambda: motor().simulate_segments([0.1], [0.1], outputs=[LONE]),
    "an output of a stream": lambda: list(st.stream(motor(), [[0.1]], DT, outputs=(LONE,))),
    "an output of an ensemble": lambda: st.simulate_ensemble(motor(), [0.1], DT, outputs=[LONE]),
    "an array": lambda: motor().simulate([0.1], DT, out={LONE: np.zeros(1)}),
    "a state": lambda: setattr(motor(), "state", {LONE: 1.0}),
    "a path of a parameter": lambda: motor().sensitivity([0.1], DT, [LONE]),
    "a parameter of an ensemble": lambda: st.Ensemble(motor(), parameters={LONE: [1.0]}),
    "a column": lambda: run()[LONE],
    "a candidate": lambda: motor().signatures(st.Motion([0.0, 0.1], [0.1], DT), [(LONE, {})]),
    "a start": lambda: motor().follow(st.Motion([0.0, 0.1], [0.1], DT), start={LONE: 1.0}),
}
PATHS: dict[str, Callable[[str], Any]] = {
    "a session": st.load,
    "a plant": st.Plant.load,
    "a recording": st.Recording.load,
    "a trajectory": lambda name: run().save(f"{name}.npz"),
    "a checkpoint": lambda name: list(st.stream(motor(), [[0.1]], DT, checkpoint=name)),
}


@pytest.mark.parametrize("name", sorted(WORDS))
def test_a_word_that_no_encoding_has_is_refused(name: str) -> None:
    with pytest.raises(st.InputError) as told:
        WORDS[name]()
    assert str(told.value).encode()


@pytest.mark.parametrize("name", sorted(PATHS))
@pytest.mark.parametrize("what", [LONE, "zero\0byte"])
def test_a_path_that_no_file_can_have_is_refused(name: str, what: str, tmp_path: Path) -> None:
    with pytest.raises(st.InputError, match="no name that a file can have") as told:
        PATHS[name](str(tmp_path / what))
    assert str(told.value).encode()


def test_a_single_current_for_an_ensemble_is_refused() -> None:
    for parameters in (None, {"viscous": [0.1, 0.2]}):
        with pytest.raises(st.InputError, match=r"currents = 0\.1 is a single number"):
            st.simulate_ensemble(motor(), 0.1, DT, parameters=parameters)
