"""Ordinary sessions: what anybody records, from a machine that shares nothing with the core.

`machine` simulates a body that sticks, slips and swings with classic Runge-Kutta steps whose ends
are the events themselves (a reversal, a break-away), `hidden` is what may be hidden in it,
`signals` what it is driven by, `draw` decides what a session holds, and `files` writes it as a user
would have it. Of the package nothing is imported but how a file is written whole, and nothing is
taken from `tests/reference`: what judges the diagnosis must not share its mistakes.
"""
