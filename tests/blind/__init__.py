"""Scores of the diagnosis on sessions of the independent plant, whose hidden truth it never sees.

    python -m tests.blind --number 100 --seed 3 --out blind.jsonl

Not a part of the ordinary tests: a session takes some seconds. `draw` decides what is hidden,
`score` diagnoses and compares, `table` counts.
"""
