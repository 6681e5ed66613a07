"""What a data check hands over."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Literal

Verdict = Literal["fine", "note", "fault"]


@dataclass(frozen=True)
class Check:
    """One thing looked at in a recording.

    Attributes
    ----------
    name : str
        What was looked at: ``"spikes"``.
    verdict : {"fine", "note", "fault"}
        ``"fault"`` is data that can be read and not be used.
    what : str
        What was found.
    means : str
        What it means for a diagnosis, "" where fine.
    try_ : str
        What to try, "" where there is nothing to do.
    """

    name: str
    verdict: Verdict
    what: str
    means: str = ""
    try_: str = ""

    def to_dict(self) -> dict[str, str]:
        """As an entry of ``data.checks`` in findings.json."""
        return {key.rstrip("_"): value for key, value in asdict(self).items()}

    def __str__(self) -> str:
        said = [f"{self.name} ({self.verdict}): {self.what}."]
        said += [f"It means: {self.means}."] if self.means else []
        said += [f"Try: {self.try_}."] if self.try_ else []
        return " ".join(said)
