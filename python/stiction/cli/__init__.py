"""Command line: one file a verb; here they meet, and here errors become sentences."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Sequence

__all__ = ["main"]

ANSWERED, FAULT, UNREADABLE, INTERRUPTED = 0, 1, 2, 130


def main(arguments: Sequence[str] | None = None) -> None:
    """Run ``stiction`` with these arguments (those of the process without any) and exit."""
    sys.exit(run(sys.argv[1:] if arguments is None else arguments))


def run(arguments: Sequence[str]) -> int:
    """Run ``stiction`` with these arguments; returns the exit status.

    0: an answer. 2: the request cannot be read, with one sentence on stderr. 130: interrupted.
    1: a fault of the program itself.
    """
    import cyclopts

    from ..errors import InputError
    from .app import build

    logging.basicConfig(stream=sys.stderr, level=logging.WARNING, format="%(message)s")
    app = build()
    try:
        command, bound, _ = app.parse_args(
            list(arguments), exit_on_error=False, print_error=False, help_on_error=False
        )
        command(*bound.args, **bound.kwargs)
    except cyclopts.CycloptsError as error:
        return _refuse(_sentence(error))
    except InputError as error:
        return _refuse(str(error))
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader has what it wanted; a second error while closing would say nothing new.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return ANSWERED
    return ANSWERED


def _refuse(sentence: str) -> int:
    print(f"stiction: {sentence}", file=sys.stderr)
    return UNREADABLE


def _sentence(error: Exception) -> str:
    """The parser's message in one line."""
    return " ".join(str(error).split()) + " (see: stiction --help)"
