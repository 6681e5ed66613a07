"""Names as figures can show them: short, of characters that can be drawn, each still another."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import takewhile

__all__ = ["distinct_labels", "shorten"]


def shorten(name: str, longest: int) -> str:
    """A name that is not too long, without characters that show nothing or turn text round."""
    shown = "".join(c if c.isprintable() else "?" for c in name)
    if len(shown) > longest:
        half = (longest - 1) // 2
        shown = f"{shown[: longest - 1 - half]}…{shown[-half:]}"
    return shown


def distinct_labels(names: Sequence[str], longest: int) -> list[str]:
    """Names as they can be drawn, each still another one.

    Where one is too long, what all begin or end with is left out of all; whatever still looks alike
    is counted.
    """
    if len(names) < 2 or all(len(name) <= longest for name in names):
        return [shorten(name, longest) for name in names]
    start = _shared(names)
    end = _shared([name[start:][::-1] for name in names])
    shown = []
    for name in names:
        own = name[start : len(name) - end]
        shown.append(shorten(f"{'…' if start else ''}{own}{'…' if end else ''}", longest))
    alike = Counter(shown)
    return [
        name if alike[name] < 2 else f"{k + 1}: {shorten(full, longest - 4)}"
        for k, (name, full) in enumerate(zip(shown, names, strict=True))
    ]


def _shared(names: Sequence[str]) -> int:
    """With how many characters all begin, whole words alone."""
    same = takewhile(lambda each: len(set(each)) == 1, zip(*names, strict=False))
    start = sum(1 for _ in same)
    while start and names[0][start - 1].isalnum():
        start -= 1
    return start
