"""Errors of an encoder that go with the angle drown the inertia, seen through narrow kernels."""

import pytest
from tests.reference.pendulum_reference import DRY, INERTIA, WEIGHT, swung

import stiction as st
from stiction.diagnosis.screening.base import fit_baseline, fit_wider_baseline
from stiction.fitting import first_pass
from stiction.fitting.forms import residual_sentence as residual_told
from stiction.plant import Plant


def pendulum():
    return Plant.from_dict(
        {
            "motion": {"kind": "rotary"},
            "drive": {"input": "torque_nm", "gain": 1.0},
            "body": {"gravity_amplitude": 1.0, "gravity_zero_rad": 0.0},
            "friction": {"law": "coulomb"},
        }
    )


def recordings(**what):
    return [swung(seed, **what) for seed in (1, 2, 3)]


def fitted(**what):
    return st.fit(pendulum(), st.Session(recordings(**what)))


def values(result):
    body = result.plant.body
    return body["inertia"].value, body["gravity_amplitude"].value


def test_errors_that_go_with_the_angle_take_no_inertia_with_them():
    result = fitted(error=1e-3)
    inertia, weight = values(result)
    assert inertia == pytest.approx(INERTIA, rel=0.08)
    assert weight == pytest.approx(WEIGHT, rel=0.08)
    assert result.plant.friction.parameters["coulomb"].value == pytest.approx(DRY, rel=0.08)
    assert result.train_relative < 0.05


@pytest.mark.parametrize("what", [{}, {"error": 5e-5}, {"ripple": 0.3}])
def test_kernels_stay_narrow_where_the_inertia_shows(what):
    evidence, base = fit_baseline(pendulum(), recordings(**what), wide=True)
    assert max(form.kernel.support for form in evidence.forms) < 0.1
    assert "drowned" not in residual_told(evidence.forms, base.plant)
    assert base.plant.inertia == pytest.approx(INERTIA, rel=0.1)


def test_a_large_quick_torque_is_not_averaged_away():
    evidence, _ = fit_baseline(pendulum(), recordings(ripple=1.0), wide=True)
    assert max(form.kernel.support for form in evidence.forms) < 0.1


def test_a_diagnosis_says_that_kernels_were_widened():
    evidence, base = fit_baseline(pendulum(), recordings(error=1e-3), wide=True)
    assert base.plant.inertia == pytest.approx(INERTIA, rel=0.05)
    assert "through narrower kernels the inertia drowned" in residual_told(
        evidence.forms, base.plant
    )


def test_kernels_that_the_recordings_cannot_hold_change_nothing(monkeypatch):
    swings, plant, begun = recordings(error=1e-3), pendulum(), []
    from_data = first_pass.fit_from_data

    def fit_from_data(*given, **named):
        begun.append(given)
        return from_data(*given, **named)

    _, base = fit_baseline(plant, swings)
    for module in ("fitting.first_pass", "diagnosis.screening.base"):
        monkeypatch.setattr(f"stiction.{module}.wider_of", lambda *_: 12.0)
    result = st.fit(pendulum(), st.Session(swings))
    assert result.success
    assert values(result)[0] < 0.8 * INERTIA
    monkeypatch.setattr(first_pass, "fit_from_data", fit_from_data)
    assert fit_wider_baseline(plant, swings, base, base) is None
    # What was fitted through narrow kernels is known.
    assert not begun
    assert fit_wider_baseline(pendulum(), swings, base, base) is None
    assert len(begun) == 1
