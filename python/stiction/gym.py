"""Positioning as an environment of Gymnasium, with friction drawn from what is known of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, SupportsFloat

import numpy as np

from ._support import given
from ._support.arrays import FloatArray
from ._support.frozen import path_of
from ._support.given import number
from .ensemble import Ensemble
from .errors import InputError
from .intervals import draw_values, intervals_of
from .plant import Plant

try:
    import gymnasium
    from gymnasium.vector.utils import batch_space
except ImportError:
    raise InputError(
        "stiction.gym: Gymnasium is missing; install it: pip install gymnasium"
    ) from None

__all__ = ["Positioning", "VectorPositioning", "intervals_of"]

TARGETS: Final = 0.8
"""Share of the reach within which targets are drawn."""


class _Task:
    """What both environments do: spaces, draws, readings, reward."""

    def __init__(
        self,
        machine: Any,
        intervals: Any,
        dt: float,
        reach: float,
        limit: float | None,
        length: int,
        effort_weight: float,
    ) -> None:
        plant = getattr(machine, "plant", machine)
        self.plant = given.instance(plant, Plant, "Positioning: machine", "a Plant or a Diagnosis")
        if self.plant.prescribed_motion:
            raise InputError(f"{self.plant.source}: a plant that is moved has no input to act on")
        known = machine if intervals is None and machine is not plant else intervals
        self.motor = self.plant.motor()
        every = {} if known is None else intervals_of(known)
        stated = self.motor.parameters
        self.intervals = {
            path_of(path, stated, "Positioning: intervals: "): ends for path, ends in every.items()
        }
        self.dt = _above(dt, "dt")
        self.reach = _above(reach, "reach")
        own = float(self.plant.drive.get("limit", np.inf)) if limit is None else limit
        if not np.isfinite(own):
            raise InputError(
                "Positioning: limit is missing, and [drive] states none; give the greatest input"
            )
        self.limit = _above(own, "limit")
        self.length = given.whole(length, "Positioning: length", least=1)
        self.effort_weight = number(effort_weight, "Positioning: effort_weight")
        fastest = 2.0 * self.reach / self.dt
        bounds = np.array([self.reach, fastest, self.reach])
        self.observation_space = gymnasium.spaces.Box(-bounds, bounds, dtype=np.float64)
        self.action_space = gymnasium.spaces.Box(-self.limit, self.limit, (1,), np.float64)

    def draw_values(self, source: np.random.Generator) -> dict[str, float]:
        """Values within the intervals, that a motor takes."""
        return draw_values(self.intervals, source, lambda values: self.machines(1, values))

    def machines(self, members: int, values: Mapping[str, Any]) -> Ensemble:
        """Machines at rest with these values, and with what the plant leaves open and follows."""
        whole, paths = dict(values), list(values)
        for path, place, factor in self.plant.following(paths):
            if path not in whole:
                whole[path] = factor * np.asarray(values[paths[place]])
        return Ensemble(self.motor, members, parameters=whole)

    def target(self, source: np.random.Generator) -> float:
        """A place to go to."""
        return float(source.uniform(-TARGETS, TARGETS)) * self.reach

    def observe(self, read: FloatArray, before: FloatArray, target: FloatArray) -> FloatArray:
        """Position and velocity as the encoder shows them, and the target; shape (members, 3)."""
        rows = np.stack([read, (read - before) / self.dt, target], axis=-1)
        found: FloatArray = np.clip(rows, self.observation_space.low, self.observation_space.high)
        return found

    def reward(self, position: FloatArray, target: FloatArray, input: FloatArray) -> FloatArray:
        """Of the true position: 0 at the target."""
        missed = np.abs(position - target) / self.reach
        found: FloatArray = -missed - self.effort_weight * (input / self.limit) ** 2
        return found


def _above(value: float, name: str) -> float:
    found = number(value, f"Positioning: {name}")
    if not (np.isfinite(found) and found > 0.0):
        raise InputError(f"Positioning: {name} = {found:g} is none; give one above 0")
    return found


_OUTPUTS: Final = ("position", "velocity", "measured")


class Positioning(gymnasium.Env[FloatArray, FloatArray]):  # type: ignore[misc, unused-ignore]
    """A machine that is to go to a target, and to stay there.

    The action is the input of the drive, held over a sample. Observed are position and velocity as
    the encoder shows them (velocity: the difference of two readings over a sample) and the target.
    The reward is the distance of the true position from the target as a share of the reach, less
    the effort: 0 at best. An episode is truncated after its length and terminated where the machine
    leaves its reach. Each one has a machine of its own, drawn evenly from the intervals.

    Parameters
    ----------
    machine : Plant, Diagnosis or FitResult
        The last two with their intervals.
    intervals : optional
        As for ``intervals_of``: of parameters that are drawn.
    dt : float
        Sample time, s.
    reach : float
        Greatest distance from 0, rad or m.
    limit : float, optional
        Greatest input; that of the drive without it.
    length : int
        Samples of an episode.
    effort_weight : float
        What the square of the greatest input costs a sample.

    Raises
    ------
    InputError
        No plant, intervals that are none or in which no motor is, no limit.

    Notes
    -----
    ``reset`` takes ``options`` with ``target`` (rad or m) and ``values`` (by path, in the place of
    what is drawn). ``info`` has the true ``position`` and ``velocity``, and the ``parameters`` that
    were drawn.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012 (as Gymnasium has it)

    def __init__(
        self,
        machine: Any,
        intervals: Any = None,
        *,
        dt: float = 1e-3,
        reach: float = 1.0,
        limit: float | None = None,
        length: int = 1000,
        effort_weight: float = 0.0,
    ) -> None:
        self._task = _Task(machine, intervals, dt, reach, limit, length, effort_weight)
        self.observation_space = self._task.observation_space
        self.action_space = self._task.action_space
        self._machine: Ensemble | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begin an episode with a machine at rest at 0; see the class."""
        super().reset(seed=seed)
        task, asked = self._task, dict(options or {})
        self._values = dict(asked.pop("values", None) or task.draw_values(self.np_random))
        self._target = float(asked.pop("target", task.target(self.np_random)))
        if asked:
            raise InputError(
                f"Positioning: options {', '.join(asked)} are none; there are target and values"
            )
        self._machine = task.machines(1, self._values)
        self._read = np.zeros(1)
        self._step = 0
        seen = task.observe(self._read, self._read, np.array([self._target]))[0]
        return seen, {"position": 0.0, "velocity": 0.0, "parameters": dict(self._values)}

    def step(
        self, action: FloatArray
    ) -> tuple[FloatArray, SupportsFloat, bool, bool, dict[str, Any]]:
        """Hold an input over a sample."""
        if self._machine is None:
            raise InputError("Positioning: step before reset; call reset first")
        task, target = self._task, np.array([self._target])
        held = np.clip(np.asarray(action, dtype=np.float64).ravel()[:1], -task.limit, task.limit)
        run = self._machine.simulate(held[:, None], task.dt, outputs=_OUTPUTS, threads=1)
        position, velocity, read = (run[name][:, -1] for name in _OUTPUTS)
        seen = task.observe(read, self._read, target)[0]
        self._read, self._step = read, self._step + 1
        reward = float(task.reward(position, target, held)[0])
        info = {
            "position": float(position[0]),
            "velocity": float(velocity[0]),
            "parameters": dict(self._values),
        }
        left = bool(abs(position[0]) > task.reach)
        return seen, reward, left, self._step >= task.length, info


class VectorPositioning(
    gymnasium.vector.VectorEnv[FloatArray, FloatArray, FloatArray]  # type: ignore[misc, unused-ignore]
):
    """The same with many machines at once, stepped together by an ``Ensemble``.

    All episodes begin and end together: they are truncated after their length and never terminated,
    and what leaves the reach goes on, read as if it stood at its end. The next step then begins new
    ones, as ``AutoresetMode.NEXT_STEP`` has it.

    Parameters
    ----------
    machine, intervals, dt, reach, limit, length, effort_weight
        As for ``Positioning``.
    num_envs : int
        How many.
    threads : int
        As for ``Ensemble.simulate``.

    Raises
    ------
    InputError
        As for ``Positioning``.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 (as Gymnasium has it)
        "render_modes": [],
        "autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        machine: Any,
        intervals: Any = None,
        *,
        num_envs: int = 64,
        dt: float = 1e-3,
        reach: float = 1.0,
        limit: float | None = None,
        length: int = 1000,
        effort_weight: float = 0.0,
        threads: int = 1,
    ) -> None:
        self._task = _Task(machine, intervals, dt, reach, limit, length, effort_weight)
        self.num_envs = given.whole(num_envs, "VectorPositioning: num_envs", least=1)
        self._threads = given.whole(threads, "VectorPositioning: threads", least=1)
        self.single_observation_space = self._task.observation_space
        self.single_action_space = self._task.action_space
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._machines: Ensemble | None = None

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[FloatArray, dict[str, Any]]:
        """Begin an episode of each machine, at rest at 0.

        A list of seeds is refused: one seed draws all machines.
        """
        if isinstance(seed, list):
            raise InputError("VectorPositioning: give one seed, which draws all machines")
        super().reset(seed=seed)
        task, members = self._task, range(self.num_envs)
        drawn = [task.draw_values(self.np_random) for _ in members]
        self._targets = np.array([task.target(self.np_random) for _ in members])
        values = {path: np.array([each[path] for each in drawn]) for path in task.intervals}
        self._machines = task.machines(self.num_envs, values)
        self._read, self._step = np.zeros(self.num_envs), 0
        return task.observe(self._read, self._read, self._targets), {"parameters": values}

    def step(
        self, actions: FloatArray
    ) -> tuple[FloatArray, FloatArray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Hold an input over a sample of each machine; after the last one, begin anew."""
        if self._machines is None:
            raise InputError("VectorPositioning: step before reset; call reset first")
        task, no = self._task, np.zeros(self.num_envs, dtype=bool)
        if self._step >= task.length:
            seen, info = self.reset()
            return seen, np.zeros(self.num_envs), no, no.copy(), info
        inputs = np.asarray(actions, dtype=np.float64).reshape(self.num_envs)
        held = np.clip(inputs, -task.limit, task.limit)
        run = self._machines.simulate(
            held[:, None], task.dt, outputs=_OUTPUTS, threads=self._threads
        )
        position, velocity, read = (run[name][:, -1] for name in _OUTPUTS)
        seen = task.observe(read, self._read, self._targets)
        self._read, self._step = read, self._step + 1
        ended = np.full(self.num_envs, self._step >= task.length)
        info = {"position": position, "velocity": velocity}
        return seen, task.reward(position, self._targets, held), no, ended, info
