"""Other ways to decide, on the very columns that the diagnosis screens: what its own way is worth.

Each is a page: `f_test`, `bic`, `l1`, `e_process`. All see what the diagnosis sees of a session
before it decides anything: the fitted base, its residual, and every effect at every point of the
grid of its shapes (`library.py`). Those that go forward refit the plant with what they took in;
none replays noise, doubts or takes back, and that is the difference measured.

    python -m tests.blind.rivals --plant axis4 --number 32 --seed 4 --ours axis4.jsonl
"""
