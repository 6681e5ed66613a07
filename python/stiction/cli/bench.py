"""``stiction bench``: sessions whose truth is hidden, and scores of anybody's answers to them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import cyclopts
from cyclopts import Parameter

from .._support.atomic_files import write_text
from .._support.wording import plural
from ..errors import InputError
from .answer import answer, folder, print_on_failure, protect_writes
from .app import VERBS
from .given import Quiet, Whole, separate
from .progress import progress

__all__ = ["bench"]

bench = cyclopts.App(
    name="bench",
    help="Lay out sessions whose truth is hidden, and score anybody's answers to them.",
    help_format="plaintext",
    help_epilogue=next(verb.epilogue for verb in VERBS if verb.name == "bench"),
    version_flags=(),
)


@bench.command
def make(
    where: Path,
    /,
    *,
    number: Whole = 24,
    seed: Whole = 0,
    seconds: str = "40,120",
    cases: str = "null,hidden",
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Lay out sessions of a simulated machine, and their truth in a folder of its own.

    Interrupted, the same command goes on where it was. Hand the folder out without truth/, which
    holds the seed too.

    Parameters
    ----------
    where
        Folder for the bench.
    number
        Sessions.
    seed
        Of everything: the same one gives the same files, and whoever can guess it has the truth.
    seconds
        Least and most that a session lasts, s.
    cases
        What sessions may be, with commas between: null (nothing is missing), hidden (one effect
        is), law (the plant states another law), untestable (the data tell nothing).
    json
        Print JSON.
    """
    from ..bench import make as lay_out

    kinds = separate(cases)
    with progress(quiet):
        given = _bounds(seconds)
        try:
            path = lay_out(where, number=number, seed=seed, seconds=given, cases=kinds)
        except OSError as error:
            raise _unwritten(where, error) from None
    text = (
        f"laid out {plural(number, 'session')} in {where}\n"
        f"the truth: {where / 'truth'}; hand the rest out without it\n"
        f"form of an answer: {where / 'answer.schema.json'}\n"
        f"next: stiction bench score {where} ANSWERS"
    )
    answer(text, {"bench": str(path), "number": number}, as_json=json)


@bench.command
def run(
    where: Path,
    /,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    threads: Whole | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Answer every session of a bench as stiction diagnose does; goes on where it was interrupted.

    Parameters
    ----------
    where
        Folder of the bench.
    out
        Folder for the answers, ./<bench>-answers/ without it.
    threads
        Recordings looked at side by side; results do not depend on it.
    json
        Print JSON.
    """
    from ..bench import run as diagnosed

    answers = folder(Path(f"{where.name}-answers") if out is None else out)
    with progress(quiet):
        try:
            said = diagnosed(where, answers, threads=threads)
        except OSError as error:
            raise _unwritten(answers, error) from None
    lines = [f"{name}: {each}" for name, each in said.items()]
    text = "\n".join([*lines, f"answers: {answers}"])
    answer(text, {"answers": str(answers), "sessions": said}, as_json=json)


@bench.command
def score(
    where: Path,
    answers: Path,
    /,
    *,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    json: Annotated[bool, Parameter(negative="")] = False,
    quiet: Quiet = False,
) -> None:
    """Compare answers with the truth: how often names are right, wrong and sure, or missing.

    Parameters
    ----------
    where
        Folder of the bench, with its truth.
    answers
        Folder with session_0001.json and so on: findings.json, or the form of answer.schema.json.
    out
        Folder for scores.json and scores.md.
    json
        Print JSON.
    """
    from ..bench import score as scored

    # Better said before the work than after it.
    if out is not None:
        folder(out)
    with progress(quiet):
        found = scored(where, answers)
    text = str(found)
    if out is not None:
        with print_on_failure(text, found.to_dict(), as_json=json), protect_writes(out):
            write_text(out / "scores.json", found.to_json() + "\n")
            write_text(out / "scores.md", found.to_markdown())
        text += f"\n\nwith every session: {out / 'scores.json'}"
    answer(text, found.to_dict(), as_json=json)


def _bounds(seconds: str) -> tuple[float, float]:
    try:
        least, most = (float(each) for each in seconds.split(","))
    except ValueError:
        raise InputError(
            f"--seconds = {seconds} is no pair; give the least and the most that a session lasts, "
            "such as 20,40"
        ) from None
    return least, most


def _unwritten(where: Path, error: OSError) -> InputError:
    path = where if error.filename is None else error.filename
    return InputError(f"{path}: cannot be written ({error.strerror}); give another folder")
