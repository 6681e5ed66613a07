"""What the fuzzer found once is not found any more."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from .corpus import Entry, entries
from .hunt import Task, Worker


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    """A process that may hang or end without taking the tests along."""
    worker = Worker()
    yield worker
    worker.close()


@pytest.mark.parametrize("entry", entries(), ids=lambda entry: entry.name)
def test_what_was_found_once_is_mended(entry: Entry, worker: Worker) -> None:
    found = worker.run(Task(entry.case.rpartition("/")[0], "kept", entry.program))
    assert not found, "\n".join([*entry.program, *(f"{f.signature}: {f.what}" for f in found)])


def test_the_corpus_is_not_empty() -> None:
    assert len(entries()) >= 5
