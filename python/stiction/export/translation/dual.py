"""What the C of a plant computes, with its derivative: the same statements over dual numbers.

A dual number has a value, how that changes ahead of where the machine goes, and how it changes in
the direction that is asked for. At equal values what lies ahead decides a comparison, so that at a
kink, such as a spring at its level, the derivative is that of the side on which motion goes on.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from .names import nodes
from .tokens import TranslationError
from .tree import (
    Assign,
    Binary,
    Block,
    Call,
    Cast,
    Choice,
    Comment,
    Declare,
    Discard,
    Evaluate,
    Expression,
    For,
    Function,
    If,
    Index,
    Jump,
    Kind,
    Literal,
    Member,
    Name,
    Return,
    Statement,
    Struct,
    Unary,
    Unit,
    While,
    Zero,
)

__all__ = ["call_graph", "dual_of"]

REAL, INT, CONSTANT = Kind("real"), Kind("int"), Kind("constant")
"""Numbers with a derivative, whole ones, and those that never change."""
ARITHMETIC: Final = {"+": "add", "-": "subtract", "*": "multiply", "/": "divide"}
COMPARED: Final = {
    "<": ("less", "{0}, {1}"),
    ">": ("less", "{1}, {0}"),
    "<=": ("at_most", "{0}, {1}"),
    ">=": ("at_most", "{1}, {0}"),
    "==": ("equal", "{0}, {1}"),
    "!=": ("!equal", "{0}, {1}"),
}
INDENT: Final = "    "
TYPE: Final = """
/* The same over dual numbers: a value, how it changes ahead of where the machine goes, which
 * decides between equal values, and how it changes in the direction that is asked for. */
typedef struct {
    real value, ahead, tangent;
} dual;
"""
OF_TWO: Final = "static {kind} dual_{name}(dual a, dual b)\n{{\n    return {result};\n}}\n"
OF_ONE: Final = """\
static dual dual_{name}(dual a)
{{
    const real value = {value}, slope = {slope};
    return (dual){{value, slope * a.ahead, slope * a.tangent}};
}}
"""
FUNCTIONS: Final = {
    "of": ("static dual dual_of(real a)\n{\n    return (dual){a, R(0), R(0)};\n}\n"),
    "add": OF_TWO.format(
        kind="dual",
        name="add",
        result="(dual){a.value + b.value, a.ahead + b.ahead, a.tangent + b.tangent}",
    ),
    "subtract": OF_TWO.format(
        kind="dual",
        name="subtract",
        result="(dual){a.value - b.value, a.ahead - b.ahead, a.tangent - b.tangent}",
    ),
    "multiply": OF_TWO.format(
        kind="dual",
        name="multiply",
        result="(dual){a.value * b.value, a.ahead * b.value + a.value * b.ahead,\n"
        "                  a.tangent * b.value + a.value * b.tangent}",
    ),
    "divide": (
        "static dual dual_divide(dual a, dual b)\n{\n"
        "    const real value = a.value / b.value;\n"
        "    return (dual){value, (a.ahead - value * b.ahead) / b.value,\n"
        "                  (a.tangent - value * b.tangent) / b.value};\n}\n"
    ),
    "less": OF_TWO.format(
        kind="int",
        name="less",
        result="a.value < b.value || (a.value == b.value && a.ahead < b.ahead)",
    ),
    "at_most": OF_TWO.format(
        kind="int",
        name="at_most",
        result="a.value < b.value || (a.value == b.value && a.ahead <= b.ahead)",
    ),
    "equal": OF_TWO.format(
        kind="int", name="equal", result="a.value == b.value && a.ahead == b.ahead"
    ),
    # At zero a root is infinitely steep; a solver is better served by no slope than by that.
    "pow": (
        "static dual dual_pow(dual a, real n)\n{\n"
        "    const real value = r_pow(a.value, n);\n"
        "    const real slope = a.value == R(0) && n < R(1) ? R(0)\n"
        "        : n * r_pow(a.value, n - R(1));\n"
        "    return (dual){value, slope * a.ahead, slope * a.tangent};\n}\n"
    ),
} | {
    name: OF_ONE.format(name=name, value=value, slope=slope)
    for name, value, slope in (
        ("negative", "-a.value", "R(-1)"),
        ("fabs", "r_fabs(a.value)", "dual_less(a, dual_of(R(0))) ? R(-1) : R(1)"),
        ("sqrt", "r_sqrt(a.value)", "R(0.5) / value"),
        ("exp", "r_exp(a.value)", "value"),
        ("expm1", "r_expm1(a.value)", "value + R(1)"),
        ("log", "r_log(a.value)", "R(1) / a.value"),
        ("log1p", "r_log1p(a.value)", "R(1) / (R(1) + a.value)"),
        ("sin", "r_sin(a.value)", "r_cos(a.value)"),
        ("cos", "r_cos(a.value)", "-r_sin(a.value)"),
    )
}
"""What dual numbers are added, compared and computed with, in the order in which C needs it."""


def call_graph(unit: Unit, entry: str) -> tuple[Function, ...]:
    """A function of a unit and all that it calls, in the order in which C states them."""
    functions = {each.name: each for each in unit.functions}
    found: set[str] = set()
    left = [entry]
    while left:
        name = left.pop()
        if name in functions and name not in found:
            found.add(name)
            left += [node.name for node in nodes(functions[name].body) if isinstance(node, Call)]
    return tuple(each for each in unit.functions if each.name in found)


def dual_of(unit: Unit, entry: str, lifted: tuple[str, ...]) -> str:
    """C of a function and all that it calls over dual numbers, each named ``dual_...``.

    Parameters
    ----------
    unit : Unit
    entry : str
        Name of the function.
    lifted : tuple of str
        Structures that are made dual, by functions ``lift_...``.

    Raises
    ------
    TranslationError
        What has no derivative here: functions that are passed on, numbers that are made whole.
    """
    writer = _Writer(unit)
    body = "\n".join(
        [
            *writer.structs_of(),
            *writer.lifts(lifted),
            *map(writer.function, call_graph(unit, entry)),
        ]
    )
    used = set(re.findall(r"\bdual_(\w+)\(", body))
    if "fabs" in used:
        used |= {"less", "of"}
    return TYPE + "".join("\n" + text for name, text in FUNCTIONS.items() if name in used) + body


@dataclass(frozen=True)
class _Text:
    """An expression and its type."""

    text: str
    kind: Kind

    @property
    def dual(self) -> bool:
        return self.kind.name == "real" and not self.kind.pointer and self.kind.length is None

    def lift(self) -> str:
        return self.text if self.dual else f"dual_of({self.text})"


class _Writer:
    def __init__(self, unit: Unit) -> None:
        self.unit = unit
        self.structs = {each.name: each for each in unit.structs}
        self.functions = {each.name: each for each in unit.functions}
        self.arrays = {each.name for each in unit.arrays}
        self.kinds: dict[str, Kind] = {}
        self.result = REAL

    # --- types

    def struct(self, name: str) -> Struct | None:
        return self.structs.get(self.unit.same.get(name, name))

    def type_of(self, kind: Kind) -> str:
        if kind.given is not None:
            raise TranslationError("a function that is passed on, where a derivative is needed")
        name = kind.name
        if name == "real":
            name = "dual"
        elif self.struct(name) is not None:
            name = f"dual_{name}"
        return f"{'const ' if kind.constant else ''}{name} {'*' if kind.pointer else ''}"

    def structs_of(self) -> Iterator[str]:
        told: set[str] = set()
        for struct in self.unit.structs:
            for alias, of in self.unit.same.items():
                if of in told and alias not in told:
                    told.add(alias)
                    yield f"typedef dual_{of} dual_{alias};"
            told.add(struct.name)
            yield "typedef struct {"
            for each in struct.fields:
                length = "" if each.kind.length is None else f"[{each.kind.length}]"
                yield f"{INDENT}{self.type_of(each.kind)}{each.name}{length};"
            yield f"}} dual_{struct.name};"

    def lifts(self, wanted: tuple[str, ...]) -> Iterator[str]:
        """Functions that make structures dual, those of their fields first."""
        inside: list[str] = []

        def visit(name: str) -> None:
            struct = self.struct(name)
            if struct is None or struct.name in inside:
                return
            for each in struct.fields:
                visit(each.kind.name)
            inside.append(struct.name)

        for name in wanted:
            visit(name)
        for name in inside:
            struct = self.structs[name]
            yield f"\nstatic dual_{name} lift_{name}(const {name} *of)\n{{"
            yield f"{INDENT}dual_{name} made;"
            if any(each.kind.length is not None for each in struct.fields):
                yield f"{INDENT}int k;"
            for each in struct.fields:
                yield from self.lift(each.name, each.kind)
            yield f"{INDENT}return made;\n}}"

    def lift(self, name: str, kind: Kind) -> Iterator[str]:
        at = name if kind.length is None else f"{name}[k]"
        struct = self.struct(kind.name)
        value = f"of->{at}"
        if struct is not None:
            value = f"lift_{struct.name}(&of->{at})"
        elif kind.name == "real":
            value = f"dual_of(of->{at})"
        depth = INDENT
        if kind.length is not None:
            yield f"{INDENT}for (k = 0; k < {kind.length}; ++k) {{"
            depth += INDENT
        yield f"{depth}made.{at} = {value};"
        if kind.length is not None:
            yield f"{INDENT}}}"

    # --- functions

    def function(self, of: Function) -> str:
        self.kinds, self.result = dict(of.given), of.kind
        given = ", ".join(f"{self.type_of(kind)}{name}" for name, kind in of.given)
        head = f"static {self.type_of(of.kind)}dual_{of.name}({given})"
        return "\n".join(["", head, "{", *self.block(of.body), "}"])

    def block(self, of: Block) -> list[str]:
        return [INDENT + line for each in of.statements for line in self.statement(each)]

    def statement(self, of: Statement) -> list[str]:
        match of:
            case Comment():
                return []
            case Declare(name, kind, value):
                self.kinds[name] = kind
                length = "" if kind.length is None else f"[{kind.length}]"
                end = "" if value is None else f" = {self.as_kind(value, kind)}"
                return [f"{self.type_of(kind)}{name}{length}{end};"]
            case Assign():
                return [f"{self.assign(of)};"]
            case Discard(name):
                return [f"(void){name};"]
            case Evaluate(call):
                return [f"{self.value(call).text};"]
            case Block():
                return ["{", *self.block(of), "}"]
            case If():
                return self.branch(of)
            case While(condition, body):
                return [f"while ({self.holds(condition)}) {{", *self.block(body), "}"]
            case For(start, condition, step, body):
                first, last = ("" if each is None else self.assign(each) for each in (start, step))
                holds = "" if condition is None else self.holds(condition)
                return [f"for ({first}; {holds}; {last}) {{", *self.block(body), "}"]
            case Jump(word):
                return [f"{word};"]
            case Return(None):
                return ["return;"]
            case Return(value):
                assert value is not None
                return [f"return {self.as_kind(value, self.result)};"]
        raise TranslationError(type(of).__name__)

    def branch(self, of: If) -> list[str]:
        lines = [f"if ({self.holds(of.condition)}) {{", *self.block(of.then)]
        if isinstance(of.other, If):
            first, *rest = self.branch(of.other)
            return [*lines, f"}} else {first}", *rest]
        if of.other is not None:
            lines += ["} else {", *self.block(of.other)]
        return [*lines, "}"]

    def assign(self, of: Assign) -> str:
        to = self.value(of.to)
        if not to.dual:
            return f"{to.text} {of.sign} {self.as_kind(of.value, to.kind)}"
        value = of.value if of.sign == "=" else Binary(of.sign[0], of.to, of.value)
        return f"{to.text} = {self.value(value).lift()}"

    # --- expressions

    def as_kind(self, of: Expression, kind: Kind) -> str:
        """A value where one of a type is needed."""
        found = self.value(of)
        if _Text("", kind).dual:
            return found.lift()
        if found.dual:
            raise TranslationError(f"{found.text} where it has no derivative")
        return found.text

    def holds(self, of: Expression) -> str:
        found = self.value(of)
        if found.dual:
            return f"!dual_equal({found.text}, dual_of(R(0)))"
        return found.text

    def value(self, of: Expression) -> _Text:
        match of:
            case Literal(text, kind):
                return _Text(text, CONSTANT if kind == REAL else kind)
            case Name(name):
                array = Kind("constant", length="") if name in self.arrays else CONSTANT
                return _Text(name, self.kinds.get(name, array))
            case Unary(sign, inner):
                return self.unary(sign, inner)
            case Binary(sign, left, right):
                return self.binary(sign, left, right)
            case Choice(condition, then, other):
                one, two = self.value(then), self.value(other)
                holds = self.holds(condition)
                if one.dual or two.dual:
                    return _Text(f"({holds} ? {one.lift()} : {two.lift()})", REAL)
                return _Text(f"({holds} ? {one.text} : {two.text})", one.kind)
            case Member(inner, name):
                whole = self.value(inner)
                struct = self.struct(whole.kind.name)
                if struct is None:
                    raise TranslationError(f"{name} of {whole.text}")
                kind = next(each.kind for each in struct.fields if each.name == name)
                return _Text(f"{whole.text}{'->' if whole.kind.pointer else '.'}{name}", kind)
            case Index(inner, at):
                whole = self.value(inner)
                return _Text(f"{whole.text}[{self.as_kind(at, INT)}]", Kind(whole.kind.name))
            case Call():
                return self.call(of)
            case Cast(kind, inner):
                found = self.value(inner)
                if kind.pointer:
                    return _Text(f"({self.type_of(kind)}){found.text}", kind)
                if kind.name == "real":
                    return found if found.dual else _Text(f"(real)({found.text})", CONSTANT)
                return _Text(f"({kind.name})({self.as_kind(inner, kind)})", kind)
            case Zero(kind):
                return _Text(f"({self.type_of(kind).strip()}){{0}}", kind)
        raise TranslationError(type(of).__name__)

    def unary(self, sign: str, inner: Expression) -> _Text:
        if sign == "!":
            return _Text(f"!({self.holds(inner)})", INT)
        found = self.value(inner)
        if sign == "*":
            return _Text(f"(*{found.text})", Kind(found.kind.name))
        if sign == "&":
            return _Text(f"&{found.text}", Kind(found.kind.name, pointer=True))
        if found.dual:
            return _Text(f"dual_negative({found.text})", REAL)
        return _Text(f"(-{found.text})", found.kind)

    def binary(self, sign: str, left: Expression, right: Expression) -> _Text:
        if sign in ("&&", "||"):
            return _Text(f"(({self.holds(left)}) {sign} ({self.holds(right)}))", INT)
        one, two = self.value(left), self.value(right)
        if not (one.dual or two.dual):
            kind = CONSTANT if "constant" in (one.kind.name, two.kind.name) else one.kind
            kind = INT if sign in COMPARED else kind
            return _Text(f"({one.text} {sign} {two.text})", kind)
        if sign in COMPARED:
            name, order = COMPARED[sign]
            text = order.format(one.lift(), two.lift())
            return _Text(f"{'!' * (name[0] == '!')}dual_{name.removeprefix('!')}({text})", INT)
        if sign not in ARITHMETIC:
            raise TranslationError(f"{sign} of numbers that have a derivative")
        return _Text(f"dual_{ARITHMETIC[sign]}({one.lift()}, {two.lift()})", REAL)

    def call(self, of: Call) -> _Text:
        if not of.name.startswith("r_"):
            function = self.functions[of.name]
            given = [
                self.as_kind(each, kind)
                for each, (_, kind) in zip(of.given, function.given, strict=True)
            ]
            return _Text(f"dual_{of.name}({', '.join(given)})", function.kind)
        name, found = of.name.removeprefix("r_"), [self.value(each) for each in of.given]
        if not any(each.dual for each in found):
            return _Text(f"{of.name}({', '.join(each.text for each in found)})", CONSTANT)
        if name not in FUNCTIONS or any(each.dual for each in found[1:]):
            raise TranslationError(f"{of.name} has no derivative here")
        return _Text(
            f"dual_{name}({', '.join([found[0].lift(), *(e.text for e in found[1:])])})", REAL
        )
