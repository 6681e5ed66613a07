"""Sessions whose truth is hidden, and scores of anybody's answers to them.

``make`` lays sessions out, ``run`` has them diagnosed by the package itself, ``score`` counts.
"""

from .deal import CASES
from .entry import run
from .format import SCHEMA, VERDICTS
from .layout import make
from .scores import Scores, score

__all__ = ["CASES", "SCHEMA", "VERDICTS", "Scores", "make", "run", "score"]
