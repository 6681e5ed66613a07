"""Makes a program that found something shorter, as long as it finds the same."""

from __future__ import annotations

import ast
import copy
import time
from collections.abc import Callable, Iterator

from .judge import Find

Program = list[str]
SIMPLE = (0.0, 1.0, 0.1)
"""Numbers that any other one may be replaced by."""


def shrunk(
    program: Program, find: Find, judged: Callable[[Program], list[Find]], end: float
) -> Program:
    """The shortest program that was reached and still gives a find of this signature.

    Parameters
    ----------
    judged : callable
        The finds of a program.
    end : float
        Of the monotonic clock, when all tries must have come to an end.
    """
    best, tried = program, {tuple(program)}
    going = True
    while going:
        going = False
        for shorter in simpler(best):
            if time.monotonic() > end:
                return best
            if tuple(shorter) in tried:
                continue
            tried.add(tuple(shorter))
            if any(each.signature == find.signature for each in judged(shorter)):
                best, going = shorter, True
                break
    return best


def simpler(program: Program) -> Iterator[Program]:
    """Programs with one thing less."""
    # The line that found something is the last one that counts.
    for k in range(len(program) - 1, -1, -1):
        if len(program) > 1:
            yield [*program[:k], *program[k + 1 :]]
    for k, line in enumerate(program):
        for other in simpler_lines(line):
            yield [*program[:k], other, *program[k + 1 :]]


def simpler_lines(line: str) -> Iterator[str]:
    """A line with one keyword, entry or element less, or one number plainer."""
    tree = ast.parse(line)
    for number, node in enumerate(ast.walk(tree)):
        for change in changes(node):
            other = copy.deepcopy(tree)
            change(next(n for k, n in enumerate(ast.walk(other)) if k == number))
            yield ast.unparse(other)


def changes(node: ast.AST) -> Iterator[Callable[[ast.AST], None]]:
    """What can be taken away from a node of a line."""
    if isinstance(node, ast.Call):
        for k in range(len(node.keywords)):
            yield lambda n, k=k: n.keywords.pop(k)
        if isinstance(node.func, ast.Name) and node.func.id == "file":
            for k in range(2, len(node.args)):
                yield lambda n, k=k: n.args.pop(k)
    elif isinstance(node, ast.Dict):
        for k in range(len(node.keys)):
            yield lambda n, k=k: (n.keys.pop(k), n.values.pop(k))
    elif isinstance(node, ast.List):
        for k in range(len(node.elts)):
            yield lambda n, k=k: n.elts.pop(k)
    elif isinstance(node, ast.Constant):
        for value in plainer(node.value):
            yield lambda n, value=value: setattr(n, "value", value)


def plainer(value: object) -> Iterator[object]:
    """Numbers that say less than this one."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return
    if isinstance(value, int):
        yield from (each for each in (0, 1, value // 2) if each < value)
        return
    yield from (each for each in SIMPLE if len(repr(each)) < len(repr(value)))
    rounded = float(f"{value:.1e}")
    if len(repr(rounded)) < len(repr(value)):
        yield rounded
