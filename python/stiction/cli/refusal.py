"""What the parser of the command line refuses, in a sentence."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Literal, get_args, get_origin

import cyclopts
from cyclopts import exceptions

from .._support.wording import commas, did_you_mean, nearest

__all__ = ["refusal"]

OPTIONS = ("--help", "--version")
"""Of the program itself."""
OTHERS = {
    **dict.fromkeys(("identify", "estimate", "calibrate", "train"), "fit"),
    **dict.fromkeys(("analyze", "analyse", "find", "run"), "diagnose"),
    **dict.fromkeys(("list", "models"), "laws"),
    **dict.fromkeys(("excite", "design"), "plan"),
    **dict.fromkeys(("feedforward", "control"), "compensate"),
    **dict.fromkeys(("convert", "generate"), "export"),
    **dict.fromkeys(("jobs", "workers", "cores"), "threads"),
    **dict.fromkeys(("output", "folder", "dir"), "out"),
    **dict.fromkeys(("model", "friction"), "law"),
    **dict.fromkeys(("exclude", "skip"), "without"),
    **dict.fromkeys(("unit", "units", "column"), "columns"),
}
"""What others call a verb or an option."""
KINDS = {int: "a whole number", float: "a number", bool: "true or false"}


def refusal(error: cyclopts.CycloptsError, app: cyclopts.App) -> str:
    """The parser's complaint: what was given, what is allowed, where to read on."""
    chain = list(error.command_chain or ())
    command = " ".join(["stiction", *chain])
    verb = f"{' '.join(chain)}: " if chain else ""
    return f"{verb}{_what(error, app, command)} (see: {command} --help)"


def _what(error: cyclopts.CycloptsError, app: cyclopts.App, command: str) -> str:
    if isinstance(error, exceptions.UnknownCommandError):
        for word in error.command_chain or ():
            app = app[word]
        return _no_verb(str((error.unused_tokens or [""])[0]), app)
    if isinstance(error, exceptions.UnknownOptionError):
        given = (error.token.keyword or error.token.value).partition("=")[0]
        known = [name for each in error.argument_collection if each.parse for name in each.names]
        return _no_option(given, [name for name in known if name.startswith("--")])
    if isinstance(error, exceptions.UnusedCliTokensError):
        return f"{commas(error.unused_tokens or ())} is more than it takes; leave it out"
    argument = error.argument
    name = argument.name if argument is not None else ""
    if isinstance(error, exceptions.MissingArgumentError) and argument is not None:
        if error.keyword:
            return f"{error.keyword} is there without a value; write one behind it"
        word = name.lstrip("-").upper()
        words = _positional(app, error.command_chain or ())
        if argument.index is None:
            words += [name, word]
            word = name
        return f"{word} is missing; write {' '.join([command, *words])}"
    if isinstance(error, exceptions.CoercionError) and error.token is not None:
        if get_origin(error.target_type) is Literal:
            given, allowed = error.token.value, get_args(error.target_type)
            near = did_you_mean(given, allowed)
            return f"{name} = {given} is unknown{near}; allowed are {commas(allowed)}"
        kind = KINDS.get(error.target_type or object)
        kind = "a whole number" if kind is None and error.msg is not None else kind
        if kind is not None:
            return f"{error.token.keyword or name} = {error.token.value} is not {kind}"
    if isinstance(error, exceptions.RepeatArgumentError):
        return f"{error.token.keyword} is there twice; drop one"
    return " ".join(str(error).split()).rstrip(".")


def _positional(app: cyclopts.App, chain: Iterable[str]) -> list[str]:
    """What must stand in a row behind a verb."""
    for word in chain:
        app = app[word]
    known = [each for each in app.assemble_argument_collection() if each.index is not None]
    known.sort(key=lambda each: each.index or 0)
    return [each.name.lstrip("-").upper() for each in known if each.required]


def _no_verb(given: str, app: cyclopts.App) -> str:
    verbs = [verb for verb in app if not verb.startswith("-")]
    if given.startswith("-"):
        return _no_option(given, OPTIONS)
    if os.path.exists(given):
        verb = "watch" if os.path.isdir(given) else "diagnose"
        return f"'{given}' is a file and no verb; write for instance stiction {verb} {given}"
    near = did_you_mean(OTHERS.get(given.casefold(), given), [*verbs, *OPTIONS])
    return f"there is no verb '{given}'{near}; there are {commas(verbs)}"


def _no_option(given: str, known: Iterable[str]) -> str:
    names = list(known)
    # Without the dashes, in which all of them are alike.
    wanted = given.lstrip("-")
    meant = nearest(OTHERS.get(wanted, wanted), [name.lstrip("-") for name in names])
    near = f" (did you mean '--{meant}'?)" if meant is not None else ""
    return f"there is no option {given}{near}; there are {commas(names)}"
