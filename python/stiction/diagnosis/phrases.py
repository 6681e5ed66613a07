"""Phrases that records hold, and that others ask for: places of what is left, doubts of names."""

from __future__ import annotations

__all__ = [
    "ALONE",
    "DOUBTFUL",
    "INTERRUPTED",
    "LEAVES_NOTHING",
    "MAY_BE_NOTHING",
    "MORE_MAY_BE",
    "NO_COORDINATE",
    "OF_ANOTHER_LAW",
    "ONE_CURVE",
    "OUTWEIGHED",
    "PARTLY",
    "THE_LAW",
    "UNCONFIRMED",
    "UNPLACED",
    "UNREPEATED",
]

NO_COORDINATE = "nothing that was looked at"
"""Where more is left than noise and it shows in no coordinate."""
ALONE = " alone"
"""What stands behind the name of a recording in the place of a coordinate."""
INTERRUPTED = "Interrupted: this is the best so far"
"""How the sentence of a diagnosis begins that Ctrl-C ended."""
MORE_MAY_BE = ", and more may be missing"
"""And goes on where something was named by then."""
DOUBTFUL = (
    "the interval of every number reaches 0 that says how strong it is, though it helps on rows "
    "held out"
)
"""Of a cause whose name is told, and whose numbers are not."""
OUTWEIGHED = "what is left without a name is worth more than half of what it took"
"""Why a name may be none."""
PARTLY = (
    "beyond a limit nothing gets through, and here a part surely does: a gain that falls, or what "
    "came for a few seconds alone, looks like that"
)
"""Why a limit may be something else."""
UNCONFIRMED = "the rows held out for the test do not bear it out: its gain there may be nothing"
"""Why a name that the rows that decide bear out may be none."""
UNPLACED = "these data do not tell where the limit lies"
"""Why a limit may be none."""
UNREPEATED = "less than one period was travelled, and a spring may look the same"
"""Why what should repeat with position may be something else."""
LEAVES_NOTHING = "what is left goes with {}, and of that it leaves nothing where it is the cause"
"""Why a name may be a relative of the cause that no catalogue has."""
MAY_BE_NOTHING = "every number that says how strong it is may be 0"
"""Why a name beside another one may be what the form of that leaves."""
THE_LAW = "the friction law"
"""What is left depends on, where another law leaves less of it."""
OF_ANOTHER_LAW = "another law of that kind may have it of itself"
"""Why a name beside a law that nobody stated may be none."""
ONE_CURVE = "friction over speed is one curve, and another form of it may explain both names"
"""Why a further name of a part of that curve may be none."""
