"""What was found once: small programs that must find nothing any more."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).with_name("corpus")


@dataclass(frozen=True)
class Entry:
    """A case that was a fault.

    Attributes
    ----------
    name : str
        Of its file.
    found : str
        What was found, in words.
    case : str
        Target and seed that drew it first, for the record.
    program : list of str
    """

    name: str
    found: str
    case: str
    program: list[str]


def entries(folder: Path = FOLDER) -> list[Entry]:
    """All that is kept."""
    return [
        Entry(path.stem, **json.loads(path.read_text(encoding="utf-8")))
        for path in sorted(folder.glob("*.json"))
    ]


def keep(found: str, case: str, program: list[str], folder: Path = FOLDER) -> Path:
    """Add a case, under a name that says what it is."""
    folder.mkdir(parents=True, exist_ok=True)
    stem = re.sub(r"[^a-z0-9]+", "-", f"{found}".lower()).strip("-")[:70]
    path = folder / f"{stem}.json"
    kept = {"found": found, "case": case, "program": program}
    path.write_text(json.dumps(kept, indent=1, ensure_ascii=True) + "\n", encoding="utf-8")
    return path
