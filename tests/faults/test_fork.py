"""A fork beside a thread that simulates: the child can simulate too."""

from __future__ import annotations

import subprocess
import sys

import pytest

PATIENCE_S = 60
PROGRAM = """
import os, sys, threading, time
import numpy as np
import stiction as st

def motor(law):
    return st.Motor(0.0076, friction=st.FrictionModel(law))

busy = motor("hsieh_pan")

def asked(motor):
    try:
        motor.step(0.3, 1e-4)
    except st.InputError:
        pass

def work():
    fleet = st.Ensemble(motor("coulomb"), 64)
    while True:
        busy.simulate(np.full(20000, 0.3), 1e-4)
        fleet.simulate(np.full(2000, 0.3), 1e-4, threads=2)

shared = motor("lugre")
threading.Thread(target=work, daemon=True).start()
time.sleep(0.05)
children = []
for k in range(8):
    child = os.fork()
    if child == 0:
        # Without the interpreter's own way out, which the thread's leftovers would hold up.
        {call}
        os._exit(7)
    children.append(child)
    time.sleep(0.01)
end = time.monotonic() + 20.0
codes = []
for child in children:
    done = 0
    while not done and time.monotonic() < end:
        done, status = os.waitpid(child, os.WNOHANG)
        time.sleep(0.005)
    if not done:
        os.kill(child, 9)
        os.waitpid(child, 0)
        codes.append("never")
    else:
        codes.append(os.waitstatus_to_exitcode(status))
print(codes)
os._exit(0)
"""
CALLS = {
    "a step of a new motor": 'motor("coulomb").step(0.3, 1e-4)',
    "a step of a motor from before": "shared.step(0.3, 1e-4)",
    "a step of the motor that the thread moved": "asked(busy)",
    "a run": 'motor("hsieh_pan").simulate(np.ones(100), 1e-4)',
    "an ensemble on threads": (
        'st.Ensemble(motor("coulomb"), 16).simulate(np.ones(50), 1e-4, threads=2)'
    ),
    "a law alone": 'st.FrictionModel("gms").step(0.1, 1e-4)',
}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="forks are Linux's here")
@pytest.mark.parametrize("name", CALLS)
def test_a_child_of_a_fork_returns_from(name: str) -> None:
    program = PROGRAM.replace("{call}", CALLS[name])
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", program],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert done.stdout.split("\n")[0] == str([7] * 8), done.stdout + done.stderr
