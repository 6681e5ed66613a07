"""Machines that do not turn round: a constant, a weight and cogging are much the same there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis.builders import evidence, plant, rows
from tests.diagnosis.builders import model as model_of
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.selection.chance import lacks_repeats, odds, share_of_phases, share_of_waves

SPAN = 4.0
"""rad that a machine moves over once it is geared down."""


def geared(
    seed: int, base: str, span: float = SPAN, top: float | None = None, **hidden: Any
) -> tuple[st.Plant, st.Session]:
    """A reference session seen behind a gear that leaves it less than a turn.

    ``hidden`` are effects with the number of their periods a turn behind the gear, None for a
    constant; ``top`` is where their wave is greatest, rad from the middle of the motion.
    """
    bare = as_session(make_session(seed, base=base))
    position = np.concatenate([r.position for r in bare.recordings])
    ratio = span / float(np.ptp(position))
    middle = 0.5 * float(position.min() + position.max())

    def shape(order: float) -> dict[str, float]:
        own = order * ratio
        return {"order": own} | ({} if top is None else {"phase": own * middle + order * top})

    entries = tuple(
        (name, 0.012) if order is None else (name, 0.012, shape(order))
        for name, order in hidden.items()
    )
    made = make_session(seed, base=base, hidden=entries)
    slower = [
        st.Recording(
            r.time, r.input, ratio * r.position, role=r.role, kind=r.kind, start_s=r.start_s
        )
        for r in as_session(made).recordings
    ]
    counts = round(made.spec.counts_per_rev / ratio)
    table = as_plant(made).to_dict() | {"sensor": {"counts_per_rev": counts}}
    return st.Plant.from_dict(table), st.Session(slower)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("seed", "base", "hidden", "name"),
    [
        (31, "maxwell_slip", {"torque_bias": None}, "torque_bias"),
        (34, "coulomb", {"cogging": 1.0}, "gravity_unbalance"),
        (31, "maxwell_slip", {"cogging": 1.5}, "cogging"),
    ],
)
def test_what_only_few_waves_would_do_is_told_by_its_simpler_name(
    seed: int, base: str, hidden: dict[str, Any], name: str
) -> None:
    """All but the last were left open beside ``cogging``, of any order and phase."""
    found = st.diagnose(*geared(seed, base, **hidden))
    assert [(cause.name, cause.decided) for cause in found.effects] == [(name, True)]


@pytest.mark.parametrize("turned", [0.0, np.pi])
def test_a_phase_that_is_known_and_at_the_top_is_one_of_few(turned: float) -> None:
    def share(away: float, deviation: float) -> float:
        wave = np.array([np.cos(turned + away), np.sin(turned + away)])
        return share_of_phases(3.0 * wave, 9.0 * deviation**2 * np.eye(2), np.array([0.7, 0.0]))

    assert share(0.0, 0.0) == pytest.approx(0.0, abs=1e-12)
    assert share(0.1, 0.05) == pytest.approx(2.0 / np.pi * 0.2)
    assert share(-0.1, 0.05) == pytest.approx(share(0.1, 0.05))
    assert share(0.5 * np.pi, 0.0) == pytest.approx(1.0)
    assert share(0.0, 2.0) == 1.0


def test_of_a_wave_without_size_nothing_is_known() -> None:
    assert share_of_phases(np.zeros(2), np.eye(2), np.array([1.0, 0.0])) == 1.0


@pytest.mark.parametrize(("phases", "order"), [(0.05, 2.0), (0.6, 2.0), (0.26, 4.0), (0.9, 3.0)])
def test_waves_of_lower_orders_are_flat_in_more_phases(phases: float, order: float) -> None:
    lower = np.exp(np.linspace(0.0, np.log(order), 20_001))
    flat = np.minimum(phases * order / lower, 1.0)
    counted = np.trapezoid(flat, np.log(lower)) / np.log(320.0)
    assert share_of_waves(phases, order, 320.0) == pytest.approx(counted, rel=1e-6)


def test_blocks_speak_for_what_is_simpler_only_where_it_explains_more() -> None:
    alone = odds(0.2, 0.0, near=True)
    assert alone == pytest.approx(np.log(5.0))
    assert odds(0.2, 2.9, near=True) == alone
    assert odds(0.2, 2.9, near=False) == pytest.approx(alone + 0.5 * 2.9**2)
    assert odds(0.2, -1.0, near=True) == odds(0.2, -1.0, near=False) < alone


@pytest.mark.slow
def test_a_weight_at_its_top_is_no_sure_constant() -> None:
    """The blocks spoke for the constant, which costs less, though it explains a little less."""
    plant, session = geared(31, "maxwell_slip", span=1.0, top=0.0, cogging=1.0)
    found = st.diagnose(plant, session)
    assert not any(cause.decided for cause in found.effects if cause.name == "torque_bias")


@pytest.mark.parametrize(("order", "seen"), [(7.0, False), (9.0, True)])
def test_a_wave_that_was_never_seen_to_repeat_is_known_as_such(order: float, seen: bool) -> None:
    waved = plant(effects=[{"name": "cogging", "order": order, "cosine": 0.1, "sine": 0.1}])
    places = [np.linspace(-0.3, 0.0, 2000) + 0.3 * k for k in range(2)]
    # What was not looked at, and what lies between two recordings, does not count.
    places.append(np.linspace(4.0, 9.0, 2000))
    shown = [rows(x, lambda at: at < 1.0) for x in places]
    model = model_of(evidence(shown=shown), waved)
    assert lacks_repeats(model, "cogging") is not seen
    assert not lacks_repeats(model, "torque_bias")
