"""Runs a program and says which of the rules that always hold did not."""

from __future__ import annotations

import ast
import contextlib
import hashlib
import inspect
import math
import os
import re
import shutil
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

import stiction as st

from . import world
from .files import DAMAGES
from .surface import Target, names_read, targets
from .world import Broken, same

LONGEST = 10_000
"""Letters of a sentence, what was given included; what is longer is no sentence."""
TWICE_BELOW_S = 1.0
"""What took longer is not run a second time."""
NOT_REPEATED = ("seconds", "cost", "cost_ns", "path", "source", "version", "created")
"""Fields that say where and how long, which differ from run to run."""
RAW = ("Motor.run", "Motor.run_segments", "Ensemble.run", "recording.Table.find",
       "recording.read_table", "Nothing.step")  # fmt: skip
"""What hands numbers to a caller that looks whether they are finite, or reads what is missing."""
AS_THEY_ARE = "strict=False"
"""How a caller asks for numbers that may be none, as a fit does whose trials run away."""
UNENDED = re.compile(r"([\s,;:(\[{]|\b(?:and|or|to|of|in|is|the))$")
INSIDE = re.compile(
    r"has no attribute|index out of (?:range|bounds)|unsupported operand|Traceback|"
    r"not subscriptable|not iterable|recursion depth"
)
"""Words of Python's own about what a program did, which a reader of a sentence never did."""
ADDRESS = re.compile(r"at 0x[0-9a-f]{6,}")
MAKERS = ("real", "wave", "spoiled", "masked", "positive", "scaled", "file", *DAMAGES)
"""What makes arguments, and may be asked for what cannot be made."""
HOUSE = (st.InputError,)


@dataclass(frozen=True)
class Find:
    """A rule that did not hold.

    Attributes
    ----------
    kind : str
        Such as "panic", "foreign error", "not finite".
    where : str
        The innermost place in the package, or what was called.
    what : str
        In words.
    line : str
        Of the program.
    """

    kind: str
    where: str
    what: str
    line: str = ""

    @property
    def signature(self) -> str:
        """Finds of one signature are one fault."""
        return f"{self.kind} in {self.where}"


def judge(program: list[str], beginning: Any = None) -> list[Find]:
    """Run a program, twice where it is quick; all rules that did not hold.

    Parameters
    ----------
    program : list of str
        Lines; a line that is refused ends nothing, but what needs its name is left out.
    beginning : callable, optional
        Called with the number of a line before it runs.
    """
    began = time.process_time()
    finds, digests = run(program, beginning)
    if not finds and time.process_time() - began < TWICE_BELOW_S:
        _, again = run(program, beginning)
        for line, one, other in zip(program, digests, again, strict=True):
            if one != other:
                return [Find("not repeated", callee(line), "two runs give other bits", line)]
    return finds


def run(program: list[str], beginning: Any = None) -> tuple[list[Find], list[str]]:
    """One run: what was found, and a digest of what each line gave."""
    folder = scratch()
    finds: list[Find] = []
    digests: list[str] = []
    try:
        names = world.namespace(folder)
        # Names without a folder are drawn too: what they write must not stay for the next case.
        with contextlib.chdir(folder):
            for number, line in enumerate(program):
                if beginning is not None:
                    beginning(number)
                found, digest = _step(line, names)
                finds += found
                digests.append(digest.replace(str(folder), "FOLDER"))
                if found:
                    break
    finally:
        if any(folder.iterdir()):
            shutil.rmtree(folder, ignore_errors=True)
    return finds, digests


def scratch() -> Path:
    """An empty folder of this process."""
    folder = Path(tempfile.gettempdir()) / f"fuzz-{os.getpid()}"
    folder.mkdir(exist_ok=True)
    return folder


def _step(line: str, names: dict[str, Any]) -> tuple[list[Find], str]:
    """Run one line."""
    tree = ast.parse(line)
    if "x" in names_read(line) and "x" not in names:
        return [], "left out"
    called = callee(line, type(names.get("x")).__name__)
    kept = _states(names)
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        try:
            value = _value(tree, line, names)
        except BaseException as error:
            if isinstance(error, SystemExit | KeyboardInterrupt):
                raise
            found = _of_error(error, line, called)
            # What calls several things may have come to its second.
            alone = called in targets()
            if not found and alone and not _same_states(kept, names):
                found = [Find("changed by a refusal", called, "the state is another", line)]
            return found, f"{type(error).__name__}: {error}"
    if heard:
        said = f"{heard[0].category.__name__}: {heard[0].message}"
        return [Find("warning", called, said, line)], ""
    reason = "" if AS_THEY_ARE in line else unsound(value, called)
    if reason:
        return [Find("not finite", called, reason, line)], ""
    return [], digest_of(value)


def _value(tree: ast.Module, line: str, names: dict[str, Any]) -> Any:
    """What a line gives; what comes in pieces is taken to its end."""
    code = tree.body[0]
    target = None
    if isinstance(code, ast.Assign) and isinstance(code.targets[0], ast.Name):
        target, line = code.targets[0].id, ast.unparse(code.value)
    elif isinstance(code, ast.Assign):
        exec(compile(tree, "<case>", "exec"), names)
        return None
    try:
        value = eval(compile(line, "<case>", "eval"), names)
        if inspect.isgenerator(value):
            value = list(islice(value, 100))
    except BaseException:
        names.pop(target, None)  # what was to be replaced is not what later lines mean
        raise
    if target:
        names[target] = value
    return value


def _states(names: Mapping[str, Any]) -> dict[str, Any]:
    return {
        name: value.state
        for name, value in names.items()
        if isinstance(value, st.Motor | st.FrictionModel)
    }


def _same_states(kept: dict[str, Any], names: Mapping[str, Any]) -> bool:
    now = _states(names)
    return all(same(state, now[name]) for name, state in kept.items() if name in now)


# What is raised


def _of_error(error: BaseException, line: str, called: str) -> list[Find]:
    """What is wrong with a refusal: nothing where it is a sentence of the house."""
    place = _place(error)
    said = str(error)
    if isinstance(error, Broken):
        rule = re.sub(r"[^a-zA-Z ].*", "", said).strip()
        return [Find("broken", f"{called}: {rule}", said, line)]
    if type(error).__name__ == "PanicException":
        return [Find("panic", place or called, said, line)]
    if _of_an_argument(error):
        return []
    if isinstance(error, HOUSE):
        fault = fault_of_sentence(said)
        return [Find("no sentence", place or called, f"{fault}: {said!r}", line)] if fault else []
    if _by_the_call_itself(error, line):
        return []
    name = type(error).__name__
    return [Find("foreign error", f"{place or called} ({name})", f"{name}: {said}", line)]


def fault_of_sentence(said: str) -> str:
    """What keeps a text from being one sentence, "" where it is one."""
    if not said.strip():
        return "nothing is said"
    if "\n" in said or "\r" in said:
        return "it goes over several lines"
    if len(said) > LONGEST:
        return f"it has {len(said)} letters"
    if UNENDED.search(said):
        return "it ends in the middle"
    if INSIDE.search(said):
        return "it speaks of the program's insides"
    if ADDRESS.search(said):
        return "it names an address"
    try:
        said.encode("utf-8")
    except UnicodeEncodeError:
        return "it cannot be printed"
    return ""


def _of_an_argument(error: BaseException) -> bool:
    """Whether what was to be an argument could not be made: nothing was called."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return last.name in MAKERS and last.filename.endswith(("fuzz/world.py", "fuzz/files.py"))


def _by_the_call_itself(error: BaseException, line: str) -> bool:
    """Whether Python or the compiled module refuses what no parameter takes."""
    inner = [f for f in traceback.extract_tb(error.__traceback__) if "tests/fuzz" not in f.filename]
    within = [f for f in inner if f.filename != "<case>"]
    if isinstance(error, TypeError | OverflowError) and not within:
        return True
    if isinstance(error, TypeError | OverflowError) and any(
        note.startswith("while processing '") for note in getattr(error, "__notes__", ())
    ):
        return True
    # What the arguments themselves raise, before anything is called.
    if not within and isinstance(error, KeyError | IndexError | ZeroDivisionError | ValueError):
        return "[" in line and type(error).__module__ == "builtins" and not _called(line)
    target = target_of(line)
    promised = inspect.getdoc(target.value) or "" if target else ""
    return bool(re.search(rf"^\s*{type(error).__name__}$", promised, re.M))


def _called(line: str) -> bool:
    return target_of(line) is not None


def _place(error: BaseException) -> str:
    """The innermost place in the package."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [f for f in frames if "/stiction/" in f.filename and "/tests/" not in f.filename]
    if not own:
        return ""
    file = own[-1].filename.rpartition("/stiction/")[2]
    return f"{file} {own[-1].name}"


def callee(line: str, owner: str = "") -> str:
    """What a line calls, for a signature."""
    target = target_of(line, owner)
    if target is not None:
        return target.name
    found = re.search(r"([\w.]+)\(", line)
    return found[1] if found else line.partition(" = ")[0]


def target_of(line: str, owner: str = "") -> Target | None:
    """The target that a line calls, of a receiver of this class where it is known."""
    text = line.partition(" = ")[2] if re.match(r"\w+ = ", line) else line
    found = re.match(r"(?:list\()?([\w.]+)", text)
    if found is None:
        return None
    path = found[1].replace("st.", "stiction.", 1) if found[1].startswith("st.") else found[1]
    hits = [t for t in targets().values() if t.call == path]
    if not hits:
        return None
    sets = f"{path} = " in line
    hits.sort(key=lambda t: (t.kind == "setter") != sets)
    return next((t for t in hits if t.owner and t.owner.__name__ == owner), hits[0])


# What is returned


def unsound(value: Any, called: str) -> str:
    """Where a result holds what is no number without saying so, "" where it does not."""
    target = targets().get(called)
    if target is None or target.name in RAW or target.kind == "setter":
        return ""
    if target.kind == "class":
        return ""
    for where, bad in _bad_numbers(value):
        return f"{where} holds {bad} without a reason"
    return ""


def _bad_numbers(value: Any, where: str = "the result") -> Iterator[tuple[str, Any]]:
    if isinstance(value, float | np.floating):
        if not math.isfinite(value):
            yield where, value
    elif isinstance(value, np.ndarray):
        if value.dtype.kind == "f" and not np.isfinite(value).all():
            yield where, value[~np.isfinite(value)].flat[0]
    elif isinstance(value, tuple | list):
        for k, each in enumerate(value):
            yield from _bad_numbers(each, f"{where}[{k}]")
    elif isinstance(value, st.Trajectory | st.EnsembleRun):
        if not value.success:
            fault = fault_of_sentence(value.message)
            if fault:
                yield f"{where} ({fault})", value.message
            return
        for name, column in value.columns.items():
            # A level may be infinite by definition: break-away of a contact that never slips.
            bad = np.isnan(column) if name not in MOTION else ~np.isfinite(column)
            if bad.any():
                yield f"{where}.{name}", column[bad].flat[0]
        yield from _bad_numbers(value.time, f"{where}.time")


MOTION = ("position", "velocity", "friction", "measured")


def digest_of(value: Any, depth: int = 0) -> str:
    """A result in few letters: the same where all its bits are."""
    digest = hashlib.sha256()
    _feed(digest, value, depth)
    return digest.hexdigest()[:24]


def _feed(digest: Any, value: Any, depth: int) -> None:
    digest.update(type(value).__name__.encode())
    if depth > 6:
        return
    if isinstance(value, np.ndarray):
        # What lies under a mask is no part of it, and the masked number has no bytes at all.
        plain = value.dtype != object and not isinstance(value, np.ma.MaskedArray)
        digest.update(value.tobytes() if plain else repr(value).encode())
    elif isinstance(value, str):
        digest.update(ADDRESS.sub("", value).encode("utf-8", "replace"))
    elif isinstance(value, int | float | complex | bytes | type(None)):
        digest.update(repr(value).encode())
    elif isinstance(value, st.Motor | st.FrictionModel):
        _feed(digest, value.state, depth + 1)
    elif isinstance(value, st.Trajectory | st.EnsembleRun):
        _feed(digest, dict(value.columns), depth + 1)
    elif isinstance(value, Mapping):
        for key in value:
            if key not in NOT_REPEATED:
                _feed(digest, key, depth + 1)
                _feed(digest, value[key], depth + 1)
    elif isinstance(value, tuple | list):
        for each in value:
            _feed(digest, each, depth + 1)
    elif is_dataclass(value) and not isinstance(value, type):
        for each in fields(value):
            if each.name not in NOT_REPEATED and hasattr(value, each.name):
                _feed(digest, getattr(value, each.name), depth + 1)


def close_figures() -> None:
    """Figures that were drawn and not shown would stay for ever."""
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")
