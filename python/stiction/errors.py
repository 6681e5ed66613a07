"""What the package raises when the request itself cannot be read."""

from __future__ import annotations

from ._support.wording import sentence

__all__ = ["CallError", "InputError", "NotEnoughData", "UnknownName"]


class InputError(ValueError):
    """Something that was given (a file, a column, a value) cannot be used as it stands.

    The message is one plain sentence: where the fault is, what was given, what is allowed and
    what to do about it.  The command line prints that sentence alone and exits with status 2.
    Names and values in it are those of the file, whoever wrote it: what would act on a terminal is
    escaped.
    """

    def __init__(self, *args: object) -> None:
        super().__init__(*(sentence(arg) if isinstance(arg, str) else arg for arg in args))


class NotEnoughData(InputError):  # noqa: N818 (it is raised and named as what is the matter)
    """Data that can be read and do not suffice for what was asked.

    A diagnosis answers it with the verdict ``not_testable``.
    """


class UnknownName(InputError, KeyError):  # noqa: N818 (it is raised and named as what is the matter)
    """A name that is looked up and is not there; a mapping's ``in`` and ``get`` take it as that."""

    # A KeyError shows its argument quoted, and this is a sentence.
    __str__ = Exception.__str__


class CallError(InputError, TypeError):
    """A call with a keyword that is not there, without one that is needed, or in another order."""
