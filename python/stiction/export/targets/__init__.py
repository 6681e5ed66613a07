"""One module a target: ``SUMMARY``, and ``write(plant, speed)`` that returns an ``Export``."""
