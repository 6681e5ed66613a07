"""No change makes a diagnosis dearer unseen: what it costs is counted, and compared with before."""

import json

from .work import KNOWN, counts

MOST = 1.1
"""Times as much as was known: what the last bits of another processor change is far less."""


def test_a_diagnosis_costs_no_more_than_it_did() -> None:
    known, found = json.loads(KNOWN.read_text(encoding="utf-8")), counts()
    dearer = {
        name: (known.get(name, 0), number)
        for name, number in found.items()
        if number > MOST * known.get(name, 0)
    }
    assert not dearer, (
        f"a diagnosis of the demo costs more than it did (before, now): {dearer}; where that is "
        "wanted, python -m tests.diagnosis.work writes the counts anew"
    )
