"""Derivatives through PyTorch: its own check against differences."""

import numpy as np
import pytest

import stiction as st

torch = pytest.importorskip("torch")
from stiction.torch import simulate  # noqa: E402

from .gradient_rigs import DT, RIGS, current, machine, values  # noqa: E402


def double(value):
    return torch.tensor(value, dtype=torch.float64, requires_grad=True)


@pytest.mark.parametrize("law", RIGS)
def test_gradcheck_passes_by_parameters(law):
    own = values(law)
    inputs = torch.tensor(current(60), dtype=torch.float64)

    def run(*tensors):
        return simulate(machine(law), dict(zip(own, tensors, strict=True)), inputs, DT)

    # Of 1 A for 30 ms a machine goes some hundredths of a radian.
    assert torch.autograd.gradcheck(
        run, [double(value) for value in own.values()], eps=1e-7, atol=1e-6, rtol=1e-4
    )


@pytest.mark.parametrize("law", RIGS)
def test_gradcheck_passes_by_input_and_load(law):
    def run(inputs, load):
        return simulate(machine(law), {}, inputs, DT, load=load)[0]

    given = double(np.stack([current(24), 0.8 * current(24)])), double(np.full(24, 0.01))
    assert torch.autograd.gradcheck(run, given, eps=1e-6, atol=1e-8, rtol=1e-4)


def test_gradcheck_passes_by_the_start():
    inputs = torch.tensor(0.2 * current(40), dtype=torch.float64)

    def run(position, velocity, force):
        begun = {"position": position, "velocity": velocity, "force": force}
        return simulate(machine("lugre"), {}, inputs, DT, start=begun)

    given = double([0.4, 0.1]), double(-0.6), double(0.1)
    assert torch.autograd.gradcheck(run, given, eps=1e-7, atol=1e-6, rtol=1e-4)


def test_it_is_the_simulation_of_the_motor():
    position, velocity = simulate(machine("coulomb"), {}, current(), DT)
    run = machine("coulomb").simulate(current(), DT)
    assert position.numpy().tobytes() == run.position.tobytes()
    assert velocity.numpy().tobytes() == run.velocity.tobytes()


def test_batches_go_over_parameters_and_inputs():
    levels = double([0.1, 0.2, 0.3])
    position, _ = simulate(machine("coulomb"), {"friction.coulomb": levels}, current(), DT)
    assert position.shape == (3, 120)
    position.pow(2).sum().backward()
    for k, level in enumerate(levels.tolist()):
        one = double(level)
        simulate(machine("coulomb"), {"friction.coulomb": one}, current(), DT)[0].pow(
            2
        ).sum().backward()
        assert float(levels.grad[k]) == pytest.approx(float(one.grad), rel=1e-12)


def test_refusals_are_sentences():
    with pytest.raises(st.InputError, match="nonsense"):
        simulate(machine("coulomb"), {"nonsense": 1.0}, current(), DT)
    with pytest.raises(st.InputError, match="shapes that do not fit"):
        simulate(machine("coulomb"), {"coulomb": double([0.1, 0.2])}, np.zeros((3, 5)), DT)
    inputs = double(current())
    with pytest.raises(st.InputError, match="velocity has no derivative by input"):
        simulate(machine("coulomb"), {}, inputs, DT)[1].sum().backward()
