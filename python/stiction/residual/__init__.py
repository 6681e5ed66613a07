"""What a plant leaves unexplained of a recording.

Three forms of one protocol: along the measured motion (``weak_form``), simulated over short windows
(``shooting``), and of a servo simulated in its loop (``loop_form``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from .._support.lazy import lazy

if TYPE_CHECKING:
    from .effort import EffortResidual, FreeRun, effort_residual, free_run

__all__ = ["EffortResidual", "FreeRun", "effort_residual", "free_run"]

__getattr__, __dir__ = lazy(__name__, dict.fromkeys(__all__, "effort"))
