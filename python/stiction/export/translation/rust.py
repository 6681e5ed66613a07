"""What the C of a plant states, as Rust: references for pointers, no allocation, nothing unsafe."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

from .names import (
    LIMITS,
    Counters,
    constant_name,
    find_changes,
    length,
    names,
    root,
    type_name,
    uses,
    variable,
)
from .tokens import TranslationError
from .tree import (
    Array,
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
    Field,
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

__all__ = ["rust_of"]

REAL, BOOL, INT = Kind("real"), Kind("bool"), Kind("int")
STEPS: Final = ("bool", "signed char", "int", "int32_t", "long", "int64_t", "uint64_t", "real")
"""Of two numbers, the type that comes later is that of both."""
BINDS: Final = {
    "*": 11, "/": 11, "%": 11, "+": 10, "-": 10, "<<": 9, ">>": 9, "&": 8, "^": 7, "|": 6,
    "==": 5, "!=": 5, "<": 5, ">": 5, "<=": 5, ">=": 5, "&&": 4, "||": 3,
}  # fmt: skip
ATOM, PREFIX, CAST, CHOICE = 15, 13, 12, 0
WRAPPING: Final = {"+": "wrapping_add", "-": "wrapping_sub", "*": "wrapping_mul"}
SAID: Final = {
    "stiction_state": "What a contact remembers.",
    "stiction_observer": "What an observer of disturbances remembers.",
}
"""Structures that are public."""
WIDTHS: Final = ("int32_t", "int64_t", "uint64_t")
"""Numbers of a stated width go round where they overflow: nothing is to end a step."""
INDENT: Final = "    "


def rust_of(unit: Unit) -> str:
    """Constants, structures and functions as Rust.

    What C calls ``stiction_...`` is public. ``Real`` and a module ``math`` with the functions of
    math.h are left to the text around.

    Raises
    ------
    TranslationError
        What has no counterpart here.
    """
    return "\n".join(_Writer(unit).items())


@dataclass(frozen=True)
class _Text:
    """An expression, its type, and how tightly it binds."""

    text: str
    kind: Kind
    binds: int = ATOM

    def within(self, least: int) -> str:
        return self.text if self.binds >= least else f"({self.text})"


@dataclass
class _Scope:
    """What a function knows.

    Attributes
    ----------
    kinds : dict of str to Kind
        Of parameters and variables.
    aliases : dict of str to Expression
        What pointers of its own point to.
    given : set of str
        Parameters that are references.
    changed : set of str
    counters : Counters
    steps : list of list of str
        What the loops around end each round with.
    """

    kinds: dict[str, Kind]
    aliases: dict[str, Expression]
    given: set[str]
    changed: set[str]
    counters: Counters
    result: Kind
    steps: list[list[str]] = field(default_factory=list)


class _Writer:
    def __init__(self, unit: Unit) -> None:
        self.unit = unit
        self.structs = {each.name: each for each in unit.structs}
        self.signatures = {
            each.name: tuple(kind for _, kind in each.given) for each in unit.functions
        }
        self.results = {each.name: each.kind for each in unit.functions}
        self.arrays = {each.name: each.kind for each in unit.arrays}
        nothing = Counters(frozenset())
        self.scope = _Scope({}, {}, set(), set(), nothing, Kind("void"))
        self.constants: dict[str, Kind] = {}

    # --- items

    def items(self) -> Iterator[str]:
        numbers: dict[str, str] = {}
        for constant in self.unit.constants:
            value = self.value(constant.value)
            self.constants[constant.name] = value.kind
            name, kind = constant_name(constant.name), type_name(value.kind.name)
            numbers[name] = f"const {name}: {kind} = {value.text};"
        for array in self.unit.arrays:
            numbers[constant_name(array.name)] = self.table(array)
        found = [self.struct(struct) for struct in self.unit.structs]
        found += [f"\ntype {type_name(a)} = {type_name(b)};" for a, b in self.unit.same.items()]
        found += [self.function(function) for function in self.unit.functions]
        # Where a macro of C is a number, not all of its uses are there.
        named = set(re.findall(r"\w+", "\n".join(found)))
        yield from (text for name, text in numbers.items() if name in named)
        yield from found

    def table(self, array: Array) -> str:
        values = [self.value(each).text for each in array.values]
        rows = [f"{INDENT}{', '.join(values[k : k + 4])}," for k in range(0, len(values), 4)]
        number = f"[{type_name(array.kind.name)}; {length(str(array.kind.length))}]"
        return "\n".join([f"static {constant_name(array.name)}: {number} = [", *rows, "];"])

    def struct(self, struct: Struct) -> str:
        name, said = type_name(struct.name), SAID.get(struct.name)
        lines = [""] if said is None else ["", f"/// {said}"]
        lines.append("#[derive(Clone, Copy, Debug)]")
        lines.append(f"{'' if said is None else 'pub '}struct {name} {{")
        for each in struct.fields:
            lines += [f"{INDENT}/// {line}" for line in each.comment.splitlines()]
            lines.append(f"{INDENT}{variable(each.name)}: {self.type_of(each.kind)},")
        lines += ["}", "", f"impl {name} {{", f"{INDENT}pub(crate) const ZERO: Self = Self {{"]
        for each in struct.fields:
            lines.append(f"{2 * INDENT}{variable(each.name)}: {self.zero(each.kind)},")
        return "\n".join([*lines, f"{INDENT}}};", "}"])

    def type_of(self, kind: Kind) -> str:
        if kind.given is not None:
            given = ", ".join(self.type_of(each) for each in kind.given)
            return f"fn({given}) -> {type_name(kind.name)}"
        name = type_name(kind.name)
        if kind.length is not None:
            return f"[{name}; {length(kind.length)}]"
        if kind.pointer and kind.name == "real" and kind.constant:
            return "&[Real]"
        if kind.pointer:
            return f"&{'' if kind.constant else 'mut '}{name}"
        return name

    def zero(self, kind: Kind) -> str:
        one = "0.0" if kind.name == "real" else "0"
        if kind.name not in STEPS:
            one = f"{type_name(kind.name)}::ZERO"
        return one if kind.length is None else f"[{one}; {length(kind.length)}]"

    def function(self, function: Function) -> str:
        aliases = {
            each.name: each.value
            for each in _declared(function.body)
            if each.kind.pointer and each.value is not None
        }
        for name, of in aliases.items():
            aliases[name] = of.of if isinstance(of, Unary) and of.sign == "&" else of
        self.scope = _Scope(
            dict(function.given),
            aliases,
            {name for name, kind in function.given if kind.pointer},
            find_changes(function, aliases, self.signatures),
            Counters.of(function),
            function.kind,
        )
        given = []
        for name, kind in function.given:
            mutable = not kind.pointer and name in self.scope.changed
            given.append(f"{'mut ' if mutable else ''}{variable(name)}: {self.type_of(kind)}")
        lines = ["", *(f"// {line}".rstrip() for line in function.comment.splitlines())]
        result = "" if function.kind.name == "void" else f" -> {self.type_of(function.kind)}"
        public = "pub " if function.name.startswith("stiction_") else ""
        lines.append(f"{public}fn {variable(function.name)}({', '.join(given)}){result} {{")
        lines += self.block(function.body, 1)
        # The last statement is the function's value.
        match = re.fullmatch(r"( +)return (.*);", lines[-1])
        lines[-1] = f"{match[1]}{match[2]}" if match else lines[-1]
        return "\n".join([*lines, "}"])

    # --- statements

    def block(self, block: Block, depth: int) -> list[str]:
        found: list[str] = []
        for statement in block.statements:
            found += [INDENT * depth + line for line in self.statement(statement)]
        return found

    def statement(self, of: Statement) -> list[str]:
        match of:
            case Comment(text):
                return [f"// {line}".rstrip() for line in text.splitlines()]
            case Declare():
                return self.declare(of)
            case Assign(sign, to, value):
                return [self.assign(sign, to, value)]
            case Discard(name):
                return [] if name in self.scope.aliases else [f"let _ = {variable(name)};"]
            case Evaluate(call):
                return [f"{self.value(call).text};"]
            case If():
                return self.branch(of)
            case While(condition, body):
                return self.loop(f"while {self.holds(condition).text}", body, [])
            case For():
                return self.count(of)
            case Jump("continue"):
                return [*self.scope.steps[-1], "continue;"]
            case Jump(word):
                return [f"{word};"]
            case Return(None):
                return ["return;"]
            case Return(value):
                assert value is not None
                return [f"return {self.number(value, self.scope.result)};"]
        raise TranslationError(type(of).__name__)

    def declare(self, of: Declare) -> list[str]:
        if of.name in self.scope.aliases or of.name in self.scope.counters.names:
            return []
        kind = of.kind
        if of.value is not None and kind.constant and kind.name == "int":
            # A truth that C keeps in a number stays one.
            found = self.value(of.value)
            kind = found.kind if found.kind.name == "bool" else kind
        self.scope.kinds[of.name] = kind
        value = self.zero(kind) if of.value is None else self.number(of.value, kind)
        mutable = "mut " if of.name in self.scope.changed else ""
        return [f"let {mutable}{variable(of.name)}: {self.type_of(kind)} = {value};"]

    def assign(self, sign: str, to: Expression, value: Expression) -> str:
        place = self.value(to)
        if place.kind.name in WIDTHS and sign[0] in WRAPPING:
            whole = Binary(sign[0], to, value)
            return f"{place.text} = {self.number(whole, place.kind)};"
        return f"{place.text} {sign} {self.number(value, place.kind)};"

    def branch(self, of: If) -> list[str]:
        lines = [f"if {self.holds(of.condition).text} {{", *self.block(of.then, 1)]
        if isinstance(of.other, If):
            first, *rest = self.branch(of.other)
            return [*lines, f"}} else {first}", *rest]
        if of.other is not None:
            lines += ["} else {", *self.block(of.other, 1)]
        return [*lines, "}"]

    def loop(self, head: str, body: Block, step: list[str]) -> list[str]:
        self.scope.steps.append(step)
        lines = [f"{head} {{", *self.block(body, 1), *(INDENT + line for line in step), "}"]
        self.scope.steps.pop()
        return lines

    def count(self, of: For) -> list[str]:
        counted = self.scope.counters.counts(of)
        if counted is not None:
            name, first, end = counted
            self.scope.kinds[name] = INT
            span = f"{self.value(first).text}..{self.value(end).text}"
            counter = variable(name) if uses(of.body, name) else "_"
            return self.loop(f"for {counter} in {span}", of.body, [])
        start = [] if of.start is None else self.statement(of.start)
        step = [] if of.step is None else self.statement(of.step)
        head = "loop" if of.condition is None else f"while {self.holds(of.condition).text}"
        return [*start, *self.loop(head, of.body, step)]

    # --- expressions

    def value(self, of: Expression) -> _Text:
        match of:
            case Literal(text, kind):
                return _Text(text, kind)
            case Name(name):
                return self.look_up(name)
            case Unary(sign, inner):
                return self.unary(sign, inner)
            case Binary(sign, left, right):
                return self.binary(sign, left, right)
            case Choice(condition, then, other):
                return self.choice(condition, then, other)
            case Member(inner, name):
                return _Text(f"{self.value(inner).within(ATOM)}.{variable(name)}", self.member(of))
            case Index(inner, at):
                whole, place = self.value(inner), self.value(at)
                if not (isinstance(at, Literal)):
                    place = _Text(f"{place.within(CAST)} as usize", INT, CAST)
                return _Text(f"{whole.within(ATOM)}[{place.text}]", Kind(whole.kind.name))
            case Call(name, given):
                return self.call(name, given)
            case Cast(kind, inner):
                return self.cast(kind, inner)
            case Zero(kind):
                return _Text(f"{type_name(kind.name)}::ZERO", kind)
        raise TranslationError(type(of).__name__)

    def look_up(self, name: str) -> _Text:
        scope = self.scope
        if name in scope.aliases:
            return self.value(scope.aliases[name])
        if name in scope.kinds:
            return _Text(variable(name), scope.kinds[name])
        if name in LIMITS:
            return _Text(LIMITS[name], REAL)
        if name in self.arrays:
            return _Text(constant_name(name), self.arrays[name])
        if name in self.constants:
            return _Text(constant_name(name), self.constants[name])
        if name in self.signatures:
            return _Text(variable(name), Kind(self.results[name].name, given=()))
        raise TranslationError(f"{name} is nowhere")

    def member(self, of: Member) -> Kind:
        kind = self.value(of.of).kind.name
        struct = self.structs[self.unit.same.get(kind, kind)]
        found: Field = next(each for each in struct.fields if each.name == of.name)
        return found.kind

    def unary(self, sign: str, inner: Expression) -> _Text:
        if sign == "!":
            found = self.value(inner)
            if found.kind.name == "bool":
                return _Text(f"!{found.within(PREFIX)}", BOOL, PREFIX)
            return _Text(f"{found.within(6)} == {self.zero(found.kind)}", BOOL, BINDS["=="])
        found = self.value(inner)
        if sign == "*":
            return _Text(f"*{found.within(PREFIX)}", Kind(found.kind.name), PREFIX)
        if sign != "-":
            raise TranslationError(f"{sign} outside of what a function is given")
        kind = INT if found.kind.name == "bool" else found.kind
        return _Text(f"-{self.number(inner, kind, PREFIX)}", kind, PREFIX)

    def holds(self, of: Expression) -> _Text:
        """A condition."""
        found = self.value(of)
        if found.kind.name == "bool":
            return found
        return _Text(f"{found.within(6)} != {self.zero(found.kind)}", BOOL, BINDS["!="])

    def binary(self, sign: str, left: Expression, right: Expression) -> _Text:
        binds = BINDS[sign]
        if sign in ("&&", "||"):
            one, other = self.holds(left), self.holds(right)
            return _Text(f"{one.within(binds)} {sign} {other.within(binds + 1)}", BOOL, binds)
        kind = self.both(left, right)
        compares = binds == BINDS["=="]
        if kind.name in WIDTHS and sign in WRAPPING:
            one_text = self.number(left, kind, ATOM)
            return _Text(f"{one_text}.{WRAPPING[sign]}({self.number(right, kind)})", kind)
        if sign in ("<<", ">>"):
            kind = self.value(left).kind
        one_text = self.number(left, kind, binds + compares)
        if sign[0] == "<" and re.search(r" as \w+$", one_text):
            # What follows a type would be taken for its parameters.
            one_text = f"({one_text})"
        other_kind = self.value(right).kind if sign in ("<<", ">>") else kind
        other_text = self.number(right, other_kind, binds + 1)
        return _Text(f"{one_text} {sign} {other_text}", BOOL if compares else kind, binds)

    def both(self, left: Expression, right: Expression) -> Kind:
        """The type in which two numbers meet; truths count as numbers."""
        names = [self.value(each).kind.name for each in (left, right)]
        found = Kind(max(names, key=STEPS.index))
        return INT if found.name == "bool" else found

    def choice(self, condition: Expression, then: Expression, other: Expression) -> _Text:
        one, two = self.value(then), self.value(other)
        if one.kind.given is not None:
            texts, kind = (one.text, two.text), one.kind
        else:
            kind = self.both(then, other)
            texts = (self.number(then, kind), self.number(other, kind))
        asked = self.holds(condition).text
        return _Text(f"if {asked} {{ {texts[0]} }} else {{ {texts[1]} }}", kind, CHOICE)

    def cast(self, kind: Kind, inner: Expression) -> _Text:
        if kind.name == "real" or isinstance(inner, Literal):
            text = self.number(inner, kind, 1)
            return _Text(text, kind, CAST if " as " in text else self.bound(inner))
        found = self.value(inner)
        return _Text(f"{found.within(CAST)} as {type_name(kind.name)}", kind, CAST)

    def bound(self, inner: Expression) -> int:
        """How tightly a number binds that stands for its cast."""
        found = self.value(inner)
        return found.binds if found.kind.name == "real" else ATOM

    def number(self, of: Expression, kind: Kind, least: int = 0) -> str:
        """An expression as a number of a type."""
        if isinstance(of, Literal):
            return _literal(of.text, kind)
        if isinstance(of, Unary) and of.sign == "-" and isinstance(of.of, Literal):
            return _Text(f"-{_literal(of.of.text, kind)}", kind, PREFIX).within(least)
        found = self.value(of)
        same = type_name(found.kind.name) == type_name(kind.name)
        if same or kind.name not in STEPS:
            return found.within(least)
        text = found.within(CAST)
        if found.kind.name == "bool" and kind.name == "real":
            text = f"{text} as i32"
        return _Text(f"{text} as {type_name(kind.name)}", kind, CAST).within(least)

    def call(self, name: str, given: tuple[Expression, ...]) -> _Text:
        if name.startswith("r_"):
            numbers = ", ".join(self.number(each, REAL) for each in given)
            return _Text(f"math::{name.removeprefix('r_')}({numbers})", REAL)
        kinds, result = self.signatures.get(name, ()), self.results.get(name)
        if name in self.scope.kinds:
            own = self.scope.kinds[name]
            kinds, result = own.given or (), Kind(own.name)
        if result is None:
            raise TranslationError(f"{name} is no function")
        parts = [self.argument(each, kind) for each, kind in zip(given, kinds, strict=True)]
        borrowed = [part.startswith("&mut ") for part in parts]
        taken = {self.base(root(each)) for each, own in zip(given, borrowed, strict=True) if own}
        before = ""
        for k, each in enumerate(given):
            # What is borrowed to be written cannot be read beside it.
            if not borrowed[k] and taken & {self.base(name) for name in names(each)}:
                before += f"let given_{k} = {parts[k]}; "
                parts[k] = f"given_{k}"
        text = f"{variable(name)}({', '.join(parts)})"
        return _Text(f"{{ {before}{text} }}" if before else text, result)

    def base(self, name: str | None) -> str | None:
        """The variable that a name stands for a part of."""
        while name in self.scope.aliases:
            name = root(self.scope.aliases[name])
        return name

    def argument(self, of: Expression, kind: Kind) -> str:
        if kind.given is not None:
            return self.value(of).text
        if not kind.pointer:
            return self.number(of, kind)
        if isinstance(of, Name) and of.name in self.scope.given:
            return variable(of.name)
        if isinstance(of, Cast) and of.of == Literal("0", INT):
            return "&[]"
        place = self.value(of.of if isinstance(of, Unary) and of.sign == "&" else of)
        if kind.name == "real" and kind.constant and place.kind.length is None:
            return f"core::slice::from_ref(&{place.within(PREFIX)})"
        return f"&{'' if kind.constant else 'mut '}{place.within(PREFIX)}"


def _literal(text: str, kind: Kind) -> str:
    if kind.name != "real" or not re.fullmatch(r"\d+", text):
        return text
    return f"{text}.0"


def _declared(block: Block) -> Iterator[Declare]:
    for each in block.statements:
        match each:
            case Declare():
                yield each
            case If(_, then, other):
                yield from _declared(then)
                if other is not None:
                    yield from _declared(other if isinstance(other, Block) else Block((other,)))
            case While(_, body) | For(_, _, _, body):
                yield from _declared(body)
