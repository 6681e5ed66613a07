"""Tokens of the C of a plant, its macros carried out."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

__all__ = ["Macro", "Token", "TranslationError", "tokens_of"]

TOKEN: Final = re.compile(
    r"(?P<comment>/\*.*?\*/)|(?P<space>\s+)"
    r"|(?P<number>0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<sign>->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/^|]=|[-+*/%<>=!&|^~?:;,.(){}\[\]])",
    re.S,
)
LITERAL: Final = re.compile(r"(R|UINT64_C)\([^()]*\)|-?\d+")
"""What stays a constant where a macro has it as its body."""


class TranslationError(ValueError):
    """C that is beyond the part of the language that is translated."""


@dataclass(frozen=True)
class Token:
    """One word of C.

    Attributes
    ----------
    kind : {"comment", "number", "name", "sign", "end"}
    text : str
    """

    kind: str
    text: str


@dataclass(frozen=True)
class Macro:
    """A macro: names of what it is given, None where it is given nothing, and its body."""

    given: tuple[str, ...] | None
    body: tuple[Token, ...]


def tokens_of(text: str) -> tuple[list[Token], dict[str, str]]:
    """Tokens of a text without its macros, and macros that are constants, as C.

    Raises
    ------
    TranslationError
        Any other directive, or a character that is no C.
    """
    macros: dict[str, Macro] = {}
    constants: dict[str, str] = {}
    found: list[Token] = []
    lines = iter(re.sub(r"\\\n", " ", text).splitlines(keepends=True))
    plain = ""
    for line in lines:
        if not line.startswith("#"):
            plain += line
            continue
        found += _expanded(list(_words(plain)), macros)
        plain = ""
        match = re.fullmatch(r"#define (\w+)(\([^)]*\))?(?: (.*))?\n?", line)
        if match is None:
            raise TranslationError(line.strip())
        name, given, body = match[1], match[2], (match[3] or "").strip()
        if given is None and LITERAL.fullmatch(body):
            constants[name] = body
            continue
        names = None if given is None else tuple(part.strip() for part in given[1:-1].split(","))
        macros[name] = Macro(names, tuple(_words(body)))
    found += _expanded(list(_words(plain)), macros)
    return found, constants


def _words(text: str) -> Iterator[Token]:
    at = 0
    while at < len(text):
        match = TOKEN.match(text, at)
        if match is None:
            raise TranslationError(text[at : at + 20])
        at = match.end()
        kind = str(match.lastgroup)
        if kind != "space":
            yield Token(kind, match[0])


def _expanded(words: list[Token], macros: dict[str, Macro]) -> list[Token]:
    """Words with macros carried out, those of their bodies too."""
    found: list[Token] = []
    at = 0
    while at < len(words):
        word = words[at]
        at += 1
        macro = macros.get(word.text) if word.kind == "name" else None
        if macro is None:
            found.append(word)
        elif macro.given is None:
            found += _expanded(list(macro.body), macros)
        else:
            parts, at = _given(words, at)
            by_name = dict(zip(macro.given, parts, strict=True))
            body: list[Token] = []
            for each in macro.body:
                body += by_name.get(each.text, [each]) if each.kind == "name" else [each]
            found += _expanded(body, macros)
    return found


def _given(words: list[Token], at: int) -> tuple[list[list[Token]], int]:
    """What a macro is given, from its opening bracket on, and where its closing one ends."""
    parts: list[list[Token]] = [[]]
    depth = 0
    while True:
        word = words[at]
        at += 1
        depth += (word.text in "([") - (word.text in ")]") if word.kind == "sign" else 0
        if depth == 0:
            return parts, at
        if word.text == "," and depth == 1:
            parts.append([])
        elif not (word.text == "(" and depth == 1):
            parts[-1].append(word)
