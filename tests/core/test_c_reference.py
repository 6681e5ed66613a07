"""The loop in C that the benches compare with does the same work: it breaks away and agrees."""

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import stiction as st

SOURCES = Path(__file__).parents[2] / "benches" / "c"
DT = 1e-4
# Two orders of summation over 20 000 steps and three slides, as a share of the motion.
ROUND_OFF = 1e-12


def efforts(samples):
    """Efforts that ring, creep and now and then break away, as in benches/lib.rs."""
    t = np.arange(samples) * DT
    return 0.45 * np.sin(6.0 * t) + np.where(np.mod(t, 0.3) < 0.02, 0.3, 0.0)


def compiled(name, folder):
    """The loop in C as a function of efforts: positions, velocities and counts."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler")
    library = folder / f"{name}.so"
    direct = ["-DHSIEH_PAN_DIRECT"] if name.endswith("direct") else []
    flags = ["-O3", "-std=c11", "-fno-math-errno", "-fno-trapping-math", "-shared", "-fPIC"]
    source = SOURCES / f"{name.removesuffix('_direct')}.c"
    subprocess.run([compiler, *flags, *direct, source, "-o", library, "-lm"], check=True)
    loop = getattr(ctypes.CDLL(str(library)), name)

    def run(effort):
        x, v = np.empty_like(effort), np.empty_like(effort)
        counted = (ctypes.c_long * 2)()
        pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (effort, x, v)]
        loop(pointers[0], ctypes.c_size_t(len(effort)), pointers[1], pointers[2], counted)
        return x, v, tuple(counted)

    return run


@pytest.fixture(scope="module", params=["hsieh_pan", "hsieh_pan_direct"])
def reference(request, tmp_path_factory):
    """The loop in C of this law."""
    return compiled(request.param, tmp_path_factory.mktemp("c"))


@pytest.mark.parametrize(
    ("law", "stated"),
    [("lugre", {}), ("dahl", {}), ("maxwell_slip", {}), ("coulomb", {"breakaway": 0.5})],
)
def test_the_loops_in_c_of_other_laws_agree_with_the_core(law, stated, tmp_path):
    effort = efforts(20_000)
    x, v, counted = compiled(law, tmp_path)(effort)
    motor = st.Motor(0.0076, friction=st.FrictionModel(law, **stated))
    own = motor.simulate(effort, DT)
    if law == "coulomb":
        assert counted == (motor.statistics["breakaways"], motor.statistics["sticks"])
        assert min(counted) > 1
    assert np.abs(own.position - x).max() <= ROUND_OFF * np.abs(x).max()
    assert np.abs(own.velocity - v).max() <= ROUND_OFF * np.abs(v).max()


@pytest.mark.parametrize("law", ["lugre", "dahl"])
@pytest.mark.parametrize("dt", [DT, 4e-4])
def test_laws_without_modes_do_the_same_in_one_call_and_in_steps(law, dt):
    effort = efforts(4000)
    effort[:50] = 0.0
    for options in ({}, {"viscous": 0.05}):
        whole = st.Motor(0.0076, friction=st.FrictionModel(law, **options))
        single = st.Motor(0.0076, friction=st.FrictionModel(law, **options))
        rows = np.array([single.step(u, dt) for u in effort.tolist()])
        run = whole.simulate(effort, dt)
        assert np.array_equal(run.position, rows[:, 0])
        assert np.array_equal(run.velocity, rows[:, 1])
        assert str(whole.state) == str(single.state)


def test_the_loop_in_c_agrees_with_the_core_and_breaks_away(reference):
    """Round-off apart, with as many slides: what is timed is the same work."""
    effort = efforts(20_000)
    x, v, counted = reference(effort)
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan", breakaway=0.5))
    own = motor.simulate(effort, DT)
    assert np.abs(own.position - x).max() <= ROUND_OFF * np.abs(x).max()
    assert np.abs(own.velocity - v).max() <= ROUND_OFF * np.abs(v).max()
    counts = motor.statistics
    assert counted == (counts["breakaways"], counts["sticks"])
    assert min(counted) > 1


def test_the_short_way_along_a_branch_keeps_to_its_bound(reference):
    """The loop that evaluates every exponential says what the short way loses: below 1e-12."""
    effort = 0.12 * np.sin(6.0 * np.arange(20_000) * DT)
    x, _, counted = reference(effort)
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan", breakaway=0.5))
    own = motor.simulate(effort, DT, outputs=["position"])
    assert counted == (0, 0)
    assert np.abs(own["position"] - x).max() <= 1e-12 * np.abs(x).max()


def test_one_call_and_single_steps_are_the_same_to_the_bit():
    """Steps in a row keep what runs in registers; single steps do not. No bit may show it."""
    effort = efforts(20_000)
    effort[15_000:] += 0.05 * np.random.default_rng(7).standard_normal(5_000)
    for options in ({}, {"hardening_exponent": 1.7, "viscous": 0.05}, {"loading_rate": 5.0}):
        for dt in (DT, 4e-4):
            law = st.FrictionModel("hsieh_pan", breakaway=0.5, **options)
            whole = st.Motor(0.0076, friction=law)
            single = st.Motor(0.0076, friction=law)
            rows = np.array([single.step(u, dt) for u in effort.tolist()])
            run = whole.simulate(effort, dt)
            assert np.array_equal(run.position, rows[:, 0])
            assert np.array_equal(run.velocity, rows[:, 1])
            assert str(whole.state) == str(single.state)
            assert whole.statistics == single.statistics
            assert whole.statistics["breakaways"] > 1
