"""
A first diagnosis
=================

Recordings of a motor, a model that lacks an effect, and which one it lacks. The package ships
recordings of a simulated motor in which one effect is hidden. ``stiction demo`` diagnoses them on
the command line; this does it in Python.
"""

import stiction as st
from stiction import demo_session

session = demo_session.load()
seconds = sum(recording.time[-1] for recording in session)
print(f"{len(session)} recordings, {seconds:.0f} s")
print(f"the plant states the law {session.plant.friction.law}")

# %%
# The session as it was recorded: what drove the motor, and where it was.

recorded = session.plot()

# %%
# The diagnosis. It makes surrogates, sessions in which nothing is hidden, to learn what noise alone
# does; fewer than usual are quicker and rougher, and enough here.

found = st.diagnose(None, session, surrogates=8, seed=0)
print(found.sentence)

# %%
# The gain is measured on recordings on which nothing was fitted and nothing decided.

low, high = found.gain.ci95
print(f"gain held out: {found.gain.value:.3f}, 95 % interval {low:.3f} to {high:.3f}")
for cause in found.effects:
    print(cause.what)

# %%
# Before and after on a recording that was held out. ``found.save("folder")`` writes the whole
# report, and the plant with the effect in it.

before_and_after = found.plot()
