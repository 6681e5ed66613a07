"""What a page carries of its recordings is small, whole and nothing else."""

from __future__ import annotations

import json
import re
import zlib
from base64 import b64decode
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from tests.report.canned import diagnosis, trace
from tests.report.test_report import Page

from stiction._support.arrays import FloatArray
from stiction.diagnosis import Diagnosis
from stiction.report import explorer as parts
from stiction.report import write
from stiction.report.explorer import explorer
from stiction.report.packing import Packed, pack


def unpacked(packed: Packed) -> FloatArray:
    """As the page does it, slowly."""
    planes = np.frombuffer(zlib.decompress(b64decode(packed.text)), np.uint8).reshape(4, -1)
    zigzag = sum(plane.astype(np.int64) << (8 * k) for k, plane in enumerate(planes))
    whole = (zigzag >> 1) ^ -(zigzag & 1)
    for _ in range(packed.order):
        whole = np.cumsum(whole)
    values: FloatArray = packed.origin + packed.step * whole
    return values


def walked(*, rows: int, names: int, effects: bool = True) -> Diagnosis:
    found = diagnosis("missing_effect" if effects else "nothing_missing")
    assert found.pictures is not None
    kept = tuple(trace(f"{k}", 1 + k % 3, effects=effects, rows=rows) for k in range(names))
    return replace(found, pictures=replace(found.pictures, traces=kept))


@pytest.mark.parametrize("seed", range(4))
def test_a_column_comes_back_to_half_a_step(seed: int) -> None:
    source = np.random.default_rng(seed)
    columns = {
        "noise": source.normal(0.0, 1.0, 5000),
        "walk": np.cumsum(source.normal(0.0, 1.0, 5000)) * 1e6,
        "steps": np.repeat(source.normal(0.0, 1e-9, 50), 100),
        "jumps": np.where(np.arange(5000) % 2, 1e12, -1e12),
        "time": np.arange(5000) * 5e-3,
        "nothing": np.zeros(7),
        "one": np.array([3.25]),
    }
    for name, values in columns.items():
        step = 1e-3 * float(np.std(values))
        packed = pack(values, step)
        assert packed.step >= step or name in ("nothing", "one")
        assert packed.step <= max(step, 2.0**-26 * float(np.ptp(values))) or step == 0.0
        np.testing.assert_allclose(unpacked(packed), values, atol=0.51 * packed.step)


def test_noise_costs_little_more_than_a_byte_and_an_even_clock_nothing() -> None:
    noise = np.random.default_rng(3).normal(0.0, 1.0, 100_000)
    assert len(pack(noise, 1.0 / 24.0).text) < 1.45 * noise.size
    clock = 0.015 + 0.005 * np.arange(100_000)
    assert len(pack(clock, 5e-6).text) < 0.02 * clock.size


def test_values_that_are_none_do_no_harm() -> None:
    packed = pack(np.array([np.nan, 1.0, np.nan, np.inf, 2.0, -np.inf]), 0.1)
    assert packed.blank == [[0, 1], [2, 4], [5, 6]]
    np.testing.assert_allclose(unpacked(packed)[[1, 4]], [1.0, 2.0], atol=0.05)
    assert np.isfinite(unpacked(packed)).all()
    assert unpacked(pack(np.array([]), 0.1)).size == 0
    assert pack(np.full(3, np.nan), 0.1).blank == [[0, 3]]


def test_a_million_rows_keep_what_is_extreme(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts, "MOST_VALUES", 60_000)
    found = walked(rows=20_000, names=3)
    assert found.pictures is not None
    thin = parts._kept(found.pictures.traces)
    assert sum(len(each.time) for each in thin) * 10 < 1.2 * 60_000
    for whole, kept in zip(found.pictures.traces, thin, strict=True):
        for name in ("after", "effort"):
            full, few = getattr(whole, name), getattr(kept, name)
            assert (few.min(), few.max()) == (full.min(), full.max())
        assert np.all(np.diff(kept.time) > 0.0)
        assert kept.simulated is not None
        assert {len(kept.contributions["torque_bias"]), len(kept.simulated[0])} == {len(kept.time)}


def test_where_a_loop_ran_away_nothing_is_drawn() -> None:
    found = walked(rows=100, names=2)
    assert found.pictures is not None
    first, second = found.pictures.traces
    pictures = replace(found.pictures, traces=(replace(first, simulated=None), second))
    made = explorer(replace(found, pictures=pictures))
    assert made is not None
    told = json.loads(re.search(r'id="explorer-data">(.*?)</script>', made.data)[1])  # type: ignore[index]
    assert told["columns"]["simulated-after"]["blank"] == [[0, 100]]
    assert told["columns"]["position"]["blank"] == []


def test_a_page_without_recordings_has_no_script(tmp_path: Path) -> None:
    found = diagnosis("missing_effect")
    assert found.pictures is not None
    bare = replace(found, pictures=replace(found.pictures, traces=()))
    page = Page(write(bare, tmp_path).read_text("utf-8"))
    assert page.scripts == []
    assert "explorer" not in page.ids


def test_panels_that_cannot_be_made_cost_the_page_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, left_out: list[str]
) -> None:
    def faulty(*_: object) -> None:
        raise IndexError("a fault of its own")

    monkeypatch.setattr(parts, "_columns", faulty)
    page = Page(write(diagnosis("missing_effect"), tmp_path).read_text("utf-8"))
    (sentence,) = left_out
    assert sentence.startswith("The panels that zoom could not be made (IndexError")
    assert sentence in page.text
    assert page.scripts == []


def test_the_library_is_named_with_its_licence(tmp_path: Path) -> None:
    text = write(diagnosis("missing_effect"), tmp_path).read_text("utf-8")
    assert "Copyright (c) 2022 Leon Sorokin" in unescape(text)
    assert "THE SOFTWARE IS PROVIDED" in text
