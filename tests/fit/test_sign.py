"""An input that is turned round is told before anything is made of it."""

from __future__ import annotations

import numpy as np
import pytest

import stiction as st

TOLD = "With its input turned round"


def plant() -> st.Plant:
    return st.Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm"},
            "friction": {"law": "coulomb"},
        }
    )


def recordings(scale: float, noise: float = 0.0) -> list[st.Recording]:
    """Sums of sines of a machine whose input is logged times ``scale``."""
    friction = st.FrictionModel("coulomb", coulomb=0.13, viscous=7.5e-3)
    found = []
    for k in range(3):
        rng = np.random.default_rng([46, k])
        time = np.arange(4000) * 2e-3
        hertz, phase = rng.uniform(0.2, 2.0, 4), rng.uniform(0.0, 2.0 * np.pi, 4)
        given = 0.15 * np.sin(2.0 * np.pi * time[:, None] * hertz + phase).sum(axis=1)
        moved = st.Motor(2.4e-3, friction=friction).simulate(given[:-1], 2e-3).position
        logged = scale * given + noise * rng.standard_normal(len(time))
        position = np.concatenate([[0.0], moved]) + 1e-6 * rng.standard_normal(len(time))
        found.append(st.Recording(time, input=logged, position=position, kind="sines"))
    return found


def test_a_fit_says_that_the_sign_is_wrong() -> None:
    assert TOLD in st.fit(plant(), recordings(-1.0)).split


def test_a_diagnosis_says_that_the_sign_is_wrong() -> None:
    found = st.diagnose(plant(), recordings(-1.0), surrogates=6, threads=1)
    assert found.verdict in ("unexplained", "not_testable")
    assert TOLD in found.sentence
    assert not found.effects


@pytest.mark.parametrize(("scale", "noise"), [(1.0, 0.0), (0.0, 1.0)])
def test_what_is_right_or_no_input_at_all_is_not_turned_round(scale: float, noise: float) -> None:
    assert TOLD not in st.fit(plant(), recordings(scale, noise)).split


def test_a_fit_of_what_it_cannot_describe_begins_with_that() -> None:
    lost, right = (st.fit(plant(), recordings(*each)) for each in ((0.0, 1.0), (1.0, 0.0)))
    assert str(lost).startswith("this plant does not describe the recordings")
    assert lost.to_dict()["caution"] == lost.caution
    assert lost.caution in lost._repr_html_()
    assert right.caution == ""
    assert str(right).startswith(right.message)
