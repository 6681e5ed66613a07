"""A fuzzer of everything public: calls, files and the command, judged by rules that always hold.

A case is a short program in Python's own words, drawn from a seed that is its name. ``python -m
tests.fuzz`` runs cases for as long as it is told, ``python -m tests.fuzz --case NAME`` one of them
again, and what was found once is kept in ``corpus`` and run by the ordinary tests.
"""
