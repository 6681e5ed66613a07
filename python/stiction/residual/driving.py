"""The motion that drives friction: readings of a position without what noise makes of them."""

from __future__ import annotations

from typing import Final

import numpy as np

from .._native import played
from .._support.arrays import FloatArray
from ..recording.motion import Kernel, hold_at_rest, narrowest, smooth
from .adaptive import smooth_adaptively

__all__ = ["Driving"]

NOISY_STEP: Final = 0.01
"""Noise of the position over the rms step from row to row above which the motion that drives a
rigid contact is smoothed; below it smoothing would only smear stops into slow motion."""
SMOOTHING_SHARE: Final = 0.1
"""Support over which it then is, as a share of the kernel's: 3 ms where that has 30 ms."""
FLICKER_SHARE: Final = 0.2
"""White noise beyond this share of a count makes readings flicker, and a backlash keeps that out.
Where they do not flicker it would only halve the speed about each turn."""
TURNING_SHARE: Final = 0.1
"""Noise of the velocity over its usual size above which a machine that is moved seems to turn
round, or friction of one that does not follows noise: its motion is then smoothed over up to the
widest kernel."""
SLOW: Final = 0.05
"""Quantile of the speed that counts as a slow one."""
RESTS_S: Final = 0.008
"""A machine without a spring rests where readings keep within noise for so long..."""
RESTS: Final = (4, 16)
"""... for so many samples at least and at most..."""
RESTING: Final = 6.0
"""... within so many standard deviations. A slow motion that is taken for a rest does no harm: the
contact then holds what acts on it, as slow sliding does."""
HELD: Final = 0.01
"""Share of the samples that must be held for friction to be late by it."""
LATE_WINDOWS: Final = 2.0
"""Windows of a rest by which it may be: one on either side."""
FLICKER: Final = 1.5
"""Counts within which readings that go to and fro flicker."""
BACKLASH_TIMES: Final = 4.0
"""Width of that backlash in standard deviations of the noise, a count at least: noise turns a slow
motion round for a sample, and dry friction would turn with it."""


class Driving:
    """How readings of one recording become the motion that its friction is driven by.

    Of a contact that yields they are smoothed by agreement; of a rigid one, which is balanced by
    true standstill alone, a backlash keeps flicker out, and what noise moves rests.

    Parameters
    ----------
    readings : numpy.ndarray, shape (rows,)
        At even stamps.
    kernel : Kernel
        That what is driven is seen through.
    noise : float
        Standard deviation of the readings, steps included.
    count : float
        Their step, 0 without one.
    springy : bool
        Whether the contact yields.
    prescribed : bool
        Whether the machine is moved: it does not stop by itself.

    Attributes
    ----------
    steadied : float
        Support, s, over which the motion of a machine that is moved is smoothed because noise is
        much of its velocity; 0 where it is not.
    """

    def __init__(
        self,
        readings: FloatArray,
        kernel: Kernel,
        *,
        noise: float,
        count: float,
        springy: bool,
        prescribed: bool,
    ) -> None:
        self._dt, self._count = kernel.dt, count
        self._springy, self._prescribed = springy, prescribed
        self._noise = max(noise, count / np.sqrt(12.0))
        white = float(np.sqrt(max(noise**2 - count**2 / 12.0, 0.0)))
        # Of a contact that yields the smoothing keeps it out, which is not late.
        flickers = white > FLICKER_SHARE * count and not springy
        self._backlash = max(count, BACKLASH_TIMES * white) if flickers else 0.0
        noisy = noise > NOISY_STEP * float(np.sqrt(np.mean(np.diff(readings) ** 2)))
        self._smoothing = max(self._dt, SMOOTHING_SHARE * kernel.support) if noisy else self._dt
        self.steadied = self._turned(readings)
        self._window = int(np.clip(round(RESTS_S / self._dt), *RESTS))

    def motion(self, readings: FloatArray) -> FloatArray:
        """The motion behind readings; same shape."""
        if self._springy:
            return smooth_adaptively(readings, self._dt, self._noise)
        if self.steadied > 0.0:
            return smooth(readings, self._dt, self.steadied, drifts=True)
        followed = smooth(played(readings, self._backlash), self._dt, self._smoothing)
        if self._prescribed:
            return followed
        if np.ptp(readings) < FLICKER * self._count:
            # Below break-away a machine yields a little, which a contact without a spring does not.
            return np.full_like(readings, readings[0])
        if self._backlash > 0.0:
            return hold_at_rest(followed, readings, self._window, RESTING * self._noise)
        # Little noise turns readings round where a machine rests between counts, and there alone.
        width = FLICKER * self._count
        return hold_at_rest(followed, readings, self._window, width, to_and_fro=True)

    @property
    def flickers(self) -> bool:
        """Whether readings flicker, and friction is driven through a backlash."""
        return self._backlash > 0.0

    def lateness(self, motion: FloatArray, readings: FloatArray) -> float:
        """Time, s, by which friction may follow late because noise had to be kept from it.

        0 where it need not be: readings that repeat as they are, and contacts that yield.
        """
        if self._springy or self._prescribed:
            return 0.0
        held = self.flickers or np.mean(motion != readings) > HELD
        return LATE_WINDOWS * self._dt * self._window if held else 0.0

    def _turned(self, readings: FloatArray) -> float:
        """Support, s, over which noise of a machine that is moved no longer governs its velocity.

        0 where it does not anyway. A machine that is moved does not stop by itself: nothing is
        smeared by it but what the effort is averaged over, too.
        """
        if self._springy or not self._prescribed or len(readings) < 3:
            return 0.0

        def steady(kernel: Kernel) -> bool:
            slopes = np.diff(kernel.weights, prepend=0.0, append=0.0) / self._dt
            speed = np.convolve(readings, slopes, "valid")
            noise = self._noise * float(np.linalg.norm(slopes))
            return bool(noise <= TURNING_SHARE * _usual(speed))

        if steady(Kernel(self._smoothing, self._dt)):
            return 0.0
        return narrowest(self._dt, steady).support


def _usual(speed: FloatArray) -> float:
    """Speed beside which noise of it counts: its rms, or a slow one of what goes one way.

    What never turns round may be slow for long, and its friction may go with the logarithm.
    """
    slow = np.quantile(speed * np.sign(np.median(speed)), SLOW)
    return float(slow) if slow > 0.0 else float(np.sqrt(np.mean(speed**2)))
