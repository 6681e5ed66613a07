"""Command line: one file a verb; here they meet, and here errors become sentences."""

from __future__ import annotations

import logging
import os
import signal
import sys
from collections.abc import Sequence

__all__ = ["main"]

ANSWERED, FAULT, UNREADABLE, INTERRUPTED = 0, 1, 2, 130


def main(arguments: Sequence[str] | None = None) -> None:
    """Run ``stiction`` with these arguments (those of the process without any) and exit."""
    # A stream that was closed is None, and would be opened as the next best file.
    if sys.stdout is None:
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115
    # Better a question mark than no answer where a terminal lacks a letter.
    if reconfigure := getattr(sys.stdout, "reconfigure", None):
        reconfigure(errors="replace")
    status = run(sys.argv[1:] if arguments is None else arguments)
    # The answer is out: nothing is left that Ctrl-C could stop.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # Python ends by the signal itself where one struck code that was made from text, as in
    # dataclasses, whatever status is asked for; running some more text makes it forget that.
    exec("")
    sys.exit(status)


def run(arguments: Sequence[str]) -> int:
    """Run ``stiction`` with these arguments; returns the exit status.

    0: an answer. 2: the request cannot be read, with one sentence on stderr. 130: interrupted.
    1: a fault of the program itself.
    """
    try:
        return _run(arguments)
    except KeyboardInterrupt:
        _say("interrupted")
        return INTERRUPTED


def _run(arguments: Sequence[str]) -> int:
    # Imported here: Ctrl-C is heard from the first moment on.
    import cyclopts

    from ..errors import InputError
    from .answer import discard_stdout
    from .app import build
    from .refusal import refusal

    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="%(message)s")
    app = build(next((word for word in arguments if not word.startswith("-")), ""))
    for given in arguments:
        if not given or (given.startswith("-") and given.endswith("=")):
            return _refuse(f"{given or 'an argument'} is empty; write a value, or leave it out")
    try:
        command, bound, _ = app.parse_args(
            list(arguments), exit_on_error=False, print_error=False, help_on_error=False
        )
        command(*bound.args, **bound.kwargs)
        sys.stdout.flush()
    except cyclopts.CycloptsError as error:
        return _refuse(refusal(error, app))
    except InputError as error:
        return _refuse(str(error))
    except BrokenPipeError:
        # The reader has what it wanted; a second error while closing would say nothing new.
        discard_stdout()
        return ANSWERED
    except SystemExit as error:
        # What prints the help makes an end of its own of a reader that has gone.
        if not isinstance(error.__context__, BrokenPipeError):
            raise
        discard_stdout()
        return ANSWERED
    except OSError as error:
        # What has no name is no file, but standard output.
        if error.filename is not None:
            raise
        discard_stdout()
        return _refuse(f"standard output cannot be written ({error.strerror or error})")
    return ANSWERED


def _refuse(sentence: str) -> int:
    _say(f"stiction: {sentence}")
    return UNREADABLE


def _say(sentence: str) -> None:
    """A line on stderr, where somebody reads it."""
    try:
        print(sentence, file=sys.stderr, flush=True)
    except OSError:
        # The status says it too; what is still held would fail once more at the end.
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115
