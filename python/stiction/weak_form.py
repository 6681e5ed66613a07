"""The weak form of a plant along a recording: efforts and their derivatives through one kernel."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from .errors import InputError
from .motion import SMOOTHING_SHARE, Kernel, count_of, evenly, held, noise_of, play, smooth
from .trajectory import FloatArray

if TYPE_CHECKING:
    from .plant import Plant
    from .recording import Recording

__all__ = ["WeakForm"]

SUPPORTS_S: Final = (0.030, 0.300)
"""Narrowest and widest kernel that is chosen; 28 to 50 ms suit machines sampled at 1 kHz."""
FEWEST_SAMPLES: Final = 8
"""Fewer samples than this do not average anything."""
NOISE_SHARE: Final = 0.02
"""The kernel is widened until the inertia term holds less position noise than this share of the
effort: a coarse encoder needs more than 30 ms."""
NOISY_STEP: Final = 0.01
"""Noise of the position over the rms step from row to row above which the motion that drives
friction is smoothed; below it smoothing would only smear stops into slow motion."""
ACCELERATION_SHARE: Final = 0.1
"""Where no inertia is stated: share of the acceleration that may be noise."""


class WeakForm:
    """A recording seen through a kernel, ready to be compared with a plant again and again.

    Everything that no parameter changes is computed once: even stamps, the motion that drives
    friction, the inertia term of a unit inertia.

    Parameters
    ----------
    plant : Plant
        For its kind of motion, drive and sensor.
    recording : Recording
        With position, and input or (for prescribed motion) effort.
    support : float, optional
        Width of the kernel in s. Without it the narrowest one from 30 ms on that keeps the
        position noise in the inertia term below 2 % of the effort.
    every : float, optional
        Spacing of the results in s; every sample without it.

    Attributes
    ----------
    time : numpy.ndarray, shape (n,)
        Centres of the kernel, s.
    acceleration : numpy.ndarray, shape (n,)
        rad/s² or m/s², through the kernel.
    kernel : Kernel

    Raises
    ------
    InputError
        No position, no input, or too short for the kernel.
    """

    def __init__(
        self,
        plant: Plant,
        recording: Recording,
        *,
        support: float | None = None,
        every: float | None = None,
    ) -> None:
        source = str(recording.path) if recording.path is not None else "recording"
        if recording.position is None:
            raise InputError(f"{source}: there is no measured position to compare with")
        self.prescribed = plant.prescribed_motion or recording.input is None
        driving = recording.effort if self.prescribed else recording.input
        if driving is None:
            raise InputError(
                f"{source}: there is no effort; prescribed motion needs an effort column"
            )
        time, self.dt = evenly(recording.time)
        x = np.interp(time, recording.time, recording.position)
        u = held(time, recording.time, driving)
        noise = noise_of(x)
        if support is not None:
            self.kernel = Kernel(support, self.dt)
        elif "inertia" in plant.body or self.prescribed:
            gain = 1.0 if self.prescribed else float(plant.drive.get("gain", 1.0))
            level = NOISE_SHARE * abs(gain) * float(np.sqrt(np.mean(u**2)))
            inertia = plant.inertia
            self.kernel = _narrowest(self.dt, lambda k: inertia * noise * k.roughness <= level)
        else:
            # Without an inertia the accelerations themselves have to stand above their noise.
            self.kernel = _narrowest(
                self.dt, lambda k: noise * k.roughness <= ACCELERATION_SHARE * _rms(k, x)
            )
        if len(time) < 4 * self.kernel.half:
            raise InputError(
                f"{source}: {len(time)} samples are too few for a kernel of "
                f"{self.kernel.support:.3g} s; give a longer recording or a smaller support"
            )
        self.stride = 1 if every is None else max(1, round(every / self.dt))
        load = recording.channels.get("load")
        self.load = np.zeros_like(x) if load is None else held(time, recording.time, load)
        self.effort = u
        followed = play(x, plant.count or count_of(x))
        noisy = noise > NOISY_STEP * float(np.sqrt(np.mean(np.diff(x) ** 2)))
        smoothing = max(self.dt, SMOOTHING_SHARE * self.kernel.support) if noisy else self.dt
        self.position = smooth(followed, self.dt, smoothing)
        self.input = np.zeros(len(x) - 1) if self.prescribed else u[:-1]
        self.time = self._thin(time[1:][self.kernel.half : -self.kernel.half])
        self.acceleration = self._thin(self.kernel.second_derivative(x[1:]))

    def __len__(self) -> int:
        return len(self.time)

    @property
    def velocity(self) -> FloatArray:
        """Velocity through the kernel, shape (n,)."""
        return self._mean(np.gradient(self.position, self.dt)[1:])

    def mean(self, values: FloatArray) -> FloatArray:
        """Values at the ends of the samples (shape of ``position[1:]``) through the kernel."""
        return self._mean(values)

    def measured(self, plant: Plant) -> FloatArray:
        """Effort of the drive and load (prescribed motion: the measured one); shape (n,)."""
        if self.prescribed:
            return self._mean(self.effort[1:] + _centred(self.load[:-1]))
        gain = float(plant.drive.get("gain", 1.0))
        limit = float(plant.drive.get("limit", np.inf))
        drive = gain * np.clip(self.input, -limit, limit)
        return self._mean(_centred(drive) + _centred(self.load[:-1]))

    def efforts(self, plant: Plant) -> tuple[FloatArray, FloatArray]:
        """Measured effort, and what the plant needs for the measured motion; shape (n,) each."""
        motor = plant.follower()
        motor.reset(float(self.position[0]), 0.0)
        drive, ambient, friction = motor.follow(
            self.position, self.input, self.dt, load=self.load[:-1]
        )
        # Stamps of `follow` are the sample ends. A measured effort belongs to its stamp; a held
        # one is the mean of what held before and after, or it is half a sample late.
        measured = self.effort[1:] if self.prescribed else _centred(drive)
        measured = measured + _centred(self.load[:-1])
        model = plant.inertia * self.acceleration + self._mean(friction - ambient)
        return self._mean(measured), model

    def jacobian(self, plant: Plant, paths: Sequence[str]) -> FloatArray:
        """Derivatives of measured minus needed effort by parameters; shape (n, parameters)."""
        motor = plant.follower()
        motor.reset(float(self.position[0]), 0.0)
        needed, driven = motor.follow_sensitivity(
            self.position, self.input, self.dt, list(paths), load=self.load[:-1]
        )
        columns = np.empty((len(self), len(paths)))
        for k, path in enumerate(paths):
            columns[:, k] = -self._mean(needed[k])
            if not self.prescribed and np.any(driven[k]):
                columns[:, k] += self._mean(_centred(driven[k]))
            if path == "body.inertia":
                columns[:, k] -= self.acceleration
        return columns

    def _mean(self, values: FloatArray) -> FloatArray:
        return self._thin(self.kernel.mean(values))

    def _thin(self, values: FloatArray) -> FloatArray:
        thinned: FloatArray = values[:: self.stride]
        return thinned


def _centred(values: FloatArray) -> FloatArray:
    """At the end of each sample the mean of what held in it and in the next."""
    centred: FloatArray = 0.5 * (values + np.append(values[1:], values[-1]))
    return centred


def _narrowest(dt: float, quiet: Callable[[Kernel], bool]) -> Kernel:
    """The narrowest kernel that is quiet enough, or the widest allowed."""
    support, widest = max(SUPPORTS_S[0], FEWEST_SAMPLES * dt), SUPPORTS_S[1]
    while True:
        kernel = Kernel(support, dt)
        if support >= widest or quiet(kernel):
            return kernel
        support = min(1.25 * support, widest)


def _rms(kernel: Kernel, position: FloatArray) -> float:
    """Root mean square of the acceleration through a kernel; 0 where it does not fit."""
    if len(position) <= 2 * kernel.half:
        return 0.0
    return float(np.sqrt(np.mean(kernel.second_derivative(position) ** 2)))
