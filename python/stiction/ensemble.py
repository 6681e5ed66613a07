"""Many machines of one kind side by side."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from typing import Any, Final, Literal

import numpy as np
import numpy.typing as npt

from ._native import Ensemble as _Ensemble
from ._support import given
from ._support.arrays import FloatArray
from ._support.frozen import Frozen, freeze, path_of
from ._support.keys import choice
from ._support.keywords import explain_keywords
from ._support.wording import commas
from .errors import InputError, UnknownName
from .motor import Motor

__all__ = ["Ensemble", "EnsembleRun", "Reduce", "simulate_ensemble"]

Reduce = Literal["last", "rms", "extremes"]
"""What is kept instead of rows: the value at the end, the root mean square of the distance from a
target, or the least and the greatest value."""
MEMBER_SIZE: Final = 6144.0
"""Bytes that a machine with a large state takes while it is set up; measured."""
MOST_THREADS: Final = 256
"""What the core takes."""
_REDUCTIONS = ("last", "rms", "extremes")


@dataclass(frozen=True, eq=False, repr=False)
class EnsembleRun:
    """What a run of many machines kept; read the outputs as attributes or by name.

    Attributes
    ----------
    columns : Mapping of str to numpy.ndarray
        Shape (members, rows); reduced: (members,), and (members, 2) for "extremes".
    time : numpy.ndarray, shape (rows,)
        End of each sample that was kept, s since the run began; empty where rows were reduced.
    reduce : {"last", "rms", "extremes"} or None
        What was kept instead of rows: the value at the end, the root mean square of the distance
        from a target, or the least and the greatest value.
    """

    columns: Mapping[str, FloatArray]
    time: FloatArray
    reduce: str | None = None

    def __post_init__(self) -> None:
        freeze(self, Frozen, "columns")

    @property
    def success(self) -> bool:
        """Whether every value that was kept is finite."""
        return all(bool(np.isfinite(values).all()) for values in self.columns.values())

    @property
    def message(self) -> str:
        """What happened, in words."""
        if self.success:
            return f"{len(self)} machines ran to the end"
        bad = {
            int(k)
            for values in self.columns.values()
            for k in np.flatnonzero(~np.isfinite(values.reshape(len(values), -1)).all(axis=1))
        }
        first = ", ".join(str(k) for k in sorted(bad)[:5])
        return f"{len(bad)} of {len(self)} machines ran away (first: {first}); check their values"

    def __repr__(self) -> str:
        shown = ", ".join(f"{name} {values.shape}" for name, values in self.columns.items())
        kept = f", reduced to {self.reduce}" if self.reduce else ""
        return f"<{len(self)} machines: {shown}{kept}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{escape(name)}</th><td>{values.shape}</td><td>{values.min():.6g}</td>"
            f"<td>{values.max():.6g}</td></tr>"
            for name, values in self.columns.items()
            if values.size
        )
        head = "<tr><th>output</th><th>shape</th><th>least</th><th>greatest</th></tr>"
        return (
            f"<p>{escape(repr(self))}</p><p>{escape(self.message)}</p><table>{head}{rows}</table>"
        )

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()))) if self.columns else 0

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __getitem__(self, name: str) -> FloatArray:
        """The rows of an output, or what they were reduced to.

        Raises
        ------
        UnknownName
            An ``InputError`` and a ``KeyError``: the run kept no such output.
        """
        try:
            return self.columns[name]
        except KeyError:
            have = ", ".join(self.columns)
            raise UnknownName(f"the run kept no '{name}'; it has {have}") from None

    def __getattr__(self, name: str) -> FloatArray:
        columns = self.__dict__.get("columns", {})
        if name in columns:
            found: FloatArray = columns[name]
            return found
        raise AttributeError(f"the run kept no '{name}'; it has {', '.join(columns)}")


class Ensemble(_Ensemble):
    """Copies of a motor, each with parameters and a state of its own.

    Parameters
    ----------
    motor : Motor
        All start from its present state.
    members : int, optional
        How many; as many as there are values without it.
    parameters : Mapping of str to array_like of shape (members,), optional
        SI values by path (``friction.creep_rate``) or by the bare last word where that is unique.
        Every other parameter is the motor's, also where its default would follow one of these.

    Raises
    ------
    InputError
        No motor, values that are not as many as the members or out of their bounds, more machines
        than there is memory for.
    UnknownName
        An ``InputError`` and a ``KeyError``: the motor has no such parameter, or several.

    Examples
    --------
    >>> import stiction as st
    >>> motor = st.Motor(0.0076, friction=st.FrictionModel("coulomb", coulomb=0.1))
    >>> fleet = st.Ensemble(motor, parameters={"coulomb": [0.05, 0.1, 0.3]})
    >>> position, velocity = fleet.step_many([0.2, 0.2, 0.2], 1e-3)
    >>> [bool(v > 0.0) for v in velocity]
    [True, True, False]
    """

    _law: str
    _varied: dict[str, tuple[float, float]]

    def __new__(
        cls,
        motor: Motor,
        members: int | None = None,
        *,
        parameters: Mapping[str, npt.ArrayLike] | None = None,
    ) -> Ensemble:
        """See the class."""
        given.instance(motor, Motor, "ensemble: motor", "a Motor")
        if members is not None:
            members = given.whole(members, "members", least=1, most=given.MOST_WHOLE)
        rows = _rows_by_path(motor, parameters, members)
        sizes = {len(row) for row in rows.values()}
        if members is None and len(sizes) != 1:
            raise InputError(
                "members is missing; give how many there are, or parameters of one length each"
                if not sizes
                else f"parameters have {commas([str(n) for n in sorted(sizes)])} values; give all "
                "of them one value a member"
            )
        count = members if members is not None else sizes.pop()
        given.memory_for(float(count) * MEMBER_SIZE, f"{count} machines; give fewer at a time")
        table = np.concatenate(list(rows.values())) if rows else None
        made = super().__new__(cls, motor, count, list(rows), table)
        made._law = motor.friction.law
        made._varied = {path: (float(row.min()), float(row.max())) for path, row in rows.items()}
        return made

    def __repr__(self) -> str:
        varied = [f"{path} {low:.6g} to {high:.6g}" for path, (low, high) in self._varied.items()]
        return f"<{'; '.join([f'{len(self)} machines with {self._law}', *varied])}>"

    def _repr_html_(self) -> str:
        from .notebook import table

        rows = [(path, f"{low:.6g}", f"{high:.6g}") for path, (low, high) in self._varied.items()]
        told = f"<p>{len(self)} machines with {escape(self._law)}</p>"
        return told + (table(("varied", "least", "greatest"), rows) if rows else "")

    @explain_keywords
    def simulate(
        self,
        current: npt.ArrayLike,
        dt: npt.ArrayLike,
        *,
        load: npt.ArrayLike | None = None,
        outputs: Sequence[str] = ("position",),
        every: int = 1,
        reduce: Reduce | None = None,
        target: npt.ArrayLike | None = None,
        threads: int | None = None,
    ) -> EnsembleRun:
        """Run all machines on from where they are.

        Parameters
        ----------
        current : array_like, shape (n,) or (members, n)
            Input held over each sample, as in ``Motor.simulate``.
        dt : float or array_like of shape (n,)
            Duration of a sample in s, or of each.
        load : float or array_like of shape (n,) or (members, n), optional
            External effort, N·m or N, positive along +x; 0 without it.
        outputs : sequence of str
            Columns of a ``Trajectory``.
        every : int
            Keep every so many samples one row: the state after sample ``every``, 2·``every`` …
        reduce : {"last", "rms", "extremes"}, optional
            Keep no rows; see ``EnsembleRun``.
        target : float or array_like of shape (n,) or (members, n), optional
            What "rms" is the distance from, in the unit of the outputs; 0 without it.
        threads : int, optional
            1 to 256; as many as there are processors without it. Results do not depend on it.

        Returns
        -------
        EnsembleRun

        Raises
        ------
        InputError
            Shapes that do not fit, values that are not finite or masked, an unknown output,
            reduction or number of threads, ``every`` or ``target`` where they mean nothing, a
            ``dt`` that is not above 0 and at most 1e6 s or too long for one of the machines, more
            inner steps than 1000 a sample of a machine in the mean after the first 10 million,
            more rows than there is memory for.
        """
        if reduce is not None:
            choice(reduce, _REDUCTIONS, "reduce")
        names = given.names(outputs, "outputs")
        every = given.whole(every, "every", least=1, most=given.MOST_WHOLE)
        if threads is None:
            threads = min(os.cpu_count() or 1, MOST_THREADS)
        threads = given.whole(threads, "threads", least=1)
        if reduce is not None and every != 1:
            raise InputError("every goes with rows, and reduce keeps none; give one of them")
        if target is not None and reduce != "rms":
            raise InputError('target goes with reduce="rms"; leave it out')
        samples = given.numbers(current, "current").shape[-1:] or (0,)
        if reduce is None:
            kept = (2.0 * len(names) + 1.0) * len(self) * (samples[0] // every)
            given.memory_for(
                8.0 * kept,
                f"the rows of {len(self)} machines; keep fewer by every, reduce or outputs",
            )
        flat = self.run(
            current,
            dt,
            load=load,
            outputs=names,
            keep=reduce or "every",
            every=every,
            target=target,
            threads=threads,
        )
        members = len(self)
        columns = {}
        for name, values in flat.items():
            rows = values.reshape(members, -1)
            columns[name] = rows[:, 0] if reduce in ("last", "rms") else rows
        time: FloatArray = np.empty(0)
        if reduce is None:
            steps = np.broadcast_to(np.asarray(dt, dtype=np.float64), samples)
            time = np.cumsum(steps)[every - 1 :: every]
            if np.ndim(dt) == 0:
                time = np.arange(1.0, len(time) + 1.0) * (float(np.asarray(dt)) * every)
        return EnsembleRun(columns, time, reduce)


@explain_keywords
def simulate_ensemble(
    motor: Motor,
    currents: npt.ArrayLike,
    dt: npt.ArrayLike,
    *,
    parameters: Mapping[str, npt.ArrayLike] | None = None,
    load: npt.ArrayLike | None = None,
    outputs: Sequence[str] = ("position",),
    every: int = 1,
    reduce: Reduce | None = None,
    target: npt.ArrayLike | None = None,
    threads: int | None = None,
    executor: Executor | None = None,
    parts: int | None = None,
) -> EnsembleRun:
    """Simulate many machines at once, from the present state of a motor.

    Parameters
    ----------
    motor : Motor
        Left as it is.
    currents : array_like, shape (members, n) or (n,)
        Inputs of each machine, or the same for all.
    parameters : Mapping of str to array_like of shape (members,), optional
        What the machines differ in, as for ``Ensemble``.
    dt, load, outputs, every, reduce, target, threads
        As for ``Ensemble.simulate``; no ``threads`` with an executor, whose parts take one each.
    executor : concurrent.futures.Executor, optional
        Runs parts of the ensemble: a pool of processes, or a cluster's. The result is the same to
        the bit.
    parts : int, optional
        Into how many parts an executor's work is cut; four for each processor of this machine
        without it.

    Returns
    -------
    EnsembleRun

    Raises
    ------
    InputError
        As for ``Ensemble`` and ``Ensemble.simulate``; an executor that is none, ``parts`` below 1
        or without an executor, ``threads`` with one.

    Examples
    --------
    >>> import numpy as np, stiction as st
    >>> motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan"))
    >>> rates = np.linspace(0.5, 4.0, 8)
    >>> effort = np.full(2000, 0.2)
    >>> run = st.simulate_ensemble(
    ...     motor, effort, 1e-4, parameters={"creep_rate": rates}, reduce="last"
    ... )
    >>> run.position.shape
    (8,)
    """
    given.instance(motor, Motor, "simulate_ensemble: motor", "a Motor")
    if executor is not None and not callable(getattr(executor, "submit", None)):
        given.instance(executor, Executor, "executor", "one of concurrent.futures, or none")
    if parts is not None:
        parts = given.whole(parts, "parts", least=1)
        if executor is None:
            raise InputError(
                f"parts = {parts} is for an executor, and there is none; give one, or leave parts "
                "out"
            )
    if threads is not None:
        threads = given.whole(threads, "threads", least=1, most=MOST_THREADS)
        if executor is not None:
            raise InputError(
                f"threads = {threads} is for work in this process, and the parts of an executor "
                "take one thread each; leave threads out, and give parts"
            )
    inputs = given.numbers(currents, "currents")
    if inputs.ndim == 0:
        raise InputError(
            f"currents = {float(inputs)} is a single number; give an array of shape (n,) or "
            "(members, n)"
        )
    values = _rows_by_path(motor, parameters, len(inputs) if inputs.ndim == 2 else None)
    sizes = {len(row) for row in values.values()} | ({len(inputs)} if inputs.ndim == 2 else set())
    if len(sizes) > 1:
        raise InputError(
            f"parameters and currents are for {commas([str(n) for n in sorted(sizes)])} machines; "
            "give all of them one row or value a machine"
        )
    members = sizes.pop() if sizes else 1
    names = given.names(outputs, "outputs")
    keywords: dict[str, Any] = {"outputs": tuple(names), "every": every, "reduce": reduce}
    if executor is None:
        ensemble = Ensemble(motor, members, parameters=values)
        return ensemble.simulate(inputs, dt, load=load, target=target, threads=threads, **keywords)
    cuts = np.linspace(0, members, min(members, parts or 4 * (os.cpu_count() or 1)) + 1)
    edges = [round(cut) for cut in cuts]
    jobs = [
        executor.submit(
            _part,
            motor,
            high - low,
            {name: row[low:high] for name, row in values.items()},
            _rows(inputs, low, high),
            dt,
            {**keywords, "load": _rows(load, low, high), "target": _rows(target, low, high)},
        )
        for low, high in pairwise(edges)
    ]
    found = [job.result() for job in jobs]
    columns = {
        name: np.concatenate([run.columns[name] for run in found]) for name in found[0].columns
    }
    return EnsembleRun(columns, found[0].time, reduce)


@dataclass(frozen=True)
class _Part:
    """What a worker sends back."""

    columns: dict[str, FloatArray]
    time: FloatArray


def _part(
    motor: Motor,
    members: int,
    parameters: dict[str, FloatArray],
    currents: FloatArray,
    dt: npt.ArrayLike,
    keywords: dict[str, Any],
) -> _Part:
    """Some of the machines, on one thread: an executor has its own idea of how many there are."""
    run = Ensemble(motor, members, parameters=parameters).simulate(
        currents, dt, threads=1, **keywords
    )
    return _Part(dict(run.columns), run.time)


def _rows(given: npt.ArrayLike | None, low: int, high: int) -> Any:
    """The rows of some machines where there is one for each, all of it otherwise."""
    if given is None or np.ndim(given) < 2:
        return given
    return np.asarray(given)[low:high]


def _rows_by_path(
    motor: Motor, parameters: Mapping[str, npt.ArrayLike] | None, members: int | None
) -> dict[str, FloatArray]:
    """Values of each parameter by its whole path."""
    stated = given.mapping(
        parameters, "parameters", 'values by name, as in {"coulomb": [1.0, 2.0]}'
    )
    rows: dict[str, FloatArray] = {}
    for name, values in stated.items():
        path = path_of(name, motor.parameters, "parameters: ")
        if path in rows:
            raise InputError(f"parameters: '{path}' is named twice; drop one of its names")
        rows[path] = _row(name, values, members)
    return rows


def _row(name: str, values: npt.ArrayLike, members: int | None) -> FloatArray:
    """Values of one parameter, one a machine."""
    row = given.numbers(values, f"parameters['{name}']")
    if row.ndim == 0 and members is not None:
        row = np.full(members, float(row))
    if row.ndim != 1 or (members is not None and len(row) != members):
        wanted = "(members,)" if members is None else f"({members},)"
        raise InputError(f"parameters['{name}'] has shape {row.shape}; give {wanted}")
    bad = np.flatnonzero(~np.isfinite(row))
    if len(bad):
        raise InputError(
            f"parameters['{name}'][{bad[0]}] = {row[bad[0]]} is not a finite number; give a finite "
            "one"
        )
    return row
