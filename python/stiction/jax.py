"""Simulations that JAX differentiates, on the processor: slopes of the core, which are exact."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from ._support import given
from .errors import InputError
from .gradients import Simulation, over_batch
from .motor import Motor
from .plant import Plant

__all__ = ["simulate"]


def simulate(
    machine: Plant | Motor,
    parameters: Mapping[str, Any],
    current: Any,
    dt: float,
    *,
    load: Any = None,
    start: Mapping[str, Any] | None = None,
) -> tuple[Any, Any]:
    """Simulate held inputs from the state of a machine, with exact derivatives.

    Position and velocity are those of ``Motor.simulate``. Backwards, derivatives by the parameters
    and by the start are those of ``Motor.sensitivity``, by input and load those of
    ``Motor.gradient``, breaking away and sticking included. It goes through ``jit``, ``grad`` and
    ``vmap`` (over parameters, start, inputs and loads), and not through ``jvp`` or a second
    derivative.

    Parameters
    ----------
    machine : Plant or Motor
        A motor starts from its present state.
    parameters : mapping of str to array_like of shape ()
        SI values by path, or by the bare last word where it is unique; every other parameter is the
        machine's.
    current : array_like, shape (n,)
        Input of the drive, of a servo its goal, held over each sample.
    dt : float
        s.
    load : array_like, shape (n,), optional
        External effort, N·m or N, positive along +x.
    start : mapping of str to array_like of shape (), optional
        What the run starts from in place of the state of the machine: ``position`` and
        ``velocity``, and what the contact brings along, such as ``force`` (``st.laws()`` lists the
        start values of each law); a contact of which one is given has the others at 0.

    Returns
    -------
    (jax.Array, jax.Array), shape (n,) each
        Position and velocity after each sample.

    Raises
    ------
    InputError
        An unknown parameter or start value, a plant that is no motor; JAX is missing, or counts in
        single precision; values out of bounds. Inside a compiled function the last come as errors
        of JAX that hold the sentence.

    Notes
    -----
    Derivatives by the input cost a run over dual numbers for every eight samples, and as many by
    the load; where both are constants none is computed.
    """
    jax = _jax()
    values = given.mapping(parameters, "simulate: parameters", "values by name")
    begun = given.mapping(start or {}, "simulate: start", "values by name")
    simulation = Simulation(machine, list(values), dt, list(begun))
    numbers = [*values.values(), *begun.values()]
    vector = jax.numpy.asarray([jax.numpy.asarray(each, dtype=float) for each in numbers])
    inputs = jax.numpy.asarray(current, dtype=float)
    loads = jax.numpy.zeros_like(inputs) if load is None else jax.numpy.asarray(load, dtype=float)
    if inputs.ndim != 1 or loads.shape != inputs.shape:
        raise InputError(
            f"simulate: current and load have shapes {inputs.shape} and {loads.shape}; give (n,) "
            "each, and go over batches with jax.vmap"
        )
    try:
        position, velocity = jax.block_until_ready(
            _differentiable(jax, simulation)(vector.reshape(len(numbers)), inputs, loads)
        )
    except jax.errors.JaxRuntimeError as error:
        raise _refusal(error) from None
    return position, velocity


def _differentiable(jax: Any, simulation: Simulation) -> Any:
    """The simulation as a function of JAX with a derivative of its own."""

    @jax.custom_vjp  # type: ignore[untyped-decorator]
    def run(values: Any, current: Any, load: Any) -> Any:
        shape = jax.ShapeDtypeStruct(current.shape, current.dtype)
        work = partial(over_batch, simulation.run, 2)
        return jax.pure_callback(
            work, (shape, shape), values, current, load, vmap_method="broadcast_all"
        )

    def forward(values: Any, current: Any, load: Any) -> Any:
        plain = [each.value for each in (values, current, load)]
        # An empty tuple is there, and no number that a compiled function would not know.
        by_input = () if current.perturbed or load.perturbed else None
        return run(*plain), (*plain, by_input)

    def backward(kept: Any, weights: Any) -> Any:
        values, current, load, by_input = kept
        shapes = [jax.ShapeDtypeStruct(each.shape, each.dtype) for each in (values, current, load)]
        velocity = _given(jax, weights[1], current)
        work = partial(over_batch, partial(simulation.backwards, by_input is not None), 3)
        return jax.pure_callback(
            work,
            tuple(shapes),
            values,
            current,
            load,
            _given(jax, weights[0], current),
            velocity,
            vmap_method="broadcast_all",
        )

    run.defvjp(forward, backward, symbolic_zeros=True)
    return run


def _given(jax: Any, weight: Any, like: Any) -> Any:
    """Weights of an output, zeros where nobody asks for it."""
    symbolic = jax.custom_derivatives.SymbolicZero
    return jax.numpy.zeros_like(like) if isinstance(weight, symbolic) else weight


def _refusal(error: Exception) -> Exception:
    """The sentence of a refusal, which JAX wraps in two stacks of calls; else the error."""
    _, found, sentence = str(error).rpartition(f"{InputError.__name__}: ")
    return InputError(sentence.strip().splitlines()[0]) if found else error


def _jax() -> Any:
    try:
        import jax
    except ImportError:
        raise InputError("stiction.jax: JAX is missing; install it: pip install jax") from None
    config: Any = jax.config
    if not config.jax_enable_x64:
        raise InputError(
            "stiction.jax: JAX counts in single precision, in which a machine that creeps stands "
            'still; call jax.config.update("jax_enable_x64", True) first'
        )
    return jax
