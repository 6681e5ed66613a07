"""Parameters in the format of `better-actuator-models` (BAM), both ways.

M. Duclusaud, G. Passault, V. Padois, O. Ly, "Extended friction models for the physics simulation of
servo actuators", ICRA 2025, arXiv:2410.08650; the format is that of its package, 1.0.2.
"""

from __future__ import annotations

from .reader import BamReading, read_bam

__all__ = ["BamReading", "read_bam"]
