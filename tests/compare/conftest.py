"""The whole table, computed once."""

from __future__ import annotations

import pytest

from stiction.compare import compare


@pytest.fixture(scope="session")
def table():
    return compare()
