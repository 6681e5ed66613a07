"""What the C of a plant consists of."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "Array",
    "Assign",
    "Binary",
    "Block",
    "Call",
    "Cast",
    "Choice",
    "Comment",
    "Constant",
    "Declare",
    "Discard",
    "Evaluate",
    "Expression",
    "Field",
    "For",
    "Function",
    "If",
    "Index",
    "Jump",
    "Kind",
    "Literal",
    "Member",
    "Name",
    "Return",
    "Statement",
    "Struct",
    "Unary",
    "Unit",
    "While",
    "Zero",
]


@dataclass(frozen=True)
class Kind:
    """A type: its name, whether it is a pointer, whether to what is not changed.

    ``length`` is the number of an array's elements, as C; ``given`` the types that a function
    behind a pointer takes.
    """

    name: str
    pointer: bool = False
    constant: bool = False
    length: str | None = None
    given: tuple[Kind, ...] | None = None


@dataclass(frozen=True)
class Literal:
    """A number, as C."""

    text: str
    kind: Kind


@dataclass(frozen=True)
class Name:
    """A variable, a constant or a function."""

    name: str


@dataclass(frozen=True)
class Unary:
    """``-x``, ``!x``, ``*x`` or ``&x``."""

    sign: str
    of: Expression


@dataclass(frozen=True)
class Binary:
    """Two operands."""

    sign: str
    left: Expression
    right: Expression


@dataclass(frozen=True)
class Choice:
    """``condition ? then : other``."""

    condition: Expression
    then: Expression
    other: Expression


@dataclass(frozen=True)
class Member:
    """A field of a structure, behind a pointer or not."""

    of: Expression
    name: str


@dataclass(frozen=True)
class Index:
    """An element of an array."""

    of: Expression
    at: Expression


@dataclass(frozen=True)
class Call:
    """A function's result."""

    name: str
    given: tuple[Expression, ...]


@dataclass(frozen=True)
class Cast:
    """A value as another type."""

    kind: Kind
    of: Expression


@dataclass(frozen=True)
class Zero:
    """A structure of zeros."""

    kind: Kind


Expression = Literal | Name | Unary | Binary | Choice | Member | Index | Call | Cast | Zero


@dataclass(frozen=True)
class Comment:
    """What C says between its statements."""

    text: str


@dataclass(frozen=True)
class Declare:
    """A local variable; without a value where that comes later."""

    name: str
    kind: Kind
    value: Expression | None


@dataclass(frozen=True)
class Assign:
    """``=``, or what changes a value by another one."""

    sign: str
    to: Expression
    value: Expression


@dataclass(frozen=True)
class Discard:
    """``(void)name``: that it is not used is meant."""

    name: str


@dataclass(frozen=True)
class Evaluate:
    """A call for what it does."""

    call: Call


@dataclass(frozen=True)
class Block:
    """Statements one after the other."""

    statements: tuple[Statement, ...]


@dataclass(frozen=True)
class If:
    """One way or another."""

    condition: Expression
    then: Block
    other: Block | If | None


@dataclass(frozen=True)
class While:
    """As long as a condition holds."""

    condition: Expression
    body: Block


@dataclass(frozen=True)
class For:
    """C's loop of three parts; any of them may be missing."""

    start: Assign | None
    condition: Expression | None
    step: Assign | None
    body: Block


@dataclass(frozen=True)
class Jump:
    """``break`` or ``continue``."""

    word: str


@dataclass(frozen=True)
class Return:
    """The end of a function."""

    value: Expression | None


Statement = (
    Comment | Declare | Assign | Discard | Evaluate | Block | If | While | For | Jump | Return
)


@dataclass(frozen=True)
class Field:
    """Of a structure."""

    name: str
    kind: Kind
    comment: str


@dataclass(frozen=True)
class Struct:
    """A structure."""

    name: str
    fields: tuple[Field, ...]


@dataclass(frozen=True)
class Array:
    """A constant table of numbers."""

    name: str
    kind: Kind
    values: tuple[Expression, ...]


@dataclass(frozen=True)
class Constant:
    """A constant number."""

    name: str
    value: Expression


@dataclass(frozen=True)
class Function:
    """A function with its comment."""

    name: str
    kind: Kind
    given: tuple[tuple[str, Kind], ...]
    body: Block
    comment: str


@dataclass(frozen=True)
class Unit:
    """All of a plant, in the order in which C states it.

    Attributes
    ----------
    constants, arrays, structs, functions : tuple
    same : dict of str to str
        Types that are another one.
    """

    constants: tuple[Constant, ...]
    arrays: tuple[Array, ...]
    structs: tuple[Struct, ...]
    functions: tuple[Function, ...]
    same: dict[str, str]
