from __future__ import annotations

import math

import pytest

from stiction._support.units import SI_UNIT, UNITS, ending_unit, find_unit, to_si
from stiction.errors import InputError

COUNT_SIZE = 2.0 * math.pi / 4096.0


@pytest.mark.parametrize(
    ("value", "unit", "expected"),
    [
        (250.0, "ms", 0.25),
        (250.0, "µs", 250e-6),
        (250.0, "us", 250e-6),
        (180.0, "deg", math.pi),
        (0.5, "rev", math.pi),
        (3.0, "mm", 0.003),
        (3.0, "um", 3e-6),
        (40.0, "mA", 0.04),
        (12.0, "mV", 0.012),
        (5.0, "mNm", 0.005),
        (5.0, "N·m", 5.0),
        (2.0, "kN", 2000.0),
        (60.0, "rpm", 2.0 * math.pi),
        (90.0, "deg/s", math.pi / 2.0),
        (7.0, "mm/s", 0.007),
        (300.15, "K", 27.0),
        (27.0, "degC", 27.0),
        (20.0, "MPa", 20e6),
        (0.6, "1", 0.6),
    ],
)
def test_a_unit_converts_to_its_si_value(value: float, unit: str, expected: float) -> None:
    assert to_si(value, UNITS[unit]) == pytest.approx(expected, rel=1e-15)


def test_every_unit_but_count_belongs_to_a_quantity_with_an_si_unit() -> None:
    assert {unit.quantity for unit in UNITS.values()} - {"count"} == set(SI_UNIT)
    assert all(UNITS[name].factor == 1.0 for name in SI_UNIT.values())


def test_both_micro_signs_and_both_centred_dots_are_read() -> None:
    assert find_unit("\N{GREEK SMALL LETTER MU}m", "x") is UNITS["µm"]
    assert find_unit("N\N{DOT OPERATOR}m", "x") is UNITS["N·m"]


@pytest.mark.parametrize(
    ("written", "unit"),
    [("°", "deg"), ("\N{MASCULINE ORDINAL INDICATOR}", "deg"), ("°C", "degC"), ("°/s", "deg/s"),
     ("U/min", "rpm"), ("1/min", "rpm"), ("min⁻¹", "rpm"),
     ("N*m", "N·m"), ("N.m", "N·m"), ("mN m", "mNm")],
)  # fmt: skip
def test_signs_that_instruments_print_are_read(written: str, unit: str) -> None:
    assert find_unit(written, "x") is UNITS[unit]


def test_an_unknown_unit_names_its_neighbour_and_the_field() -> None:
    with pytest.raises(InputError, match=r"^here: the unit 'Degr' .*did you mean 'deg'.*rpm"):
        find_unit("Degr", "here")
    assert find_unit("deg", "here").quantity == "angle"


def test_counts_need_the_size_of_a_count() -> None:
    with pytest.raises(InputError, match=r"count.*counts_per_rev or count_m"):
        to_si([1.0], UNITS["count"])
    for size in (0.0, -1.0, math.nan):
        with pytest.raises(InputError, match="above 0"):
            to_si([1.0], UNITS["count"], count_size=size)
    assert to_si([4096.0], UNITS["count"], count_size=COUNT_SIZE)[0] == 2.0 * math.pi


@pytest.mark.parametrize(
    ("name", "quantities", "unit"),
    [
        ("motor_position_deg", ("angle", "length"), "deg"),
        ("velocity_rad_s", ("angular velocity",), "rad/s"),
        ("Drive_mA", ("current",), "mA"),
        ("clock_µs", ("time",), "µs"),
        ("oil_K", ("temperature",), "K"),
        ("velocity_rad_s", ("time",), None),
        ("position", ("angle",), None),
        ("i_m", ("current",), None),
    ],
)
def test_a_column_ending_tells_the_unit_where_it_can_be_one(
    name: str, quantities: tuple[str, ...], unit: str | None
) -> None:
    found = ending_unit(name, quantities)
    assert (found.name if found else None) == unit
