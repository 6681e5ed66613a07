"""What the compiled module holds; checked against the binary by stubtest."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Final, Self, TypeVar, final, overload

import numpy as np
import numpy.typing as npt

from .catalogue import LawRecord
from .fixed import Fixed

_Item = TypeVar("_Item")
_Result = TypeVar("_Result")
_Floats = npt.NDArray[np.float64]

__all__ = [
    "CancelToken",
    "Ensemble",
    "FrictionModel",
    "Motion",
    "Motor",
    "Nothing",
    "RowKernel",
    "__profile__",
    "__version__",
    "adaptively_smoothed",
    "called",
    "effects",
    "laws",
    "least_squares",
    "played",
]

__version__: Final[str]
__profile__: Final[str]

def called(law: str, given: str) -> str | None: ...
def laws() -> list[dict[str, Any]]: ...
def effects() -> list[dict[str, Any]]: ...
def least_squares(
    residual: Callable[[_Floats], Sequence[_Floats]],
    slopes: Callable[[_Floats], tuple[Sequence[tuple[list[int], _Floats]], _Floats | None]],
    begin: npt.ArrayLike,
    low: npt.ArrayLike,
    high: npt.ArrayLike,
    scale: npt.ArrayLike,
    *,
    pulls: Sequence[tuple[int, float, float]],
    most: int,
    tolerance: float,
    nothing: float,
    straight: bool,
    damping: float,
    threads: int,
) -> tuple[_Floats, float, bool, bool]: ...
def adaptively_smoothed(
    readings: npt.ArrayLike, noise: float, halves: Sequence[int]
) -> _Floats: ...
def played(readings: npt.ArrayLike, width: float) -> _Floats: ...

@final
class CancelToken:
    def __new__(cls) -> CancelToken: ...
    def cancel(self) -> None: ...
    def run(self, work: Callable[[_Item], _Result], item: _Item, /) -> _Result: ...

@final
class FrictionModel:
    @overload
    def __new__(cls, law: str | LawRecord, **keywords: float | str) -> FrictionModel: ...
    @overload
    def __new__(
        cls,
        law: str | LawRecord,
        *,
        effects: dict[str, dict[str, float]] | None = None,
        **keywords: float | str,
    ) -> FrictionModel: ...
    def step(
        self,
        velocity: float,
        dt: float,
        *,
        load: float = 0.0,
        effort: float = 0.0,
        temperature: float | None = None,
    ) -> float: ...
    def simulate(
        self,
        velocity: npt.ArrayLike,
        dt: float,
        *,
        load: npt.ArrayLike | None = None,
        effort: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
    ) -> _Floats: ...
    def trial(
        self,
        velocity: float,
        dt: float,
        *,
        load: float = 0.0,
        effort: float = 0.0,
        temperature: float | None = None,
    ) -> tuple[float, float]: ...
    def derivatives(
        self,
        velocity: float,
        dt: float,
        *,
        load: float = 0.0,
        effort: float = 0.0,
        temperature: float | None = None,
    ) -> tuple[float, dict[str, float], dict[str, float]]: ...
    def commit(self) -> None: ...
    def reset(self, position: float = 0.0, *, time: float = 0.0, path: float = 0.0) -> None: ...
    def copy(self) -> FrictionModel: ...
    def __copy__(self) -> FrictionModel: ...
    def __deepcopy__(self, _memo: Any, /) -> FrictionModel: ...
    @property
    def law(self) -> str: ...
    @property
    def parameters(self) -> Fixed[str, float]: ...
    @property
    def effects(self) -> dict[str, dict[str, float]]: ...
    @property
    def options(self) -> Fixed[str, str]: ...
    def _repr_html_(self) -> str: ...
    @property
    def passive(self) -> bool: ...
    @property
    def state(self) -> dict[str, Any]: ...
    @state.setter
    def state(self, value: dict[str, Any]) -> None: ...
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]
    def __reduce__(self) -> tuple[Any, ...]: ...

@final
class Motion:
    def __new__(
        cls,
        position: npt.ArrayLike,
        current: npt.ArrayLike,
        dt: npt.ArrayLike,
        *,
        load: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
        enabled: npt.ArrayLike | None = None,
        transmitted: npt.ArrayLike | None = None,
        averaged: bool = False,
    ) -> Motion: ...
    def __len__(self) -> int: ...

class Motor:
    def __new__(
        cls,
        inertia: float,
        torque_constant: float = 1.0,
        friction: FrictionModel | None = None,
        *,
        effects: dict[str, dict[str, float]] | None = None,
        gravity_amplitude: float = 0.0,
        gravity_zero: float = 0.0,
        weight: float = 0.0,
        input_limit: float = ...,
        servo: dict[str, float] | None = None,
        count: float = 0.0,
        integrator: str = "fast",
    ) -> Motor: ...
    def step(
        self,
        current: float,
        dt: float,
        *,
        load: float = 0.0,
        temperature: float | None = None,
        enabled: bool = True,
    ) -> tuple[float, float]: ...
    def run(
        self,
        current: npt.ArrayLike,
        dt: npt.ArrayLike,
        load: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
        enabled: npt.ArrayLike | None = None,
        outputs: Sequence[str] | None = None,
        out: dict[str, _Floats] | None = None,
        transmitted: npt.ArrayLike | None = None,
    ) -> tuple[dict[str, _Floats], int, float, dict[str, int]]: ...
    def run_segments(
        self,
        durations: npt.ArrayLike,
        current: npt.ArrayLike,
        *,
        tolerance: float,
        times: npt.ArrayLike | None = None,
        load: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
        enabled: npt.ArrayLike | None = None,
        outputs: Sequence[str] | None = None,
    ) -> tuple[_Floats, dict[str, _Floats], dict[str, int]]: ...
    def follow(
        self,
        motion: Motion,
        *,
        start: dict[str, float] | None = None,
        strict: bool = True,
    ) -> tuple[_Floats, _Floats, _Floats, _Floats]: ...
    def follow_rows(
        self,
        motion: Motion,
        kernel: RowKernel,
        *,
        start: dict[str, float] | None = None,
        strict: bool = True,
    ) -> _Floats: ...
    def follow_sensitivity(
        self,
        motion: Motion,
        parameters: Sequence[str],
        *,
        start: dict[str, float] | None = None,
        strict: bool = True,
    ) -> tuple[_Floats, _Floats, _Floats]: ...
    def follow_columns(
        self,
        motion: Motion,
        parameters: Sequence[str],
        kernel: RowKernel,
        *,
        start: dict[str, float] | None = None,
        strict: bool = True,
    ) -> _Floats: ...
    def signatures(
        self,
        motion: Motion,
        candidates: Iterable[tuple[str, dict[str, float]]],
        *,
        start: dict[str, float] | None = None,
        threads: int = 1,
        strict: bool = True,
    ) -> tuple[_Floats, _Floats, _Floats]: ...
    def signature_columns(
        self,
        motion: Motion,
        candidates: Iterable[tuple[str, dict[str, float]]],
        kernel: RowKernel,
        *,
        start: dict[str, float] | None = None,
        threads: int = 1,
        strict: bool = True,
        kept: Iterable[int] | None = None,
    ) -> _Floats: ...
    def shoot(
        self,
        motion: Motion,
        weights: npt.ArrayLike,
        stride: int,
        *,
        start: dict[str, float] | None = None,
        strict: bool = True,
    ) -> _Floats: ...
    def accompany(
        self,
        motion: Motion,
        stiffness: float,
        damping: float,
        *,
        start: dict[str, float] | None = None,
        strict: bool = True,
    ) -> tuple[_Floats, _Floats]: ...
    def shoot_sensitivity(
        self,
        motion: Motion,
        weights: npt.ArrayLike,
        stride: int,
        parameters: Sequence[str],
        *,
        start: dict[str, float] | None = None,
        strict: bool = True,
    ) -> _Floats: ...
    def shoot_response(
        self,
        motion: Motion,
        weights: npt.ArrayLike,
        stride: int,
        parts: int,
        *,
        start: dict[str, float] | None = None,
        strict: bool = True,
    ) -> _Floats: ...
    def shoot_signatures(
        self,
        motion: Motion,
        weights: npt.ArrayLike,
        stride: int,
        candidates: Iterable[tuple[str, dict[str, float]]],
        parts: int,
        *,
        start: dict[str, float] | None = None,
        threads: int = 1,
        strict: bool = True,
    ) -> _Floats: ...
    def sensitivity(
        self,
        current: npt.ArrayLike,
        dt: npt.ArrayLike,
        parameters: Sequence[str],
        *,
        load: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
        enabled: npt.ArrayLike | None = None,
        transmitted: npt.ArrayLike | None = None,
        start: dict[str, float] | None = None,
        out: _Floats | None = None,
        strict: bool = True,
    ) -> tuple[_Floats, _Floats]: ...
    def gradient(
        self,
        current: npt.ArrayLike,
        dt: npt.ArrayLike,
        position: npt.ArrayLike,
        velocity: npt.ArrayLike,
        *,
        by: str = "input",
        load: npt.ArrayLike | None = None,
        temperature: npt.ArrayLike | None = None,
        enabled: npt.ArrayLike | None = None,
        transmitted: npt.ArrayLike | None = None,
        strict: bool = True,
    ) -> _Floats: ...
    def contact(self) -> tuple[FrictionModel, list[str]]: ...
    def adopt(self, other: Motor) -> None: ...
    def settings(self) -> dict[str, Any]: ...
    def friction_settings(self) -> tuple[str, dict[str, Any]]: ...
    def friction_state(self) -> dict[str, Any]: ...
    def reset(
        self,
        position: float = 0.0,
        velocity: float = 0.0,
        *,
        time: float = 0.0,
        path: float = 0.0,
    ) -> None: ...
    @property
    def parameters(self) -> Fixed[str, float]: ...
    @property
    def output_names(self) -> list[str]: ...
    @property
    def clock(self) -> float: ...
    @property
    def state(self) -> dict[str, Any]: ...
    @state.setter
    def state(self, value: dict[str, Any]) -> None: ...
    @property
    def statistics(self) -> dict[str, int]: ...

class Ensemble:
    def __new__(
        cls, motor: Motor, members: int, paths: list[str], values: npt.ArrayLike | None
    ) -> Self: ...
    def __len__(self) -> int: ...
    def step_many(
        self, current: npt.ArrayLike, dt: float, *, load: npt.ArrayLike | None = None
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
    def run(
        self,
        current: npt.ArrayLike,
        dt: npt.ArrayLike,
        *,
        load: npt.ArrayLike | None,
        outputs: list[str],
        keep: str,
        every: int,
        target: npt.ArrayLike | None,
        threads: int,
    ) -> dict[str, npt.NDArray[np.float64]]: ...

@final
class RowKernel:
    def __new__(
        cls,
        weights: npt.ArrayLike,
        second: npt.ArrayLike,
        every: int,
        inertia: float = 0.0,
        *,
        held: bool = False,
        smooth: bool = False,
    ) -> RowKernel: ...

@final
class Nothing:
    def __new__(cls) -> Nothing: ...
    def step(self, velocity: float, dt: float) -> float: ...
