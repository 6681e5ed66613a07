"""A cause that few rows held out excite: these must gain what was learnt from those fitted."""

from __future__ import annotations

import numpy as np
import pytest
from tests.blind.score import as_plant, as_session
from tests.diagnosis.builders import cells, evidence, model
from tests.reference.session_reference import make_session

import stiction as st
from stiction.diagnosis.data.evidence import Plan
from stiction.diagnosis.screening.block_gains import lacks_excitation
from stiction.diagnosis.screening.model import Model
from stiction.diagnosis.selection.replication import confirms
from stiction.fitting.angular import Angular

BLOCKS, ROWS = 40, 200
FITTED = np.repeat(np.arange(BLOCKS) < 28, ROWS)
MANY = (3, 5, 9, 12, 17, 20, 26)
BLOCK = np.repeat(np.arange(BLOCKS), ROWS)


def acting(*blocks: int, seed: int = 1) -> np.ndarray:
    """Something that acts in these blocks alone, white and of unit size."""
    wave = np.random.default_rng(seed).standard_normal(BLOCKS * ROWS)
    return np.where(np.isin(BLOCK, blocks), wave, 0.0)


def asked(
    there: np.ndarray,
    explained: np.ndarray,
    columns: np.ndarray | None = None,
    folds: bool = False,
    whole: bool = False,
) -> bool:
    """Whether a machine in which ``there`` acts confirms what explains ``explained``."""
    noise = np.random.default_rng(2).standard_normal(len(there))
    own = np.zeros((len(there), 1)) if columns is None else columns
    plans = [Plan(FITTED, ~FITTED, FITTED if folds else None)]
    session = evidence(plans=plans, cells=cells(BLOCK), overlap=6.0)
    base = model(session, columns=Angular.of_matrix(own), residual=there + noise)
    after = model(session, residual=there - explained + noise)
    return confirms(base, after, explained, whole=whole)


def test_one_block_held_out_confirms_what_was_learnt() -> None:
    cause = 3.0 * acting(*MANY, 33)
    assert asked(cause, cause)


@pytest.mark.parametrize("share", [0.0, 0.4, 2.0, -1.0])
def test_another_strength_held_out_does_not(share: float) -> None:
    cause = 3.0 * acting(*MANY, 33)
    assert not asked(np.where(FITTED, cause, share * cause), cause)


def test_another_shape_held_out_does_not() -> None:
    cause = 3.0 * acting(*MANY, 33)
    assert not asked(np.where(FITTED, cause, 9.0 * acting(33, seed=7)), cause)


def test_what_noise_would_hide_does_not() -> None:
    cause = 0.3 * acting(*MANY, 33)
    assert not asked(cause, cause)


def test_what_rows_held_out_do_not_excite_does_not() -> None:
    cause = 3.0 * acting(*MANY)
    assert not asked(cause, cause)


def test_what_the_base_makes_up_for_does_not() -> None:
    cause = 3.0 * acting(*MANY, 33)
    assert not asked(cause, cause, columns=1e-10 * cause[:, None])


@pytest.mark.parametrize("blocks", [(3,), (3, 9), (3, 9, 12)])
def test_few_blocks_that_were_fitted_leave_doubt(blocks: tuple[int, ...]) -> None:
    """What is fitted to one block leaves nothing there, and looks as if it were known exactly."""
    cause = 3.0 * acting(*blocks, 33)
    assert not asked(cause, cause)


def test_few_blocks_are_enough_where_nothing_is_left_of_what_was_never_fitted() -> None:
    cause = 30.0 * acting(3, 33)
    assert asked(cause, cause)
    assert not asked(np.where(FITTED, cause, 0.7 * cause), cause)


@pytest.mark.parametrize(("share", "sure"), [(1.0, True), (0.6, False), (1.5, False), (0.0, False)])
def test_few_blocks_are_enough_for_a_gain_that_was_known_beforehand(
    share: float, sure: bool
) -> None:
    """A gain that takes everything was not fitted; what it leaves held out has to be noise."""
    cause = 30.0 * acting(3, 33)
    assert asked(np.where(FITTED, cause, share * cause), cause, whole=True) is sure


def test_rows_held_out_by_turns_confirm_nothing() -> None:
    cause = 3.0 * acting(*MANY, 33)
    assert not asked(cause, cause, folds=True)


@pytest.mark.parametrize(
    ("size", "share", "hardly"),
    [(1.0, 0.0, True), (1.0, 0.1, True), (1.0, 0.3, False), (0.1, 1.0, False), (0.1, 0.3, True)],
)
def test_what_does_little_where_it_is_to_be_confirmed_is_hardly_excited_there(
    size: float, share: float, hardly: bool
) -> None:
    """Less than a name needs, and less than where it was fitted: a small cause is small there."""
    cause = size * acting(*range(BLOCKS)) * np.where(FITTED, 1.0, share)
    noise = np.random.default_rng(2).standard_normal(len(cause))
    columns, left = np.ones((len(cause), 1)), cause + noise

    def base(folds: bool) -> Model:
        plans = [Plan(FITTED, ~FITTED, FITTED if folds else None)]
        session = evidence(plans=plans, cells=cells(BLOCK))
        return model(session, columns=Angular.of_matrix(columns), residual=left)

    assert lacks_excitation(base(False), cause, 0.025) == hardly
    assert not lacks_excitation(base(True), cause, 0.025)


@pytest.mark.slow
def test_what_shows_where_it_was_fitted_alone_is_not_testable() -> None:
    """A limit that is reached in one recording: turned round with its second it is told as well."""
    made = make_session(12750006, hidden=(("voltage_limit", 0.012414),))
    found = st.diagnose(as_plant(made), as_session(made))
    assert found.verdict == "not_testable"
    assert found.effects == ()
    assert "voltage_limit (" in found.sentence
    assert any("voltage_limit" in each.separates for each in found.advice)
    (row,) = (row for row in found.candidates if row.name == "voltage_limit")
    assert row.score > row.threshold
    assert row.reason.endswith("hardly excite it")
