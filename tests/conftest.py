"""What all tests share: the folder of real recordings."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

_REPOSITORY = Path(__file__).parents[1]


@pytest.fixture
def shared_data() -> Path:
    """The folder of real recordings; the test is skipped where it is absent."""
    named = os.environ.get("STICTION_DATA", "../shared/data")
    folder = Path(named) if Path(named).is_absolute() else _REPOSITORY / named
    if not folder.is_dir():
        pytest.skip(f"no real recordings: STICTION_DATA names no folder ({folder})")
    return folder
