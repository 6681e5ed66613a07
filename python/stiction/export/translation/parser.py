"""The C of a plant, read."""

from __future__ import annotations

from typing import Final

from .tokens import Token, TranslationError, tokens_of
from .tree import (
    Array,
    Assign,
    Binary,
    Block,
    Call,
    Cast,
    Choice,
    Comment,
    Constant,
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

__all__ = ["parse"]

NUMBERS: Final = ("real", "int", "long", "int32_t", "int64_t", "uint64_t", "signed char", "void")
REAL, INT, UINT64 = Kind("real"), Kind("int"), Kind("uint64_t")
ORDER: Final = (
    ("||",), ("&&",), ("|",), ("^",), ("&",), ("==", "!="), ("<", ">", "<=", ">="),
    ("<<", ">>"), ("+", "-"), ("*", "/", "%"),
)  # fmt: skip
"""Of operators, the loosest first."""
ASSIGNS: Final = ("=", "+=", "-=", "*=", "/=", "^=", "|=")


def parse(text: str) -> Unit:
    """What a text of C states.

    Raises
    ------
    TranslationError
        What is beyond the part of C that is translated.
    """
    return _Parser(text).unit()


class _Parser:
    def __init__(self, text: str) -> None:
        self.tokens, self.constants = tokens_of(text)
        self.tokens.append(Token("end", ""))
        self.at = 0
        self.types = set(NUMBERS) | {"STICTION_REAL"}

    # --- words

    def here(self) -> Token:
        while self.tokens[self.at].kind == "comment":
            self.at += 1
        return self.tokens[self.at]

    def after(self, number: int) -> Token:
        """The word that many words later; comments do not count."""
        at = self.at
        self.here()
        words = (token for token in self.tokens[self.at :] if token.kind != "comment")
        for _ in range(number):
            next(words)
        self.at = at
        return next(words)

    def take(self) -> Token:
        token = self.here()
        self.at += 1
        return token

    def takes(self, text: str) -> bool:
        there = self.here().text == text
        self.at += there
        return there

    def expect(self, text: str) -> None:
        token = self.take()
        if token.text != text:
            raise TranslationError(f"'{token.text}' where '{text}' is needed")

    def name(self) -> str:
        token = self.take()
        if token.kind != "name":
            raise TranslationError(f"'{token.text}' where a name is needed")
        return token.text

    def comment(self) -> str:
        """The comment that comes next, without its signs; "" where there is none."""
        token = self.tokens[self.at]
        if token.kind != "comment":
            return ""
        self.at += 1
        lines = token.text[2:-2].strip().splitlines()
        return "\n".join(line.strip().removeprefix("*").strip() for line in lines)

    # --- types

    def begins_type(self, number: int = 0) -> bool:
        text = self.after(number).text
        return text in ("const", "signed", "static") or text in self.types

    def base(self) -> Kind:
        """A type without what its name adds."""
        self.takes("static")
        constant = self.takes("const")
        name = self.name()
        if name == "signed":
            self.expect("char")
            name = "signed char"
        if name not in self.types:
            raise TranslationError(f"the type {name}")
        constant = self.takes("const") or constant
        return Kind("real" if name == "STICTION_REAL" else name, constant=constant)

    def pointer(self, base: Kind) -> Kind:
        if not self.takes("*"):
            return base
        self.takes("const")
        return Kind(base.name, pointer=True, constant=base.constant)

    def array(self, kind: Kind) -> Kind:
        if not self.takes("["):
            return kind
        length = self.take().text
        self.expect("]")
        return Kind(kind.name, constant=kind.constant, length=length)

    # --- what stands outside of functions

    def unit(self) -> Unit:
        arrays, structs, functions = [], [], []
        same: dict[str, str] = {}
        comment = ""
        while True:
            comment = self.comment() or comment
            if self.tokens[self.at].kind == "comment":
                continue
            if self.here().kind == "end":
                break
            if self.takes("typedef"):
                found = self.typedef(same)
                structs += found
            else:
                base = self.pointer(self.base())
                name = self.name()
                if self.here().text == "[":
                    arrays.append(self.table(name, base))
                else:
                    functions.append(self.function(name, base, comment))
            comment = ""
        constants = tuple(
            Constant(name, _Parser(body).expression()) for name, body in self.constants.items()
        )
        return Unit(constants, tuple(arrays), tuple(structs), tuple(functions), same)

    def typedef(self, same: dict[str, str]) -> list[Struct]:
        if self.here().text != "struct":
            of, name = self.name(), self.name()
            self.expect(";")
            self.types.add(name)
            same[name] = of
            return []
        inner: list[Struct] = []
        fields = self.fields(inner)
        name = self.name()
        self.expect(";")
        self.types.add(name)
        return [*inner, Struct(name, fields)]

    def fields(self, inner: list[Struct]) -> tuple[Field, ...]:
        """Of a structure; those that have no name of their own get that of their field."""
        self.expect("struct")
        self.expect("{")
        found: list[Field] = []
        while not self.takes("}"):
            if self.here().text == "struct":
                own = self.fields(inner)
                name = self.name()
                inner.append(Struct(f"stiction_{name}", own))
                base = Kind(f"stiction_{name}")
                self.at -= 1
            else:
                base = self.base()
            named = []
            while True:
                name = self.name()
                named.append((name, self.array(base)))
                if not self.takes(","):
                    break
            self.expect(";")
            comment = self.comment()
            found += [Field(name, kind, comment) for name, kind in named]
        return tuple(found)

    def table(self, name: str, base: Kind) -> Array:
        kind = self.array(base)
        self.expect("=")
        self.expect("{")
        values = [self.expression()]
        while self.takes(","):
            values.append(self.expression())
        self.expect("}")
        self.expect(";")
        return Array(name, kind, tuple(values))

    def function(self, name: str, kind: Kind, comment: str) -> Function:
        self.expect("(")
        given = []
        while not self.takes(")"):
            given.append(self.parameter())
            self.takes(",")
        return Function(name, kind, tuple(given), self.block(), comment)

    def parameter(self) -> tuple[str, Kind]:
        base = self.base()
        if not self.takes("("):
            kind = self.pointer(base)
            return self.name(), kind
        self.expect("*")
        name = self.name()
        self.expect(")")
        self.expect("(")
        given = []
        while not self.takes(")"):
            given.append(self.pointer(self.base()))
            self.takes(",")
        return name, Kind(base.name, given=tuple(given))

    # --- statements

    def block(self) -> Block:
        self.expect("{")
        found: list[Statement] = []
        while True:
            comment = self.comment()
            if comment:
                found.append(Comment(comment))
            elif self.takes("}"):
                return Block(tuple(found))
            else:
                found += self.statement()

    def body(self) -> Block:
        if self.here().text == "{":
            return self.block()
        return Block(tuple(self.statement()))

    def statement(self) -> list[Statement]:
        word = self.here().text
        if word == "{":
            return [self.block()]
        if word == "if":
            return [self.branch()]
        if word == "while":
            self.take()
            self.expect("(")
            condition = self.expression()
            self.expect(")")
            return [While(condition, self.body())]
        if word == "for":
            return [self.loop()]
        if word in ("break", "continue"):
            self.take()
            self.expect(";")
            return [Jump(word)]
        if word == "return":
            self.take()
            value = None if self.here().text == ";" else self.expression()
            self.expect(";")
            return [Return(value)]
        if word == "(" and self.after(1).text == "void":
            for text in ("(", "void", ")"):
                self.expect(text)
            name = self.name()
            self.expect(";")
            return [Discard(name)]
        if self.begins_type():
            return list(self.declarations())
        found: list[Statement] = [self.action()]
        while isinstance(found[0], Assign) and self.takes("="):
            # The last of them is set first.
            outer, to = found[0], found[0].value
            found[:1] = [Assign("=", to, self.expression()), Assign(outer.sign, outer.to, to)]
        self.expect(";")
        return found

    def branch(self) -> If:
        self.expect("if")
        self.expect("(")
        condition = self.expression()
        self.expect(")")
        then = self.body()
        other: Block | If | None = None
        if self.takes("else"):
            other = self.branch() if self.here().text == "if" else self.body()
        return If(condition, then, other)

    def loop(self) -> For:
        self.expect("for")
        self.expect("(")
        start = None if self.here().text == ";" else self.assignment()
        self.expect(";")
        condition = None if self.here().text == ";" else self.expression()
        self.expect(";")
        step = None if self.here().text == ")" else self.assignment()
        self.expect(")")
        return For(start, condition, step, self.body())

    def assignment(self) -> Assign:
        found = self.action()
        if not isinstance(found, Assign):
            raise TranslationError("a loop that calls")
        return found

    def action(self) -> Assign | Evaluate:
        if self.takes("++"):
            return Assign("+=", self.expression(), Literal("1", INT))
        to = self.unary()
        sign = self.here().text
        if sign in ASSIGNS:
            self.take()
            return Assign(sign, to, self.expression())
        if isinstance(to, Call):
            return Evaluate(to)
        raise TranslationError(f"a statement that ends before '{sign}'")

    def declarations(self) -> list[Declare]:
        base = self.base()
        found = []
        while True:
            kind = self.pointer(base)
            name = self.name()
            kind = self.array(kind)
            value = self.initial(kind) if self.takes("=") else None
            found.append(Declare(name, kind, value))
            if not self.takes(","):
                break
        self.expect(";")
        return found

    def initial(self, kind: Kind) -> Expression:
        if not self.takes("{"):
            return self.expression()
        self.expect("0")
        self.expect("}")
        return Zero(Kind(kind.name))

    # --- expressions

    def expression(self) -> Expression:
        condition = self.binary(0)
        if not self.takes("?"):
            return condition
        then = self.expression()
        self.expect(":")
        return Choice(condition, then, self.expression())

    def binary(self, level: int) -> Expression:
        if level == len(ORDER):
            return self.unary()
        left = self.binary(level + 1)
        while self.here().kind == "sign" and self.here().text in ORDER[level]:
            sign = self.take().text
            left = Binary(sign, left, self.binary(level + 1))
        return left

    def unary(self) -> Expression:
        sign = self.here().text
        if sign in ("-", "!", "*", "&"):
            self.take()
            return Unary(sign, self.unary())
        if sign == "(" and self.begins_type(1):
            self.take()
            kind = self.pointer(self.base())
            self.expect(")")
            if self.takes("{"):
                self.expect("0")
                self.expect("}")
                return Zero(kind)
            return Cast(kind, self.unary())
        return self.postfix(self.primary())

    def postfix(self, found: Expression) -> Expression:
        while True:
            if self.takes(".") or self.takes("->"):
                found = Member(found, self.name())
            elif self.takes("["):
                found = Index(found, self.expression())
                self.expect("]")
            else:
                return found

    def primary(self) -> Expression:
        token = self.take()
        if token.kind == "number":
            whole = token.text.isdigit() or token.text.lower().startswith("0x")
            return Literal(token.text, INT if whole else REAL)
        if token.text == "(":
            found = self.expression()
            self.expect(")")
            return found
        if token.kind != "name":
            raise TranslationError(f"'{token.text}' in an expression")
        if not self.takes("("):
            return Name(token.text)
        given = []
        while not self.takes(")"):
            given.append(self.expression())
            self.takes(",")
        if token.text in ("R", "UINT64_C"):
            return Cast(REAL if token.text == "R" else UINT64, given[0])
        return Call(token.text, tuple(given))
