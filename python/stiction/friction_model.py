"""The compiled friction model, whose ``simulate`` tells what a keyword is called.

``step`` is left as it is: a sample is done sooner than a call is explained.
"""

from __future__ import annotations

from ._native import FrictionModel
from ._support.keywords import explain_keywords

__all__ = ["FrictionModel"]

# A compiled method refuses a keyword before any line of its own runs.
setattr(FrictionModel, "simulate", explain_keywords(FrictionModel.simulate))  # noqa: B010
