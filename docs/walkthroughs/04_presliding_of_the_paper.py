"""
Pre-sliding, as in the paper
============================

Before it slides, a contact yields with hysteresis and non-local memory, creeps under a held load
and hardens. C. Hsieh and Y.-C. Pan (Wear 242, 2000) separate these properties by experiments,
which are simulated here; each is a function of ``stiction.paper``. All of them are on :doc:`the
page of the paper's figures </gallery/paper>`.
"""

from stiction import paper

# %%
# Loops within loops: each closes where it began, and is then forgotten.

nested = paper.nested_loops()
print(nested)
loops = nested.plot()

# %%
# Static test 1: a torque in steps. Under each held torque the rotor creeps on, less each time.

stepped = paper.static_test(1)
print(stepped)
creep = stepped.plot()

# %%
# Beyond the paper: pulled slowly through a spring the rotor sticks and slips.

pulled = paper.stick_slip()
print(pulled)
stick_and_slip = pulled.plot()
