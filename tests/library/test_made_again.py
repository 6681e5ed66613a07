"""What the script makes of the recordings is what the package holds."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from benches.library import ENTRIES, RECIPES, entry_of

NEAR = 1e-4
"""Of numbers: other processors round otherwise on the way to a minimum."""
QUICK = ("basalt_fault", "ur10e_wrist")


def numbers(table: Any, path: str = "") -> dict[str, float]:
    """Every number of nested tables, by where it stands."""
    if isinstance(table, dict):
        pairs = [numbers(value, f"{path}.{key}") for key, value in table.items()]
    elif isinstance(table, list):
        pairs = [numbers(value, f"{path}[{k}]") for k, value in enumerate(table)]
    else:
        return {path: float(table)} if isinstance(table, float | int) else {}
    return {key: value for pair in pairs for key, value in pair.items()}


@pytest.mark.long
@pytest.mark.parametrize(
    "name",
    [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in RECIPES],
)
def test_an_entry_is_made_again(
    name: str, shared_data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STICTION_DATA", str(shared_data.resolve()))
    kept = tomllib.loads((ENTRIES / f"{name}.toml").read_text(encoding="utf-8"))
    made = tomllib.loads(entry_of(name, RECIPES[name]))
    assert made["plant"]["friction"]["law"] == kept["plant"]["friction"]["law"]
    assert numbers(made) == pytest.approx(numbers(kept), rel=NEAR)
