"""What all tests share: the folder of real recordings, and an eye on what is left out quietly."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

_REPOSITORY = Path(__file__).parents[1]


@pytest.fixture
def shared_data() -> Path:
    """The folder of real recordings; the test is skipped where it is absent."""
    named = os.environ.get("STICTION_DATA") or "../shared/data"
    folder = Path(named) if Path(named).is_absolute() else _REPOSITORY / named
    if not folder.is_dir():
        pytest.skip(f"no real recordings: STICTION_DATA names no folder ({folder})")
    return folder


class _Kept(logging.Handler):
    """Keeps what is logged."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self.sentences: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.sentences.append(record.getMessage())


@pytest.fixture(scope="session", autouse=True)
def _left_out() -> Iterator[_Kept]:
    """What a figure, a section or a comparison said that could not be made."""
    kept = _Kept()
    logger = logging.getLogger("stiction.best_effort")
    logger.addHandler(kept)
    yield kept
    logger.removeHandler(kept)


@pytest.fixture(autouse=True)
def _nothing_is_left_out(_left_out: _Kept) -> Iterator[None]:
    """A user gets the rest where a figure fails; a test fails."""
    yield
    said = list(_left_out.sentences)
    _left_out.sentences.clear()
    assert not said, f"left out: {said}"


@pytest.fixture(scope="session", autouse=True)
def _no_progress() -> Iterator[None]:
    """On a busy machine a quick command is a slow one: what it says meanwhile would be a fault."""
    from stiction.cli import progress

    usual, progress.SELDOM = progress.SELDOM, 3600.0  # type: ignore[misc]
    yield
    progress.SELDOM = usual  # type: ignore[misc]


@pytest.fixture
def left_out(_left_out: _Kept, _nothing_is_left_out: None) -> Iterator[list[str]]:
    """For tests in which something is to fail: the sentences, which then count for nothing."""
    _left_out.sentences.clear()
    yield _left_out.sentences
    _left_out.sentences.clear()
