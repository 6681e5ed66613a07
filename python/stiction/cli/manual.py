"""The manual page, from the same tree of verbs as help and completion."""

from __future__ import annotations

from collections.abc import Iterator

import cyclopts

from .app import VERBS, build

__all__ = ["manual"]

_STATUS = (
    ("0", "an answer, whatever it says"),
    ("2", "the request cannot be read: one sentence on standard error says what to change"),
    ("130", "interrupted; the best so far is written"),
    ("1", "a fault of the program"),
)


def manual() -> str:
    """The page in the language of man, for section 1."""
    from .. import __version__

    app = build()
    lines = [
        f'.TH STICTION 1 "" "stiction {_roff(__version__)}" "User Commands"',
        ".SH NAME",
        "stiction \\- simulate friction, and find what a simulation of a machine lacks",
        ".SH SYNOPSIS",
        ".B stiction",
        "COMMAND [OPTIONS]",
        ".SH DESCRIPTION",
        _roff(app.help),
        ".SH COMMANDS",
    ]
    for verb in VERBS:
        lines += [".SS", f"stiction {verb.name}", ".PP", _roff(verb.summary)]
        lines += _options(app[verb.name])
        lines += [".PP", "Examples:", ".nf"]
        lines += [f"    stiction {_roff(words)}" for words, _ in verb.examples]
        lines.append(".fi")
    lines.append(".SH EXIT STATUS")
    for status, meaning in _STATUS:
        lines += [".TP", f".B {status}", _roff(meaning)]
    return "\n".join(lines) + "\n"


def _options(app: cyclopts.App) -> Iterator[str]:
    """What a verb takes, and each of the verbs below it."""
    for name in app:
        if not name.startswith("-"):
            yield from (".PP", f".B {name}")
            yield from _options(app[name])
    if app.default_command is None:
        return
    for argument in app.assemble_argument_collection(parse_docstring=True):
        if argument.parse and argument.show:
            flags = ", ".join(each for each in argument.names if each)
            yield from (".TP", f".B {_roff(flags)}", _roff(argument.parameter.help or ""))


def _roff(text: str) -> str:
    """A text in which nothing is a command of roff."""
    flat = " ".join(text.split()).replace("\\", "\\e").replace("-", "\\-")
    return f"\\&{flat}" if flat.startswith((".", "'")) else flat
