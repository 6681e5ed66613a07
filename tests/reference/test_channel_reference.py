"""What is recorded besides input and position: an external load and a temperature."""

from dataclasses import replace

import numpy as np
import pytest

from .more_recordings import Wanted, record_more
from .session_reference import make_session, make_sessions


def test_channels_are_recorded_where_they_are_asked_for_or_needed(tmp_path):
    options = {"base": "coulomb", "seconds": 18 * 1.0}
    none, both, needed = make_sessions(
        [
            options | {"seed": 5},
            options | {"seed": 5, "channels": ("load", "temperature")},
            options | {"seed": 5, "hidden": [("load_dependent_friction", 0.01)]},
        ]
    )
    assert none.recordings[0].load_nm is None
    assert none.recordings[0].temperature_c is None
    assert needed.recordings[0].temperature_c is None
    np.testing.assert_array_equal(needed.recordings[3].load_nm, both.recordings[3].load_nm)
    both.write(tmp_path)
    head = next(iter(sorted(tmp_path.glob("*.csv")))).read_text().splitlines()[0]
    assert head.endswith("load_nm,temperature_c")
    with pytest.raises(ValueError, match="channels are load, temperature, not speed"):
        make_session(1, channels=("speed",))


def test_a_load_is_another_one_in_every_recording():
    session = make_session(6, channels=("load",), seconds=18 * 3.0)
    level = session.plant["coulomb"]
    loads = [r.load_nm / level for r in session.recordings]
    assert len({load.tobytes() for load in loads}) == len(loads)
    for r, load in zip(session.recordings, loads, strict=True):
        assert load[0] == 0.0
        assert np.abs(load).max() <= (1.5 if r.reference_rad is not None else 0.15)
    assert max(load.max() for load in loads) > 1.0
    assert min(load.min() for load in loads) < -1.0


def test_a_temperature_rises_and_falls_and_is_no_clock():
    for session in make_sessions(
        [{"seed": s, "channels": ("temperature",), "seconds": 18.0} for s in range(20)]
    ):
        warm = np.concatenate([r.temperature_c for r in session.recordings])
        clock = np.concatenate([r.start_s + r.time_s for r in session.recordings])
        assert 20.0 <= warm[0] <= 30.0
        assert 10.0 <= np.ptp(warm) <= 25.0 + 1e-9
        assert warm.min() == warm[0]
        assert abs(np.corrcoef(warm, clock)[0, 1]) < 0.5
        assert np.diff(warm).max() > 0.0 > np.diff(warm).min()


def test_more_recordings_have_the_channels_of_the_session():
    options = {"channels": ("load",), "hidden": [("temperature_dependent_friction", 0.01)]}
    session = make_session(7, seconds=18.0, **options)
    goal = np.sin(np.arange(800) * 5e-3)
    wanted = [Wanted("more", "train", 200.0, reference=goal)]
    (more,) = record_more(session, wanted)
    assert more.load_nm.shape == more.temperature_c.shape == (800,)
    assert more.temperature_c[0] == pytest.approx(session.recordings[-1].temperature_c[-1])
    bare = replace(session, recordings=[replace(r, load_nm=None) for r in session.recordings])
    assert record_more(bare, wanted)[0].load_nm is None
