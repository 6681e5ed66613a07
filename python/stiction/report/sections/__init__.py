"""The sections of a report, in their order: each a builder here and a template of its name."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from . import advice, candidates, data, findings, laws, loop, method, models, rest, verdict
from .section import Section

if TYPE_CHECKING:
    from ...diagnosis.result import Diagnosis
    from ..drawings import Drawings

__all__ = ["BUILDERS", "Section"]

BUILDERS: Final[tuple[Callable[[Diagnosis, Drawings], Section | None], ...]] = (
    verdict.build,
    findings.build,
    rest.build,
    candidates.build,
    models.build,
    loop.build,
    laws.build,
    advice.build,
    data.build,
    method.build,
)
