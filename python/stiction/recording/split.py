"""Which rows of a session train, select and test.

The split only marks rows: the friction state runs through the whole of every recording, whoever
fits or judges.  It is made before anything is fitted, and the same session always gives the same.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from .._support.wording import commas, plural
from ..errors import InputError, NotEnoughData
from .blocks import Part, blocks, check_lengths_of
from .names import names_of
from .recording import SPLIT_ROLES, Recording

__all__ = ["BLOCK_S", "EDGE_S", "Fold", "Part", "Split", "split"]

BLOCK_S: Final = 2.0
"""Length of interleaved blocks: several times what friction remembers, short enough to alternate
with drifts."""

EDGE_S: Final = 0.05
"""Dropped on either side of an edge between blocks: the width of the kernel."""


@dataclass(frozen=True)
class Fold:
    """One way to leave rows of train out.

    Attributes
    ----------
    fit, held : tuple of Part
        Rows to fit on, and rows to judge on.
    """

    fit: tuple[Part, ...]
    held: tuple[Part, ...]


@dataclass(frozen=True)
class Split:
    """Rows by what they are for.

    Attributes
    ----------
    train, select, test : tuple of Part
        Parameters are fitted on ``train``; ``select`` decides which effects; ``test`` is opened
        once, after the last decision.
    folds : tuple of Fold
        Where there is no ``select``: what is left out of train in turn to decide.
    rules : tuple of str
        What was decided, in sentences.
    names : tuple of str
        Of the recordings, for words.
    lengths : tuple of int
        Rows of each recording.
    seconds : mapping of Part to (float, float)
        First and last row of each part, s since the recording's first row.
    """

    train: tuple[Part, ...]
    select: tuple[Part, ...]
    test: tuple[Part, ...]
    folds: tuple[Fold, ...]
    rules: tuple[str, ...]
    names: tuple[str, ...]
    lengths: tuple[int, ...]
    seconds: Mapping[Part, tuple[float, float]] = field(hash=False)

    def describe(self) -> str:
        """The split in plain words, one line a role."""
        lines = [*self.rules]
        for role in SPLIT_ROLES:
            parts = getattr(self, role)
            lines.append(f"{role}: {self._words(parts)}" if parts else self._without(role))
        return "\n".join(lines)

    def to_dict(self) -> dict[str, Any]:
        """The split as ``data.split`` of findings.json.

        Returns
        -------
        dict
            ``rules`` (sentences), ``train``, ``select``, ``test`` (lists of ``{recording, name,
            rows: [start, stop], seconds: [from, to]}``; recordings counted from 0, ``stop``
            behind the last row, seconds since the recording's first row) and ``folds`` (lists of
            ``{fit, held}``, each such a list).
        """
        return {
            "rules": list(self.rules),
            **{role: self._entries(getattr(self, role)) for role in SPLIT_ROLES},
            "folds": [
                {"fit": self._entries(fold.fit), "held": self._entries(fold.held)}
                for fold in self.folds
            ],
        }

    def __repr__(self) -> str:
        return self.describe()

    def _entries(self, parts: Sequence[Part]) -> list[dict[str, Any]]:
        return [
            {
                "recording": part.recording,
                "name": self.names[part.recording],
                "rows": [part.start, part.stop],
                "seconds": list(self.seconds[part]),
            }
            for part in parts
        ]

    def _words(self, parts: Sequence[Part]) -> str:
        lasting = sum(high - low for low, high in map(self.seconds.__getitem__, parts))
        pieces = Counter(part.recording for part in parts)
        whole = {part.recording for part in parts if len(part) == self.lengths[part.recording]}
        words = [
            self.names[index]
            if index in whole
            else f"{plural(pieces[index], 'block')} of {self.names[index]}"
            for index in pieces
        ]
        return f"{commas(words)} ({lasting:.4g} s)"

    def _without(self, role: str) -> str:
        if role == "select" and self.folds:
            return f"select: {plural(len(self.folds), 'fold')} over train"
        return f"{role}: nothing"


def split(
    recordings: Sequence[Recording],
    *,
    block_s: float = BLOCK_S,
    edge_s: float = EDGE_S,
    decides: bool = True,
    joined: bool = False,
) -> Split:
    """Deal the recordings of a session, or blocks of them, to train, select and test.

    Roles that are stated stay.  Where others have a role, a recording without one trains.
    Without a ``test`` the last recording of the commonest kind is split off from train, or every
    third block where every kind occurs once; where that is too short to be cut, a recording that
    was dealt to select.  Without a ``select`` the recordings of train are
    left out in turn; of a kind that occurs once, interleaved blocks are.  Without any role the
    recordings of each kind are dealt train, select, test in turn, and a single recording is cut
    into blocks that are dealt so.

    Parameters
    ----------
    recordings : sequence of Recording, or Session
    block_s : float
        Length of interleaved blocks, s; they come out a little longer, for no rest is left.
    edge_s : float
        Dropped on either side of an edge between two blocks, s: the width of the kernel.
    decides : bool
        Something is chosen on the rows of ``select``, so that folds stand in for them.
    joined : bool
        The rows of ``select`` train as well, and folds over both decide.

    Returns
    -------
    Split

    Raises
    ------
    InputError
        Nothing to train on, the same recording in two roles, or a recording shorter than three
        blocks that had to be cut into blocks.
    """
    return _Dealer(tuple(recordings), block_s, edge_s).deal(decides=decides, joined=joined)


class _Dealer:
    """One call of `split`: who has which parts so far, and what was decided."""

    def __init__(self, recordings: tuple[Recording, ...], block_s: float, edge_s: float) -> None:
        if not recordings:
            raise InputError("session: there are no recordings to split; give at least one")
        check_lengths_of(block_s, edge_s)
        self.recordings = recordings
        self.block_s = block_s
        self.edge_s = edge_s
        self.names = tuple(names_of(recordings))
        self.roles: list[str | None] = [recording.role for recording in recordings]
        self.dealt = not any(self.roles)
        self.parts: dict[str, list[Part]] = {role: [] for role in SPLIT_ROLES}
        self.folds: list[Fold] = []
        self.rules: list[str] = []

    def deal(self, *, decides: bool, joined: bool) -> Split:
        if self.roles == [None]:
            self._deal_blocks()
        else:
            if not any(self.roles):
                self._deal_kinds()
            self._deal_stated()
            self._refuse_copies(joined=joined)
            if not self.parts["test"]:
                self._split_off()
        if joined and self.parts["select"]:
            self.parts["train"] = sorted([*self.parts["train"], *self.parts["select"]])
            self.parts["select"] = []
            self.rules.append(
                "What may act in few seconds is looked for again: the rows of select train as well."
            )
            self._fold(joined=True)
        elif decides and not self.parts["select"]:
            self._fold()
        return Split(
            train=tuple(self.parts["train"]),
            select=tuple(self.parts["select"]),
            test=tuple(self.parts["test"]),
            folds=tuple(self.folds),
            rules=tuple(self.rules),
            names=self.names,
            lengths=tuple(len(recording) for recording in self.recordings),
            seconds={part: self._seconds(part) for part in self._all_parts()},
        )

    def _all_parts(self) -> Iterator[Part]:
        for parts in self.parts.values():
            yield from parts
        for fold in self.folds:
            yield from (*fold.fit, *fold.held)

    def _seconds(self, part: Part) -> tuple[float, float]:
        time = self.recordings[part.recording].time
        return float(time[part.start] - time[0]), float(time[part.stop - 1] - time[0])

    def _deal_blocks(self) -> None:
        for turn, part in enumerate(self._blocks(0)):
            self.parts[SPLIT_ROLES[_turned(turn)]].append(part)
        self.rules.append(
            f"The single recording is cut into blocks of about {self.block_s:g} s, which take the "
            f"roles train, select and test in rotation; {self.edge_s:.3g} s on either side of each "
            "edge are left out."
        )

    def _deal_kinds(self) -> None:
        seen: Counter[str] = Counter()
        for index, recording in enumerate(self.recordings):
            self.roles[index] = SPLIT_ROLES[seen[recording.kind] % 3]
            seen[recording.kind] += 1
        self.rules.append(
            "No recording has a role: those of each kind are assigned to train, select and test "
            "in turn."
        )

    def _deal_stated(self) -> None:
        without = [index for index, role in enumerate(self.roles) if role is None]
        if without:
            self.rules.append(
                f"Without a role beside others that have one, these train: {self._listed(without)}."
            )
        for index, recording in enumerate(self.recordings):
            role = self.roles[index] = self.roles[index] or "train"
            self.parts[role].append(Part(index, 0, len(recording)))
        if not self.parts["train"]:
            held = [role for role in SPLIT_ROLES if self.parts[role]]
            given = "every recording has the role 'test'" if held == ["test"] else (
                f"the recordings have the roles {' and '.join(held)}, and none has 'train'"
            )  # fmt: skip
            raise InputError(
                f"session: {given}, so there is nothing to fit on; give at least one recording "
                'role = "train", or none a role'
            )

    def _refuse_copies(self, *, joined: bool) -> None:
        """The same data may not be fitted and judged on, not even in a fold."""
        first: dict[str, int] = {}
        faults: list[str] = []
        for index, recording in enumerate(self.recordings):
            at = first.setdefault(recording.hash, index)
            one, two = self.roles[at], self.roles[index]
            folded = one == "select" and joined
            folded = folded or (one == "train" and (joined or not self.parts["select"]))
            shared = one == two and not folded
            if at != index and not shared:
                where = f"as {one} and as {two}" if one != two else "in train"
                faults.append(
                    f"{self.names[at]} and {self.names[index]} are the same recording twice, "
                    f"{where}"
                )
        if faults:
            raise InputError(
                f"session: {commas(faults)}; held-out data must not be fitted on, drop one of the "
                "two"
            )

    def _split_off(self) -> None:
        kinds = self._kinds_of_train()
        kind, number = max(kinds.items(), key=lambda item: item[1])
        if number > 1:
            chosen = [p for p in self.parts["train"] if self.recordings[p.recording].kind == kind]
            self.parts["train"].remove(chosen[-1])
            self.parts["test"].append(chosen[-1])
            self.rules.append(
                f"No recording has the role test: {self.names[chosen[-1].recording]}, the last of "
                "the commonest kind in train, is split off before anything is fitted."
            )
            return
        if not all(self._can_be_cut(part.recording) for part in self.parts["train"]):
            if self.dealt and len(self.parts["select"]) > 1:
                # What a kind alone shows, as an inertia, would be fitted to nothing.
                chosen = [self.parts["select"].pop()]
                self.parts["test"] += chosen
                self.rules.append(
                    "No recording has the role test, every kind occurs once in train, and some are "
                    f"too short to be cut: {self.names[chosen[0].recording]}, the last in select, "
                    "is split off before anything is fitted."
                )
                return
            if number == 0 or len(self.parts["train"]) < 2:
                self._blocks(self.parts["train"][-1].recording)  # says how long it had to be
            chosen = [self.parts["train"].pop()]
            self.parts["test"] += chosen
            self.rules.append(
                "No recording has the role test, every kind occurs once in train, and some are too "
                f"short to be cut: {self.names[chosen[0].recording]}, the last in train, is split "
                "off before anything is fitted."
            )
            return
        trained, self.parts["train"] = self.parts["train"], []
        for part in trained:
            for turn, block in enumerate(self._blocks(part.recording)):
                self.parts["test" if _turned(turn) == 2 else "train"].append(block)
        self.rules.append(
            "No recording has the role test and every kind occurs once in train: every third "
            f"block of about {self.block_s:g} s is split off before anything is fitted; "
            f"{self.edge_s:g} s on either side of each edge are dropped."
        )

    def _fold(self, *, joined: bool = False) -> None:
        kinds = self._kinds_of_train()
        train = tuple(self.parts["train"])
        several = len(self._trained()) > 1
        single = [
            i
            for i in self._trained()
            if kinds[self.recordings[i].kind] == 1
            and not (several and not self._foldable(i, train))
        ]
        many = [i for i in self._trained() if i not in single]
        for index in many:
            held = tuple(part for part in train if part.recording == index)
            fit = tuple(part for part in train if part.recording != index)
            self.folds.append(Fold(fit, held))
        cut = {index: self._turns(index, train) for index in single}
        others = tuple(part for part in train if part.recording in many)
        for turn in range(max((len(turns) for turns in cut.values()), default=0)):
            held = tuple(part for turns in cut.values() for part in turns[turn])
            fit = others + tuple(
                part
                for turns in cut.values()
                for other, parts in enumerate(turns)
                if other != turn
                for part in parts
            )
            self.folds.append(Fold(tuple(sorted(fit)), held))
        words = ["the recordings of train are left out in turn"] if many else []
        if single:
            words.append(f"interleaved blocks are left out in turn of {self._listed(single)}")
        begin = "" if joined else "No recording has the role select: "
        told = f"{begin}to decide, {', and '.join(words)}."
        self.rules.append(told[0].upper() + told[1:])

    def _turns(self, index: int, train: Sequence[Part]) -> list[list[Part]]:
        """The parts of a recording that occurs once, by the fold that holds them."""
        own = [part for part in train if part.recording == index]
        if len(own) > 1:  # cut already, of every three blocks the third to test
            return [own[0::2], own[1::2]]
        cut = self._blocks(index)
        return [cut[0::2], cut[1::2]]

    def _can_be_cut(self, index: int) -> bool:
        """Whether a recording is long enough for blocks."""
        try:
            return bool(self._blocks(index))
        except NotEnoughData:
            return False

    def _foldable(self, index: int, train: Sequence[Part]) -> bool:
        """Whether parts of a recording can be left out in turn."""
        return sum(part.recording == index for part in train) > 1 or self._can_be_cut(index)

    def _blocks(self, index: int) -> list[Part]:
        time = self.recordings[index].time
        return blocks(index, time, self.names[index], self.block_s, self.edge_s)

    def _trained(self) -> list[int]:
        return list(dict.fromkeys(part.recording for part in self.parts["train"]))

    def _kinds_of_train(self) -> Counter[str]:
        return Counter(self.recordings[index].kind for index in self._trained())

    def _listed(self, indices: Sequence[int]) -> str:
        return commas(self.names[index] for index in indices)


def _turned(turn: int) -> int:
    """Whose turn a block is: 0 1 2, 1 2 0, 2 0 1 and again.

    Dealt in the same order every time, the blocks of a machine whose motion repeats every three
    of them would show each role one stretch of that motion alone.
    """
    return (turn + turn // 3) % 3
