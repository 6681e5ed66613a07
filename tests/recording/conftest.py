"""What the tests of recordings share: a small machine's data."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

Columns = dict[str, npt.NDArray[np.float64]]
ROWS = 240


@pytest.fixture
def machine() -> Columns:
    """A driven shaft, 240 rows at 1 kHz, under canonical names."""
    time = np.arange(ROWS) / 1000.0
    return {
        "time_s": time,
        "current_a": np.sin(20.0 * time),
        "position_rad": 0.1 * np.cos(20.0 * time),
    }


@pytest.fixture
def lines(machine: Columns) -> list[str]:
    """The same machine as lines of CSV; line 1 is the header, row k is line k + 2."""
    rows = zip(*machine.values(), strict=True)
    return [",".join(machine), *(",".join(repr(float(cell)) for cell in row) for row in rows)]


@pytest.fixture
def written(tmp_path: Path) -> Callable[..., Path]:
    """Writes lines (or bytes) to a file and returns its path."""

    def write(content: list[str] | bytes, name: str = "run.csv") -> Path:
        path = tmp_path / name
        data = content if isinstance(content, bytes) else "\n".join(content).encode() + b"\n"
        path.write_bytes(data)
        return path

    return write
