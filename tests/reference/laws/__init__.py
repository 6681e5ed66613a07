"""One oracle a law: written from its source, in another representation than the core's.

A module is called as its law. It holds `along(velocity, dt, **parameters)`, friction at the end of
each sample of a piecewise held velocity, and `GOLDEN`, what its golden file is made with.
"""
