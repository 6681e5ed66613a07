"""Decision notes describe the tree as it is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
NOTES = [
    note
    for note in sorted((REPOSITORY / "docs" / "decisions").glob("*.md"))
    if note.name != "README.md"
]
SOURCES = [
    source
    for folder, ending in (("python", "py"), ("crates", "rs"))
    for source in (REPOSITORY / folder).rglob(f"*.{ending}")
]
MOST_WORDS = 700
EARLIER = 69
"""Numbered notes that there were before these."""


@pytest.mark.parametrize("note", NOTES, ids=lambda note: note.stem)
def test_a_note_says_its_status_and_what_failed_in_few_words(note: Path) -> None:
    text = note.read_text("utf-8")
    assert re.search(r"^Status: (accepted|replaced by \[)", text, re.M)
    assert re.findall(r"^\*\*(.*?)\.\*\*", text, re.M) == [
        "Context",
        "Decision",
        "Rests on",
        "Tried",
        "Consequences",
    ]
    assert len(text.split()) <= MOST_WORDS


@pytest.mark.parametrize("note", NOTES, ids=lambda note: note.stem)
def test_constants_have_the_values_that_notes_say(note: Path) -> None:
    text = " ".join(note.read_text("utf-8").split())
    named = re.findall(r"`([A-Z_]+) = ([^`]+)` \(`([^`]+)`\)", text)
    assert len(named) == len(re.findall(r"`[A-Z_]+ = ", text))
    for name, value, file in named:
        stating = rf"^(?:pub )?(?:const )?{name}(?:: [\w\[\]]+)? = (.+?);?$"
        stated = [
            found[1]
            for source in SOURCES
            if f"/{source.as_posix()}".endswith(f"/{file}")
            and (found := re.search(stating, source.read_text("utf-8"), re.M))
        ]
        assert stated == [value], f"{file}: {name}"


def test_every_earlier_number_leads_to_a_note() -> None:
    table = (REPOSITORY / "docs" / "decisions" / "README.md").read_text("utf-8")
    numbers = re.findall(r"^\| ([\d, ]+) \|", table, re.M)
    led = sorted(int(number) for row in numbers for number in row.split(","))
    assert led == list(range(1, EARLIER + 1))
