"""The sections of a report, in their order: each a builder here and a template of its name."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final, TypeAlias

from . import (
    advice,
    candidates,
    curves,
    data,
    evidence,
    findings,
    laws,
    loop,
    method,
    models,
    motion,
    rest,
    verdict,
)
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.findings.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["BUILDERS", "Builder", "Section", "name_of"]

Builder: TypeAlias = "Callable[[Diagnosis, Drawings], Section | None]"

BUILDERS: Final[tuple[Builder, ...]] = (
    verdict.build,
    motion.build,
    curves.build,
    findings.build,
    evidence.build,
    rest.build,
    candidates.build,
    models.build,
    loop.build,
    laws.build,
    advice.build,
    data.build,
    method.build,
)


def name_of(builder: Builder) -> str:
    """Name of the section that a builder makes: that of its file."""
    return builder.__module__.rpartition(".")[2]
