"""One module a target: ``SUMMARY``, and ``write(plant, speed)`` that returns an ``Export``.

A target that can be run has ``runs(export, plant)`` too: see ``stiction.export.runs``.
"""
