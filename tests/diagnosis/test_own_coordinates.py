"""Every effect is drawn where it shows: its own coordinate, at the order that was found."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np
import pytest
from tests.diagnosis import builders

import stiction as st
from stiction.diagnosis.adequacy.by_recording import BY_RECORDING
from stiction.diagnosis.adequacy.coordinates import COORDINATES, UNJUDGED, Coordinate
from stiction.diagnosis.adequacy.omnibus import Rest
from stiction.diagnosis.adequacy.passing import DRIFT, MOMENTS
from stiction.diagnosis.adequacy.periodic import COUPLED, FREQUENCY, ORDERS
from stiction.diagnosis.adequacy.response import RESPONSE
from stiction.diagnosis.adequacy.smoother import BINS, smoother
from stiction.diagnosis.data.contact import slides_of
from stiction.diagnosis.data.evidence import Plan
from stiction.diagnosis.findings.advice import APART, BY_COORDINATE
from stiction.diagnosis.findings.own import own_coordinate
from stiction.diagnosis.findings.presentation import PRESENTATIONS, Wave
from stiction.diagnosis.selection.held_numbers import HELD
from stiction.plant.parameter import Parameter
from stiction.plant.stated import Effect
from stiction.report.views import HINTS

SPACING = 0.005


def effect_of(name: str, **values: float) -> Effect:
    return Effect(name, MappingProxyType({key: Parameter(value) for key, value in values.items()}))


@pytest.mark.parametrize("record", st.effects(), ids=lambda record: record.name)
def test_every_effect_has_a_coordinate_of_its_own(record: st.EffectRecord) -> None:
    coordinate = own_coordinate(effect_of(record.name), "rotary")
    assert coordinate.name
    assert ", " in coordinate.axis
    if not isinstance(PRESENTATIONS[record.name].over, Wave):
        assert coordinate.name in {each.name for each in (*COORDINATES, *UNJUDGED)}


def test_every_effect_of_the_catalogue_and_no_other_has_an_entry() -> None:
    assert set(PRESENTATIONS) == {record.name for record in st.effects()}


def test_every_coordinate_has_a_hint_and_an_experiment() -> None:
    names = {each.name for each in (*COORDINATES, *ORDERS, *COUPLED, RESPONSE, FREQUENCY)}
    names |= {MOMENTS.name, DRIFT.name}
    differ = {each.name for each in BY_RECORDING}
    assert set(HINTS) == names | differ | set(HELD.values())
    assert set(BY_COORDINATE) == names
    # No experiment tells what was changed between recordings.
    assert set(APART) == differ


@pytest.mark.parametrize(
    ("values", "motion", "period", "name"),
    [
        ({}, "rotary", 2 * np.pi, "angle in the turn"),
        ({"order": 14.0}, "rotary", 2 * np.pi / 14, "angle in 1/14 of a turn"),
        ({"order": 14.0}, "linear", 2 * np.pi / 14, "position in the period"),
        # A second wave counts where it is there, and the period then holds both.
        ({"order": 6.0, "order_2": 9.0}, "rotary", 2 * np.pi / 6, "angle in 1/6 of a turn"),
        (
            {"order": 6.0, "order_2": 9.0, "cosine_2": 0.1},
            "rotary",
            2 * np.pi / 3,
            "angle in 1/3 of a turn",
        ),
        (
            {"order": 6.0, "order_2": 12.0, "sine_2": 0.1},
            "rotary",
            2 * np.pi / 6,
            "angle in 1/6 of a turn",
        ),
        (
            {"order": 7.3, "order_2": 9.9, "sine_2": 0.1},
            "rotary",
            2 * np.pi / 7.3,
            "position in the period",
        ),
    ],
)
def test_a_wave_is_folded_at_its_own_period(
    values: dict[str, float], motion: str, period: float, name: str
) -> None:
    coordinate = own_coordinate(effect_of("cogging", **values), motion)
    assert coordinate.name == name
    at = builders.look(position=np.array([0.1, 0.1 + period, 0.1 - 3 * period]))
    np.testing.assert_allclose(coordinate.values(at), 0.1, atol=1e-9)


def test_a_slide_remembers_the_rest_and_the_loading_before_it() -> None:
    # Rests of 0.5 and 2 s, then slides of the same length; the second one is loaded faster.
    still, moving = np.zeros(100), np.linspace(0.0, 0.05, 50)
    position = np.concatenate([still, moving, np.full(400, 0.05), 0.05 + moving])
    force = np.concatenate([np.linspace(0.0, 0.1, 100), np.full(450, 0.1), np.full(50, 0.1)])
    force[500:550] += np.linspace(0.0, 0.2, 50)
    force[550:] += 0.2
    found = slides_of(position, force, SPACING, window=1e-3)
    rest, rate = found.rest, found.loading
    assert np.array_equal(found.slid[:100], np.zeros(100))
    assert found.slid[149] == pytest.approx(0.049, rel=0.01)
    assert np.isnan(rest[:100]).all()
    assert np.isnan(rate[:100]).all()
    first, second = rest[100:150], rest[550:]
    assert np.nanmin(first) == np.nanmax(first) == pytest.approx(0.5, abs=0.02)
    assert np.nanmin(second) == np.nanmax(second) == pytest.approx(2.0, abs=0.02)
    # Beyond a few windows the slide has forgotten.
    assert 0 < np.isfinite(first).sum() < 20
    assert np.nanmax(rate[100:150]) < 0.4 * np.nanmax(rate[550:])
    assert np.array_equal(np.isnan(rest), np.isnan(rate))


def test_a_slow_slide_that_trembles_is_one_slide() -> None:
    position = np.concatenate([np.zeros(200), np.repeat(np.arange(60) * 2e-4, 2)])
    rest = slides_of(position, np.zeros_like(position), SPACING, window=1e-3).rest
    seen = rest[np.isfinite(rest)]
    assert seen.size
    assert np.all(seen == seen[0])


def test_rows_without_a_place_are_left_out_and_a_factor_is_divided_by() -> None:
    source = np.random.default_rng(3)
    number = 4000
    place, factor = source.uniform(0.0, 1.0, number), source.uniform(0.5, 2.0, number)
    place[::2] = np.nan
    weights = np.full(number, 4.0)
    residual = weights * np.where(np.isfinite(place), 3.0 * np.nan_to_num(place) * factor, 7.0)
    null = weights[:, None] * source.standard_normal((number, 8))
    held = np.arange(number) % 4 < 2
    evidence = builders.evidence(
        shown=[builders.evidence().shown[0].of(np.ones(number, dtype=bool))],
        plans=[Plan(~held, held)],
        weights=weights,
    )
    seen = builders.look(position=place, load=factor)
    coordinate = Coordinate(
        "place", "place, m", False, lambda look: look.position, factor=lambda look: look.load
    )
    view = smoother(coordinate, evidence, [seen], np.column_stack([residual, null]), 1.0)
    assert 6 < len(view.at) < BINS  # as few rows have a place
    np.testing.assert_allclose(view.mean, 3.0 * view.at, atol=0.07)
    power = residual[held] ** 2
    own = np.isfinite(place[held])
    assert view.share == pytest.approx(np.sum(power[own]) / np.sum(power), abs=0.01)


@pytest.mark.parametrize(
    ("wide", "fine", "listed"),
    [
        (0.10, 0.11, ["speed", "effort"]),
        (0.10, 0.15, ["effort along the motion", "speed"]),
        (0.01, 0.11, ["speed", "effort along the motion"]),
    ],
)
def test_a_coordinate_and_its_refinement_are_listed_once(
    wide: float, fine: float, listed: list[str]
) -> None:
    shares = {"speed": 0.12, "effort": wide, "effort along the motion": fine}
    views = [builders.view(name, share) for name, share in shares.items()]
    rest = Rest(tuple(sorted(views, key=lambda view: -view.share)))
    assert [view.coordinate.name for view in rest.significant_views()] == listed
