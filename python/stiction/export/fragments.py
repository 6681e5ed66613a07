"""Fragments of C with the numbers of one plant: what these leave without effect is left out.

A fragment is a C file in ``export/c``. What begins with ``#`` there and is none of C's own:

``#let NAME = expression``
    A number, or a list of them, of the numbers known so far, in Python; ``\\`` goes on in the next
    line. What the C names becomes a constant.
``#if expression``, ``#ifdef NAME``, ``#else``, ``#endif``
    Decided here, over numbers, options (words) and flags.
``#define NAME``
    Without a value: a flag.
``#include "name.c"``
    A fragment of ``export/c/elements``, once.
``#each hook``, ``#end``
    The lines between, for each effect that has the hook, ``EFFECT`` being its name.

Lines that begin with ``# `` are for the compiler.

A law defines ``law_step``, and for a machine that moves what divides a sample: ``STIFFEST``, the
greatest stiffness, ``CALMS``, the greatest damping, and ``FALLS_BY``, by how much friction falls
with speed. Its flags: ``RIGID`` holds a body without giving way, ``DRAGGED_ALONG`` has a mode that
ends where motion turns, ``STEEP`` solves for the velocity itself (``law_arrive``), ``EXCHANGES``
may be stated over time, ``BENDS`` with its force as a state (``law_rate``), ``OWN_VISCOUS`` has its
viscous part. Where a machine moves (``MACHINE``) ``m->start`` is the velocity at the start of a
step, and ``law_breaks`` says where one ran past a kink. How stiff an effect is at most is
``NAME_STIFFNESS``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from typing import Any, Final

__all__ = ["Fragments", "fragment", "names_of"]

WORDS: Final = re.compile(r"\b[A-Za-z_]\w*\b")
COMMENTS: Final = re.compile(r"/\*.*?\*/", re.S)


def logarithmic_mean(u: float) -> float:
    """−ln(1 − u)/u for u < 1; 1 at u = 0."""
    return 1.0 if u == 0.0 else -math.log1p(-u) / u


CALLABLE: Final = (any, all, int, max, min, range, sum, zip, logarithmic_mean)
CALLED: Final[dict[str, Any]] = {
    **{name: getattr(math, name) for name in ("exp", "expm1", "hypot", "log", "inf")},
    **{each.__name__: each for each in CALLABLE},
}
"""What expressions may call."""


@cache
def fragment(path: str) -> str | None:
    """Text of a fragment, of a path below ``export/c`` without its ending; None: there is none."""
    file = files(__package__).joinpath("c", *f"{path}.c".split("/"))
    return file.read_text(encoding="utf-8") if file.is_file() else None


@cache
def names_of(kind: str) -> tuple[str, ...]:
    """Names of the fragments of one kind: laws, effects or elements."""
    folder = files(__package__).joinpath("c", kind)
    names = [file.name.removesuffix(".c") for file in folder.iterdir() if file.name.endswith(".c")]
    return tuple(sorted(names))


@dataclass
class Fragments:
    """Fragments for one plant.

    Attributes
    ----------
    numbers : dict of str
        Numbers, lists of numbers and words by the names that fragments call them.
    flags : set of str
    hooks : mapping of str to tuple of str
        Effects by what they do: "level", "viscous_level", "effort", "remember", "creep",
        "init".
    """

    numbers: dict[str, Any]
    flags: set[str] = field(default_factory=set)
    hooks: Mapping[str, Iterable[str]] = field(default_factory=dict)
    _included: set[str] = field(default_factory=set)

    def expand(self, path: str) -> str:
        """Text of a fragment with its own lines of this language carried out."""
        return "\n".join(self._lines(path)) + "\n"

    def constants(self, text: str) -> str:
        """Definitions of what a text names."""
        named = set(WORDS.findall(COMMENTS.sub("", text)))
        return "".join(
            _definition(name, value) for name, value in self.numbers.items() if name in named
        )

    def _lines(self, path: str) -> Iterator[str]:
        text = fragment(path)
        assert text is not None, path
        taken: list[bool] = []
        lines = iter(text.splitlines())
        for line in lines:
            word, _, rest = line.partition(" ")
            if word in ("#if", "#ifdef"):
                there = all(taken) and self._holds(word, rest)
                taken.append(there)
            elif word == "#else":
                taken[-1] = all(taken[:-1]) and not taken[-1]
            elif word == "#endif":
                taken.pop()
            elif all(taken):
                yield from self._line(line, word, rest, lines)

    def _line(self, line: str, word: str, rest: str, lines: Iterator[str]) -> Iterator[str]:
        if word == "#let":
            while rest.endswith("\\"):
                rest = rest[:-1] + next(lines).strip()
            name, _, expression = rest.partition(" = ")
            self.numbers[name] = self._value(expression)
        elif word == "#define" and " " not in rest:
            self.flags.add(rest)
        elif word == "#include" and rest.startswith('"'):
            name = rest.strip('"').removesuffix(".c")
            if name not in self._included:
                self._included.add(name)
                yield from self._lines(f"elements/{name}")
                yield ""
        elif word == "#each":
            inside = list(iter(lambda: next(lines), "#end"))
            for effect in self.hooks.get(rest, ()):
                yield from (each.replace("EFFECT", effect) for each in inside)
        else:
            yield line

    def _holds(self, word: str, rest: str) -> bool:
        return rest in self.flags if word == "#ifdef" else bool(self._value(rest))

    def _value(self, expression: str) -> Any:
        # Fragments are code of this package, no input: nothing of a plant is in the expression.
        return eval(expression, {"__builtins__": {}, **CALLED, **self.numbers})


def _definition(name: str, value: Any) -> str:
    if isinstance(value, list):
        rows = [", ".join(map(_number, value[k : k + 4])) for k in range(0, len(value), 4)]
        inside = ",\n    ".join(rows)
        return f"static const real {name}[{len(value)}] = {{\n    {inside}\n}};\n"
    return f"#define {name} {value if isinstance(value, str) else _number(value)}\n"


def _number(value: float) -> str:
    return f"R({value!r})" if math.isfinite(value) else "R(INFINITY)"
