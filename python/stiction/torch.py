"""Simulations that PyTorch differentiates, on the processor, by the slopes of the core."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, partial
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

    As ``stiction.jax.simulate``: by parameters and start those of ``Motor.sensitivity``, by input
    and load those of ``Motor.gradient``.

    Parameters
    ----------
    machine : Plant or Motor
        A motor starts from its present state.
    parameters : mapping of str to torch.Tensor of shape () or (batch,), or float
        SI values by path, or by the bare last word where it is unique; every other parameter is the
        machine's.
    current : torch.Tensor, shape (n,) or (batch, n)
        Input of the drive, held over each sample; float64.
    dt : float
        s.
    load : torch.Tensor, shape (n,) or (batch, n), optional
        External effort, N·m or N, positive along +x.
    start : mapping of str to torch.Tensor of shape () or (batch,), or float, optional
        What the run starts from, as for ``stiction.jax.simulate``.

    Returns
    -------
    (torch.Tensor, torch.Tensor), shape (n,) or (batch, n) each
        Position and velocity after each sample, float64, on the processor.

    Raises
    ------
    InputError
        An unknown parameter or start value, one out of bounds, a plant that is no motor, shapes
        that do not fit; PyTorch is missing.
    """
    torch = _torch()
    values = given.mapping(parameters, "simulate: parameters", "values by name")
    begun = given.mapping(start or {}, "simulate: start", "values by name")
    simulation = Simulation(machine, list(values), dt, list(begun))

    def tensor(each: Any) -> Any:
        return torch.as_tensor(each, dtype=torch.float64, device="cpu")

    inputs = tensor(current)
    loads = torch.zeros_like(inputs) if load is None else tensor(load)
    own = [tensor(each) for each in (*values.values(), *begun.values())]
    try:
        batch = torch.broadcast_shapes(
            inputs.shape[:-1], loads.shape[:-1], *(each.shape for each in own)
        )
        rows = [torch.broadcast_to(each, (*batch, inputs.shape[-1])) for each in (inputs, loads)]
        columns = [torch.broadcast_to(each, batch) for each in own]
    except (RuntimeError, IndexError) as error:
        raise InputError(f"simulate: shapes that do not fit: {error}") from None
    vector = torch.stack(columns, -1) if columns else inputs.new_zeros((*batch, 0))
    position, velocity = _function().apply(simulation, vector, *rows)
    return position, velocity


@cache
def _function() -> Any:
    """The simulation as a function of PyTorch, whose class can only be made where that is."""
    torch = _torch()

    class Run(torch.autograd.Function):  # type: ignore[misc, name-defined]
        """Forward by the core, backward by its slopes."""

        @staticmethod
        def forward(ctx: Any, simulation: Simulation, values: Any, current: Any, load: Any) -> Any:
            ctx.simulation = simulation
            ctx.save_for_backward(values, current, load)
            arrays = [each.detach().numpy() for each in (values, current, load)]
            return tuple(map(torch.from_numpy, over_batch(simulation.run, 2, *arrays)))

        @staticmethod
        @torch.autograd.function.once_differentiable  # type: ignore[untyped-decorator]
        def backward(ctx: Any, position: Any, velocity: Any) -> Any:
            arrays = [each.detach().numpy() for each in (*ctx.saved_tensors, position, velocity)]
            by_input = ctx.needs_input_grad[2] or ctx.needs_input_grad[3]
            work = partial(ctx.simulation.backwards, by_input)
            return None, *map(torch.from_numpy, over_batch(work, 3, *arrays))

    return Run


def _torch() -> Any:
    try:
        import torch
    except ImportError:
        raise InputError(
            "stiction.torch: PyTorch is missing; install it: pip install torch"
        ) from None
    return torch
