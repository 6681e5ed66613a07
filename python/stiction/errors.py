"""What the package raises when the request itself cannot be read."""

from __future__ import annotations

__all__ = ["InputError", "NotEnoughData", "UnknownName"]


class InputError(ValueError):
    """Something that was given (a file, a column, a value) cannot be used as it stands.

    The message is one plain sentence: where the fault is, what was given, what is allowed and
    what to do about it.  The command line prints that sentence alone and exits with status 2.
    """

    def __init__(self, *arguments: object) -> None:
        # What was given is shown in it, and need not be what a terminal or a log can write.
        super().__init__(*(_written(each) if isinstance(each, str) else each for each in arguments))


def _written(sentence: str) -> str:
    """A sentence in which a lone half of a surrogate pair stands as its number."""
    return sentence.encode("utf-8", "backslashreplace").decode("utf-8")


class NotEnoughData(InputError):  # noqa: N818 (it is raised and named as what is the matter)
    """Data that can be read and do not suffice for what was asked.

    A diagnosis answers it with the verdict ``not_testable``.
    """


class UnknownName(InputError, KeyError):  # noqa: N818 (it is raised and named as what is the matter)
    """A name that is looked up and is not there; a mapping's ``in`` and ``get`` take it as that."""

    # A KeyError shows its argument quoted, and this is a sentence.
    __str__ = Exception.__str__
