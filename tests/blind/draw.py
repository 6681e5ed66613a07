"""What is hidden in which session: the mix of cases, dealt so that every effect has its turn."""

from __future__ import annotations

import zlib
from dataclasses import dataclass

import numpy as np
from tests.reference.effect_catalogue import EFFECTS, FOREIGN, LIBRARY

import stiction as st

FIRST_SEED = 10_000
"""Seeds below are for trying things out; nothing is tuned on those from here on."""
SEEDS_EACH = 10_000
"""Seeds of sessions that one seed of a draw may use."""
MIX = {"null": 6, "single": 9, "pair": 3, "foreign": 2, "without": 2}
"""Cards of each kind in a deck: 30, 45, 15, 10 %, and single effects left out of the library."""
SIZES = (0.001, 0.03)
"""rms of the hidden torque as a share of the friction level: bounds of a log-uniform draw."""
FOREIGN_FORM = 0.3
"""Share of effects that are hidden in a form that is not the library's, where there is one."""
GIVEN_SHAPE = {"input_delay": {"sign": 1.0}}
"""The library has no input that acts before its stamp."""


@dataclass(frozen=True)
class Case:
    """One session to be diagnosed."""

    kind: str
    base: str
    seed: int
    hidden: tuple = ()
    without: tuple = ()
    flicker: float = 0.0
    log_noise: float = 0.0

    @property
    def key(self):
        """Tells cases apart; the same for the same draw."""
        flickers = f" flicker {self.flicker}" if self.flicker else ""
        noisy = f" log {self.log_noise}" if self.log_noise else ""
        return f"{self.base} {self.seed} {self.kind} {self.hidden}{flickers}{noisy}"

    @property
    def spec(self):
        """For `make_sessions`."""
        own = {"seed": self.seed, "base": self.base, "hidden": self.hidden}
        return {**own, "flicker": self.flicker, "log_noise": self.log_noise}


def library(base=None):
    """Effects that library and reference plant have in common, and the law `base` not of itself."""
    core = {p.name for law in st.laws() if law.name == base for p in law.parameters}
    core -= {p.name for law in st.laws() if law.name == base for p in law.parameters if p.optional}
    known = {record.name for record in st.effects() if not core.intersection(record.law_terms)}
    able = {name for name, kind in LIBRARY.items() if base is None or base in kind.bases}
    return [name for name in LIBRARY if name in known & able]


def cases(number, seed, base="maxwell_slip", sizes=SIZES, kinds=tuple(MIX), effects=()):
    """`number` cases; a longer list begins with the shorter one."""
    if number > SEEDS_EACH:
        raise ValueError(f"one seed draws {SEEDS_EACH} sessions at most, not {number}")
    rng = np.random.default_rng([seed, *(zlib.crc32(w.encode()) for w in ("blind", base))])
    kind_deck = deck(rng, [kind for kind in kinds for _ in range(MIX[kind])])
    effect_deck = deck(rng, list(effects) or library(base))
    foreign_deck = deck(rng, list(FOREIGN))
    first = FIRST_SEED + SEEDS_EACH * seed
    return [
        _case(next(kind_deck), base, first + k, rng, sizes, effect_deck, foreign_deck)
        for k in range(number)
    ]


def _case(kind, base, seed, rng, sizes, effect_deck, foreign_deck):
    if kind == "null":
        return Case(kind, base, seed)
    if kind == "foreign":
        return Case(kind, base, seed, ((next(foreign_deck), _size(rng, sizes)),))
    names = [next(effect_deck)]
    while kind == "pair" and len(names) < 2:
        other = next(effect_deck)
        names += [other] if other != names[0] else []
    hidden = tuple(_entry(rng, name, sizes) for name in names)
    return Case(kind, base, seed, hidden, tuple(names) if kind == "without" else ())


def _entry(rng, name, sizes):
    foreign = rng.random() < FOREIGN_FORM and "foreign" in EFFECTS[name].forms
    entry = f"{name}:foreign" if foreign else name, _size(rng, sizes)
    return (*entry, GIVEN_SHAPE[name]) if name in GIVEN_SHAPE else entry


def _size(rng, sizes):
    low, high = np.log(sizes)
    return round(float(np.exp(rng.uniform(low, high))), 6)


def deck(rng, cards):
    """Every card once in random order, again and again."""
    while True:
        for index in rng.permutation(len(cards)):
            yield cards[index]
