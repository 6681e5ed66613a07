"""Nobody drives them, and they gain nothing."""

from __future__ import annotations

from .undriven import count, drawn, gain


def test_no_motor_that_nobody_drives_gains_energy() -> None:
    ran, gained = count(400, seed=0)
    assert ran > 200
    assert not gained, "\n".join(f"{case.name} by {more:.3g}: {case}" for case, more in gained)


def test_a_case_is_the_same_again() -> None:
    assert drawn(3, 17) == drawn(3, 17)
    assert gain(drawn(3, 17)) == gain(drawn(3, 17))
