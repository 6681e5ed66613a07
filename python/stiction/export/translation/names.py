"""Types and names of the C of a plant, as Rust has them, and which variables change."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, Final

from .tree import (
    Assign,
    Binary,
    Call,
    Declare,
    Expression,
    For,
    Function,
    Index,
    Kind,
    Literal,
    Member,
    Name,
    Unary,
)

__all__ = [
    "LIMITS",
    "Counters",
    "constant_name",
    "find_changes",
    "length",
    "names",
    "nodes",
    "root",
    "type_name",
    "uses",
    "variable",
]

PLAIN: Final = {
    "real": "Real",
    "int": "i32",
    "long": "i64",
    "int32_t": "i32",
    "int64_t": "i64",
    "uint64_t": "u64",
    "signed char": "i8",
    "bool": "bool",
}
LIMITS: Final = {"EPSILON": "Real::EPSILON", "INFINITY": "Real::INFINITY"}
"""Constants of the numbers themselves."""
KEPT: Final = frozenset({"move", "type", "ref", "match", "in", "loop", "fn", "use", "mod", "box"})
"""Words that Rust keeps for itself."""


def type_name(name: str) -> str:
    """A type of C, by its name."""
    if name in PLAIN:
        return PLAIN[name]
    if name == "stiction_state":
        return "Contact"
    words = name.removeprefix("stiction_").split("_")
    return "".join(word.capitalize() for word in words)


def constant_name(name: str) -> str:
    """A constant; a number of an effect begins with its name in small letters."""
    return name if name.isupper() else f"EFFECT_{name.upper()}"


def variable(name: str) -> str:
    """A variable or a function."""
    return f"{name}_" if name in KEPT else name


def root(of: Expression) -> str | None:
    """The variable that a place in memory belongs to."""
    while True:
        if isinstance(of, Member | Index) or (isinstance(of, Unary) and of.sign in "&*"):
            of = of.of
        else:
            return of.name if isinstance(of, Name) else None


def nodes(of: Any) -> Iterator[Any]:
    """What a part of C consists of, itself included, and all that is in it."""
    if isinstance(of, tuple):
        for each in of:
            yield from nodes(each)
    elif is_dataclass(of):
        yield of
        for part in fields(of):
            yield from nodes(getattr(of, part.name))


def find_changes(
    function: Function, aliases: dict[str, Expression], signatures: dict[str, tuple[Kind, ...]]
) -> set[str]:
    """Variables of a function that it writes to after they were declared."""
    places: list[Expression] = []
    for node in nodes(function.body):
        if isinstance(node, Assign):
            places.append(node.to)
        elif isinstance(node, Call):
            given = zip(node.given, signatures.get(node.name, ()), strict=False)
            places += [place for place, kind in given if kind.pointer and not kind.constant]
    found = set()
    for place in places:
        name = root(place)
        while name in aliases:
            name = root(aliases[name])
        if name is not None:
            found.add(name)
    return found


@dataclass(frozen=True)
class Counters:
    """Variables that count loops and do nothing else.

    Attributes
    ----------
    names : frozenset of str
    """

    names: frozenset[str]

    @classmethod
    def of(cls, function: Function) -> Counters:
        """Of a function."""
        declared = {
            node.name
            for node in nodes(function.body)
            if isinstance(node, Declare) and node.value is None and node.kind == Kind("int")
        }
        inside: dict[str, int] = {}
        spoilt = set()
        for loop in nodes(function.body):
            name = cls._counts(loop)
            if name is None:
                continue
            assert isinstance(loop, For)
            inside[name] = inside.get(name, 0) + uses(loop, name)
            if any(isinstance(n, Assign) and root(n.to) == name for n in nodes(loop.body)):
                spoilt.add(name)
        whole = {name: uses(function.body, name) for name in declared}
        names = {n for n in declared - spoilt if n in inside and inside[n] == whole[n]}
        return cls(frozenset(names))

    def counts(self, loop: For) -> tuple[str, Expression, Expression] | None:
        """Counter, first value and end of a loop that is a range; None of any other."""
        name = self._counts(loop)
        if name not in self.names:
            return None
        assert name is not None
        assert loop.start is not None
        assert isinstance(loop.condition, Binary)
        return name, loop.start.value, loop.condition.right

    @staticmethod
    def _counts(loop: Any) -> str | None:
        if not (isinstance(loop, For) and loop.start is not None and loop.step is not None):
            return None
        name, ends = root(loop.start.to), loop.condition
        ranges = (
            isinstance(ends, Binary)
            and ends.sign == "<"
            and ends.left == Name(name or "")
            and isinstance(ends.right, Literal | Name)
            and loop.step == Assign("+=", Name(name or ""), Literal("1", Kind("int")))
        )
        return name if ranges else None


def names(of: Expression) -> set[str]:
    """All variables that an expression names."""
    return {node.name for node in nodes(of) if isinstance(node, Name)}


def uses(of: Any, name: str) -> int:
    """How often a variable is named."""
    return sum(node == Name(name) for node in nodes(of))


def length(text: str) -> str:
    """The length of an array."""
    return text if re.fullmatch(r"\d+", text) else f"{text} as usize"
