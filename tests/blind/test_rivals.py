"""Every rival finds what is plain in columns that are made up, and nothing in noise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from .plants import PLANTS
from .rivals.__main__ import RIVALS
from .rivals.library import Entry, Library, library

ROWS, BLOCKS, EFFECTS = 800, 20, 12


def made(strength=0.0, seed=0):
    """A library of columns at random, of which one effect has been added to white noise."""
    r = np.random.default_rng(seed)
    entries = [
        Entry(f"effect {k // 2}", r.standard_normal((ROWS, 1)), -np.ones(1) * 9, np.ones(1) * 9, 1)
        for k in range(2 * EFFECTS)
    ]
    residual = r.standard_normal(ROWS) + strength * entries[6].columns[:, 0]
    block = np.arange(ROWS) * BLOCKS // ROWS
    return Library(residual, entries, block, 3, float(ROWS), 0.01 * ROWS)


@pytest.mark.parametrize("rival", RIVALS)
def test_a_plain_effect_gets_its_name_and_no_other_does(rival):
    assert RIVALS[rival](made(0.6)) == ["effect 3"]


@pytest.mark.parametrize("rival", RIVALS)
def test_noise_seldom_gets_a_name(rival):
    named = sum(bool(RIVALS[rival](made(seed=k))) for k in range(12))
    # The criterion and the penalty hold no level.
    assert named <= (0 if rival in ("F-test", "e-process") else 3)


@pytest.mark.parametrize("rival", RIVALS)
def test_what_is_worth_no_name_gets_none(rival):
    assert RIVALS[rival](replace(made(0.6), least=1e9)) == []


def test_gains_stay_within_their_bounds():
    column = np.ones((10, 1))
    gains, power = Entry("delay", column, np.zeros(1), np.ones(1), 1).fitted(-np.ones(10))
    assert gains == [0.0]
    assert power == 0.0


def test_an_effect_that_was_taken_in_is_asked_no_more():
    lib = made(0.6)
    less = lib.without(lib.entries[6])
    assert "effect 3" not in {entry.name for entry in less.entries}
    assert less.entries[0].columns.T @ lib.entries[6].columns == pytest.approx(0.0, abs=1e-9)
    assert less.base == lib.base + 1


def test_a_session_gives_the_columns_that_the_diagnosis_screens(tmp_path):
    case = next(
        c for c in PLANTS["axis4"](("hidden",), 16, 4, (16.0, 16.1)) if c.effect == "cogging"
    )
    lib = library(case.lay(tmp_path / "s").path)
    assert {"cogging", "stribeck", "input_delay"} <= {entry.name for entry in lib.entries}
    assert all(len(entry.columns) == len(lib.residual) == len(lib.block) for entry in lib.entries)
    assert 0.0 < lib.share <= 1.0
    power, entry, gains = max(lib.best().values(), key=lambda one: one[0])
    assert entry.name == "cogging"
    # Refitted, next to nothing is left of it; projected off, as much as its slopes missed.
    more, less = lib.again(entry, gains), lib.without(entry)
    assert "cogging" not in {each.name for each in more.entries}
    assert more.residual @ more.residual < 1.2 * (less.residual @ less.residual)
    assert power == pytest.approx(lib.residual @ lib.residual - less.residual @ less.residual)
