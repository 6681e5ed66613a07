"""Driving a contact by force, and finding its scales."""

from __future__ import annotations

import math

import numpy as np
import pytest

import stiction as st
from stiction.compare.host import Host
from stiction.compare.subject import Subject, variants

# The host's damper lets a contact follow with a time constant of a millisecond.
FOLLOWED = 1e-6


def spring(**values):
    return Subject("maxwell_slip", "own", {"coulomb": 0.4, "initial_stiffness": 2000.0, **values})


def test_a_spring_is_pushed_to_where_its_curve_has_the_force():
    subject = spring()
    host = subject.host()
    host.ramp(0.0, 0.3, 0.5, 200)
    host.hold(0.3, 0.05, 20)
    # κ = 0: F = F_c·(1 − exp(−k_0·x/F_c)).
    assert host.position == pytest.approx(-0.4 / 2000.0 * math.log(0.25), rel=FOLLOWED)


def test_a_sticking_contact_does_not_move_to_the_last_bit():
    host = Subject("coulomb", "own", {"coulomb": 0.4}).host()
    assert not host.ramp(0.0, 0.399, 1.0, 50).any()
    host.push([0.41], 0.1)
    assert host.position > 0.0


def test_beyond_its_level_a_contact_slides_against_the_damper_alone():
    law = st.FrictionModel("coulomb", coulomb=0.4)
    host = Host(law, 0.4, damping=2.0)
    host.push([0.6], 0.1)
    assert host.position == pytest.approx(0.1 * 0.2 / 2.0)


def test_very_slow_creep_is_found():
    # Below its level rate-and-state friction on a spring slips ever more slowly.
    law = st.FrictionModel("rate_and_state", compliance=1e-4)
    law.step(1e-3, 1e-2)
    host = Host(law, 0.35, 1e-6)
    host.push([0.34] * 5, 0.1)
    force = law.trial(0.0, 1e-9)[0]
    assert force == pytest.approx(0.34, abs=1e-9)


def test_scales_are_those_of_the_closed_form():
    scale = spring().scale
    assert scale.level == pytest.approx(0.4)
    # The stiffness is read at a tenth of the level, where it has begun to fall.
    assert scale.span == pytest.approx(0.4 / 2000.0, rel=0.1)
    assert scale.slides
    rigid = Subject("coulomb", "own", {"coulomb": 0.4})
    assert rigid.rigid
    assert rigid.scale.level == pytest.approx(0.4)


def test_friction_without_chance_does_not_scatter():
    for law in ("coulomb", "maxwell_slip", "rate_and_state"):
        assert Subject(law, "own", {}).scatter < 1e-6


def test_a_law_that_never_slides_has_its_level_where_it_has_softened_halfway():
    scale = Subject("hsieh_pan", "own", {"hardening_coefficient": 0.0, "damping": 0.0}).scale
    assert not scale.slides
    k_0, k_inf, d_0 = 3000.0, 810.0, math.radians(1.0 / 60.0)
    x = 0.5 * d_0 * math.log(2.0)
    expected = k_inf * x + 0.5 * (k_0 - k_inf) * d_0 * 0.5
    assert scale.level == pytest.approx(expected, rel=0.06)


@pytest.mark.parametrize("record", st.laws(), ids=lambda record: record.name)
def test_every_case_of_a_law_builds_and_has_a_level(record):
    labels = [subject.label for subject in variants(record)]
    assert labels[0] == "defaults"
    assert len(set(labels)) == len(labels)
    for subject in variants(record):
        assert subject.scale.level > 0.0
        assert np.isfinite(subject.length)
