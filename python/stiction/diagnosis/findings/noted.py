"""What is found of recordings in the course of a diagnosis, among the data checks and in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ...fitting.pushes import push_checks
from ...recording import Check
from ..data.evidence import Evidence
from .result import Diagnosis
from .words import push_words

__all__ = ["with_checks", "with_pushes"]


def with_pushes(found: Diagnosis, evidence: Evidence) -> Diagnosis:
    """What was left out because something pushed the machine, in the sentence and the checks."""
    words = push_words(evidence.pushes, evidence.names)
    return with_checks(found, push_checks(evidence.pushes, evidence.names), words)


def with_checks(
    found: Diagnosis, checks: Sequence[tuple[str, Check]], words: str = ""
) -> Diagnosis:
    """What was found in each recording, by its name, beside what is told of them already."""
    if not checks:
        return found
    more = ({"recording": name, **check.to_dict()} for name, check in checks)
    data = {**found.data, "checks": [*found.data["checks"], *more]}
    return replace(found, sentence=f"{found.sentence} {words}".rstrip(), data=data)
