"""Which column plays which role: time first, then motion, then what drives it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from ..._support.arrays import FloatArray
from ..._support.units import MOTION_OF_QUANTITY, UNITS, Motion
from ..._support.wording import commas
from ..clocks import on_main_clock
from ..columns import ROLES
from ..mapping import PRESCRIBED
from ..table import Table, quote
from . import units
from .drive import Drive, choose_drive, quantity_of, runs_backward
from .evidence import Column, alike, columns_of, counts_in_a_turn, rate_of, round_figure
from .kinds import by_name, kinds_of, stated_quantity
from .nameless import explained_share, motion_of
from .result import DRIVE_OF, ColumnGuess, Guess
from .units import UnitGuess, unit_in_name

ALIKE: Final = 0.9
"""Correlation of two columns that may be a position and its reference."""
SMOOTHER: Final = 0.5
"""A reference has at most this share of the roughness of what follows it."""
FOLLOWS: Final = 0.8
"""Correlation of a velocity with the changes of position."""
EXPLAINED: Final = 0.3
"""Share of a column without a name that the motion explains where it may be what drives."""
FINE_SCALE: Final = 1e-5
"""Linear scales have round steps below this, in m."""

# q stands for the coordinate of any joint, of sliding ones too.
_WEAK: Final = frozenset(("q", "qm", "qa", "qg", "qr", "qref", "qdes", "qsp", "qd"))


def guess(tables: Sequence[Table]) -> Guess:
    """Guess the roles and units of the columns of one or several files.

    Parameters
    ----------
    tables : sequence of Table
        Files with the same columns, at least one.

    Returns
    -------
    Guess
        With what could not be guessed in ``missing``.
    """
    return _Guesser(tables).run()


class _Guesser:
    """One call of `guess`: the columns, and those that have a role by now."""

    def __init__(self, tables: Sequence[Table]) -> None:
        self.columns = columns_of([on_main_clock(table) for table in tables])
        self.given: dict[str, ColumnGuess] = {}
        self.refused: dict[str, str] = {}
        self.missing: dict[str, str] = {}
        self.clock: list[FloatArray] = []
        self.kinds = {column.name: kinds_of(column) for column in self.columns}
        self.reasons: dict[str, str] = {}
        self.shares: dict[str, float] = {}

    def run(self) -> Guess:
        self._time()
        position = self._pick("position") or self._nameless_motion()
        self._settle_doubles(position)
        reference = self._reference(position)
        velocity = self._velocity(position)
        motion, motion_reason = self._motion([position, reference, velocity])
        factor = self._motion_columns(motion, position, reference, velocity)
        referenced = "reference" in self._roles()
        drive = self._drive(motion, position, referenced)
        for kind in ("temperature", "normal_force", "friction_coefficient", "load"):
            self._other(kind, motion)
        self._enabled()
        drive = self._sliding_test(drive, referenced)
        per_rev = 0
        if position is not None and motion == "rotary":
            per_rev = self._counts(position, factor)
        return Guess(
            columns=tuple(self._told(column) for column in self.columns),
            motion=motion,
            motion_reason=motion_reason,
            drive=drive.name,
            drive_reason=drive.reason,
            missing=self.missing,
            counts_per_rev=per_rev,
            counts_needed=any(guess.unit == "count" for guess in self.given.values()),
            input_unknown=drive.unknown,
        )

    # What is still free ------------------------------------------------------------------

    def _free(self, kind: str) -> list[Column]:
        """Columns without a role that may be of this kind, the likeliest first."""
        able = [
            column
            for column in self.columns
            if not column.trouble
            and column.name not in self.given
            and column.name not in self.refused
            and self.kinds[column.name][:1] == (kind,)
        ]
        return sorted(able, key=lambda column: (column.constant, -column.said.strength))

    def _pick(self, kind: str) -> Column | None:
        """The likeliest column of a kind whose name gives no unit of another quantity."""
        for column in self._free(kind):
            written = column.said.unit
            if kind in ROLES and written is not None and written.quantity not in ROLES[kind]:
                self.refused[column.name] = (
                    f"{written.unit} is no unit of {kind} ({written.how}); name it by hand with "
                    "scale and offset if it is one"
                )
                continue
            return column
        return None

    def _give(
        self, column: Column, role: str, unit: UnitGuess, why: str, others: Sequence[Column] = ()
    ) -> None:
        if column.constant:
            why += f", though it is {column.arrays[0][0]:.6g} in every row"
        seconds = tuple(f"column {quote(other.name)}" for other in others if other is not column)
        self.given[column.name] = ColumnGuess(
            column.name,
            role,
            unit.unit,
            unit.scale,
            f"{why}; {unit.reason}",
            (*(f"unit {name}" for name in unit.alternatives), *seconds),
        )

    def _roles(self) -> set[str | None]:
        return {one.role for one in self.given.values()}

    # Time --------------------------------------------------------------------------------

    def _time(self) -> None:
        named = [
            column
            for column in self.columns
            if not column.trouble and "time" in self.kinds[column.name]
        ]
        named.sort(key=lambda c: (not c.rises, len(self.kinds[c.name]), -c.said.strength))
        sure = [c for c in named if c.rises or self.kinds[c.name] == ("time",)]
        nameless = [
            column
            for column in self.columns
            if not (column.trouble or self.kinds[column.name] or column.said.unit)
            and column.rises
            and column.even
            and not (column.whole and column.step == 1.0)
        ]
        if sure:
            chosen, why = sure[0], by_name(sure[0])
            why += ", and it increases" if chosen.rises else ", though it does not increase"
        elif len(nameless) == 1:
            chosen, why = nameless[0], "the only column that increases evenly"
        else:
            self.missing["time"] = (
                "no column is known to be the time: name it, with its unit; where the file has "
                "none, add a column of seconds"
            ) + "".join(f"; {quote(one.name)} does not increase" for one in named)
            return
        unit = unit_in_name(chosen, ("time",)) or units.time_unit(chosen)
        self._give(chosen, "time", unit, why, sure)
        self.clock = [array * unit.factor for array in chosen.arrays]

    # Motion ------------------------------------------------------------------------------

    def _nameless(self) -> list[Column]:
        """Columns of which the name tells nothing, and that have no role yet."""
        return [
            column
            for column in self.columns
            if not (column.trouble or self.kinds[column.name] or column.said.unit)
            and column.name not in self.given
        ]

    def _nameless_motion(self) -> Column | None:
        """The position among columns that no name tells apart, where its velocity is beside it."""
        if any(kinds[:1] == ("velocity",) for kinds in self.kinds.values()):
            return None
        found = motion_of(self._nameless(), self.clock)
        if found is None:
            return None
        position, velocity, fit = found
        self.kinds[position.name], self.kinds[velocity.name] = ("position",), ("velocity",)
        self.reasons[position.name] = (
            f"no name tells; {quote(velocity.name)} is its rate of change (correlation {fit:.3f})"
        )
        self.reasons[velocity.name] = (
            f"no name tells; it is the rate of change of {quote(position.name)}"
        )
        for other in self._nameless():
            share = explained_share(position, velocity, self.clock, other)
            self.shares[other.name] = share
        return position

    def _by_name(self, column: Column) -> str:
        return self.reasons.get(column.name) or by_name(column)

    def _settle_doubles(self, position: Column | None) -> None:
        """Names with two meanings get the one that the data bear out."""
        for column in self.columns:
            kinds = self.kinds[column.name]
            if len(kinds) < 2 or column.trouble or column.name in self.given:
                continue
            settled = kinds[-1]
            if kinds[0] == "velocity":
                follows = 0.0 if position is None else rate_of(position, self.clock, column)[1]
                settled = "velocity" if abs(follows) > FOLLOWS else kinds[1]
            elif "temperature" in kinds and column.low > 10.0 and column.high < 400.0:
                settled = "temperature"
            self.kinds[column.name] = (settled,)

    def _reference(self, position: Column | None) -> Column | None:
        if position is None:
            return None
        found = self._pick("reference")
        if found is not None:
            return found
        # A bare "ref" or "cmd" may ask for anything: it has to look like the position.
        for column in self.columns:
            if column.trouble or column.name in self.given or self.kinds[column.name]:
                continue
            if column.said.wanted and alike(position, column) > 0.5:
                return column
        return None

    def _smoother(self, position: Column) -> Column | None:
        """The other one of two similar positions, if it is the smoother by far."""
        for other in self._free("position"):
            same = other is position or other.said.strength != position.said.strength
            if not same and alike(position, other) > ALIKE:
                return other
        return None

    def _velocity(self, position: Column | None) -> Column | None:
        able = [c for c in self._free("velocity") if not c.said.wanted]
        for column in self._free("velocity"):
            if column.said.wanted:
                self.refused[column.name] = "a velocity that is asked for; the measured one is used"
        if position is None or not able:
            return able[0] if able else None
        return max(able, key=lambda c: (not c.constant, abs(rate_of(position, self.clock, c)[1])))

    def _motion(self, found: Sequence[Column | None]) -> tuple[Motion, str]:
        """Rotary or linear: units, then sensor steps, then words, then the drive's quantity."""
        motions = [column for column in found if column is not None]
        for column in motions:
            written = column.said.unit
            if written is not None and written.quantity in MOTION_OF_QUANTITY:
                kind = MOTION_OF_QUANTITY[written.quantity]
                return kind, f"column {quote(column.name)} is in {written.unit}"
        for column in motions[:1]:
            number = counts_in_a_turn(column.count, 2.0 * math.pi)
            if number:
                return "rotary", f"readings of {quote(column.name)} have {number} steps to a turn"
        for column in motions:
            if column.said.motion is not None and column.said.word not in _WEAK:
                return column.said.motion, f"by the name {quote(column.name)}"
        for column in self.columns:
            quantity = stated_quantity(column)
            if not column.trouble and quantity in ("torque", "force"):
                kind = MOTION_OF_QUANTITY[quantity]
                return kind, f"column {quote(column.name)} is a {quantity}"
        if any(self.kinds[column.name] == ("normal_force",) for column in self.columns):
            return "linear", "a normal force or stress belongs to sliding"
        for column in motions[:1]:
            # Printed digits are round too.
            fine = 0.0 < column.count <= FINE_SCALE and column.span < 2.0
            if fine and not column.from_text and round_figure(column.count):
                told = f"readings of {quote(column.name)} come in steps of {column.count:.3g}"
                return "linear", f"{told}, a round figure as linear scales have"
        for column in motions:
            if column.said.motion is not None:
                return column.said.motion, f"by the name {quote(column.name)}"
        return "rotary", "nothing tells; most drives turn"

    def _motion_columns(
        self,
        motion: Motion,
        position: Column | None,
        reference: Column | None,
        velocity: Column | None,
    ) -> float:
        """Gives position, reference and velocity their units; returns SI over position cells."""
        if position is None:
            if velocity is None or not self.clock:
                told = "no column is known to be the position: name it and its unit"
                self.missing["position"] = told + self._spoiled("position")
            if velocity is not None:
                unit = units.velocity_unit(velocity, motion, None, 1.0, self.clock)
                why = f"{self._by_name(velocity)}; no position is recorded, and it is integrated"
                self._give_moving(velocity, "velocity", unit, why, motion)
            return 1.0
        others = self._free("position")
        why = self._by_name(position)
        twin = self._smoother(position) if reference is None else None
        if twin is not None:
            smooth, rough = sorted((position, twin), key=lambda c: c.roughness)
            if smooth.roughness < SMOOTHER * rough.roughness:
                position, reference = rough, smooth
                why = f"{self._by_name(position)}, and rougher than {quote(reference.name)}"
        unit = unit_in_name(position, ROLES["position"]) or units.position_unit(
            position, motion, velocity, self.clock
        )
        self._give(position, "position", unit, why, others)
        if reference is not None:
            own = unit_in_name(reference, ROLES["reference"]) or units.reference_unit(
                reference, position, unit
            )
            smoother = why.endswith(quote(reference.name))
            why = (
                "smoother than the position it resembles" if smoother else self._by_name(reference)
            )
            self._give_moving(reference, "reference", own, why, motion)
        if velocity is not None:
            own = units.velocity_unit(velocity, motion, position, unit.factor, self.clock)
            others = [c for c in self._free("velocity") if c is not velocity]
            if own.disagrees and MOTION_OF_QUANTITY.get(UNITS[own.unit].quantity) == motion:
                self.refused[velocity.name] = (
                    f"{self._by_name(velocity)}; {own.reason}: give it as velocity with the unit "
                    "or the scale that holds, or leave it out"
                )
                return unit.factor
            self._give_moving(velocity, "velocity", own, self._by_name(velocity), motion, others)
        return unit.factor

    def _give_moving(
        self,
        column: Column,
        role: str,
        unit: UnitGuess,
        why: str,
        motion: Motion,
        others: Sequence[Column] = (),
    ) -> None:
        """Gives a role unless its unit belongs to the other kind of motion."""
        if MOTION_OF_QUANTITY.get(UNITS[unit.unit].quantity, motion) == motion:
            self._give(column, role, unit, why, others)
            return
        self.refused[column.name] = (
            f"it is in {unit.unit}, and the motion is {motion}: give it as {role} with a scale "
            "for the gear or screw, or leave it out"
        )

    # What drives -------------------------------------------------------------------------

    def _drive(self, motion: Motion, position: Column | None, referenced: bool) -> Drive:
        able = self._free("drive")
        names = [column.name for column in self.columns]
        chosen = choose_drive(able, motion, position, referenced, names)
        self.refused |= chosen.refused
        if chosen.column is None:
            return chosen
        quantity = chosen.quantity
        unit = unit_in_name(chosen.column, (quantity,)) or units.drive_unit(chosen.column, quantity)
        why = self._by_name(chosen.column)
        if chosen.name == PRESCRIBED:
            if position is not None and runs_backward(position, chosen.column):
                unit = replace(unit, scale=-unit.scale)
                why += ", against the motion on the whole, which scale -1 turns round"
            self._give(chosen.column, "effort", unit, why, chosen.others)
        else:
            self._give(chosen.column, "input", unit, why, chosen.others)
        return chosen

    def _spoiled(self, kind: str) -> str:
        """Columns that would be of this kind by their names, and what is wrong with them."""
        found = [c for c in self.columns if c.trouble and self.kinds[c.name][:1] == (kind,)]
        return "".join(f"; {quote(column.name)} {column.trouble}" for column in found)

    def _sliding_test(self, drive: Drive, referenced: bool) -> Drive:
        """Without any drive a friction coefficient stands for the effort."""
        if drive.name is None and "friction_coefficient" in self._roles():
            return Drive(PRESCRIBED, "a friction coefficient is recorded and no input")
        if drive.name is None:
            sentence = (
                "no column is known to be the input: name the current, voltage, torque or force "
                "that drives the machine, with its sign"
            )
            if len(drive.refused) == 1:
                (name, why), *_ = drive.refused.items()
                sentence += f" ({quote(name)} did not qualify: {why})"
            elif drive.refused:
                sentence += f" ({commas(map(quote, drive.refused))} did not qualify)"
            if referenced:
                sentence += (
                    "; of a servo that is given positions name the goal instead of a reference, "
                    'and state [drive] kind = "servo" in plant.toml; stiction library holds plants '
                    "of servos"
                )
            spoiled = self._spoiled("drive")
            if spoiled:
                sentence = f"no column can be the input{spoiled}: mend that first, or name another"
            self.missing["input"] = sentence
        return drive

    # The rest ----------------------------------------------------------------------------

    def _other(self, kind: str, motion: Motion) -> None:
        column = self._pick(kind)
        if column is None or kind in self._roles():
            return
        if kind == "temperature":
            unit = unit_in_name(column, ("temperature",)) or units.temperature_unit(column)
        elif kind == "friction_coefficient":
            if column.low < -2.0 or column.high > 2.0:
                self.refused[column.name] = "a friction coefficient lies between -2 and 2"
                return
            unit = unit_in_name(column, ("ratio",)) or UnitGuess("1", 1.0, "1: a ratio")
        else:
            told = unit_in_name(column, ROLES[kind])
            if told is None and kind == "load":
                self.refused[column.name] = (
                    "its unit is not known: name it by hand as load if it is an external torque "
                    "or force; the load register of a servo is none"
                )
                return
            unit = told or UnitGuess("N", 1.0, "N: the SI unit", ("MPa",))
        if kind == "load" and MOTION_OF_QUANTITY[stated_quantity(column) or "torque"] != motion:
            self.refused[column.name] = f"a load in {unit.unit} is none of a {motion} machine"
            return
        self._give(column, kind, unit, self._by_name(column))

    def _enabled(self) -> None:
        """Where a drive is off it gives nothing, whatever it is commanded."""
        column = self._pick("enabled")
        if column is None:
            return
        values = {float(value) for array in column.arrays for value in np.unique(array)}
        if values == {0.0, 1.0}:
            self._give(
                column, "enabled", UnitGuess("1", 1.0, "1: on, 0: off"), self._by_name(column)
            )
        elif values == {1.0}:
            self.refused[column.name] = "it is 1 in every row: the drive was always on"
        else:
            self.refused[column.name] = "what says whether a drive is on is 0 or 1"

    def _counts(self, position: Column, factor: float) -> int:
        if self.given[position.name].unit != "count":
            return counts_in_a_turn(position.count * factor, 2.0 * math.pi)
        # A counter that runs over shows all of its range.
        power = math.ceil(math.log2(position.high + 1.0)) if position.high > 0.0 else 0
        fills = position.low >= 0.0 and position.high > 0.98 * 2.0**power
        jumps = max(float(np.max(np.abs(np.diff(a)))) for a in position.arrays) > 2.0 ** (power - 1)
        return int(2**power) if fills and jumps else 0

    def _told(self, column: Column) -> ColumnGuess:
        if column.name in self.given:
            return self.given[column.name]
        why = column.trouble or self.refused.get(column.name, "")
        if not why and self.kinds[column.name] in (("flag",), ("index",)):
            why = f"'{column.said.word}' is neither a motion nor an effort"
        elif not why and self.kinds[column.name]:
            kind = self.kinds[column.name][0]
            why = f"could be {'an input' if kind == 'drive' else kind}; another column was taken"
        elif not why:
            why = "no word of its name is known"
        if (share := self.shares.get(column.name)) is not None:
            return self._nameless_told(column, share)
        quantity = quantity_of(column) or "voltage"
        if column.trouble or self.kinds[column.name][:1] != ("drive",) or quantity not in DRIVE_OF:
            return ColumnGuess(column.name, None, reason=why)
        unit = unit_in_name(column, (quantity,)) or units.drive_unit(column, quantity)
        return ColumnGuess(column.name, None, unit.unit, unit.scale, why, candidate="input")

    def _nameless_told(self, column: Column, share: float) -> ColumnGuess:
        """What no name tells may be an input, the more so the more of it the motion explains."""
        why = (
            f"no word of its name is known; acceleration, friction and gravity of the motion "
            f"explain {100.0 * share:.0f} % of it"
        )
        able = not column.constant and share >= EXPLAINED
        return ColumnGuess(column.name, None, "A", 1.0, why, candidate="input" if able else None)
