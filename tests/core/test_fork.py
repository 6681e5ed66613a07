"""A child of a process whose other threads were at work is answered."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="there are no forks here")

# The parent simulates in another thread while it forks; a child that hangs is ended by its alarm.
FORKED = """
import os, signal, sys, threading, time, warnings
import numpy as np
import stiction as st

warnings.simplefilter("ignore", DeprecationWarning)  # of forks beside threads: that is the point
busy = st.{made}
idle = st.Motor(0.0076, friction=st.FrictionModel("coulomb"))
rows = np.full({number}, 0.1)
# What is imported late is imported now: a fork in the midst of an import is Python's own matter.
busy.simulate(rows[:2], 1e-4)
st.simulate_ensemble(idle, rows[:2], 1e-4)
started, over = threading.Event(), threading.Event()

def work():
    while not over.is_set():
        started.set()
        busy.simulate(rows, 1e-4)

thread = threading.Thread(target=work)
thread.start()
started.wait()
time.sleep(0.02)
child = os.fork()
if child == 0:
    signal.alarm(20)
    idle.step(0.1, 1e-3)
    idle.copy().simulate([0.1] * 10, 1e-3)
    st.simulate_ensemble(idle, np.full((4, 10), 0.1), 1e-3, threads=2)
    try:
        busy.{call}
    except st.InputError as told:
        os._exit(3 if "forked" in str(told) and "copy" in str(told) else 4)
    os._exit(0)
_, status = os.waitpid(child, 0)
over.set()
thread.join()
busy.{call}
sys.exit(99 if os.WIFSIGNALED(status) else os.WEXITSTATUS(status))
"""
MADE = {
    "a motor": (
        "Motor(0.0076, friction=st.FrictionModel('hsieh_pan'))",
        "step(0.1, 1e-3)",
        1_000_000,
    ),
    "a contact": ("FrictionModel('hsieh_pan')", "step(0.1, 1e-3)", 1_000_000),
    "an ensemble": (
        "Ensemble(st.Motor(0.0076, friction=st.FrictionModel('leuven')), 8)",
        "step_many(0.1, 1e-3)",
        50_000,
    ),
}


@pytest.mark.parametrize("kind", sorted(MADE))
def test_a_child_of_a_fork_beside_a_simulating_thread_is_answered(kind: str) -> None:
    made, call, number = MADE[kind]
    program = FORKED.format(made=made, call=call, number=number)
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=120)
    assert ended.returncode != 99, "the child hangs"
    # 3: it was at work, and the child is told; 0: it was between two runs, and goes on.
    assert ended.returncode in (0, 3), ended.stderr.decode()
