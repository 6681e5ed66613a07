"""The list of verbs."""

from __future__ import annotations

import cyclopts

from .. import __version__
from .bench import bench
from .catalogue import effects, laws
from .compare import compare
from .compensate import compensate
from .demo import demo
from .diagnose import diagnose
from .export import export
from .fit import fit
from .import_ import import_
from .init import init
from .library import library
from .paper import paper
from .plan import plan
from .simulate import simulate
from .watch import watch

__all__ = ["build"]


def build() -> cyclopts.App:
    """The command ``stiction`` with all its verbs."""
    app = cyclopts.App(
        name="stiction",
        help="Simulates machines that stick, creep and slip; shows what a simulation gets wrong.",
        version=f"stiction {__version__}",
        help_format="plaintext",
    )
    for verb in (init, demo, simulate, fit, diagnose, watch, plan, export):
        app.command(verb)
    # A word that Python keeps for itself.
    app.command(import_, name="import")
    for other in (compensate, library, laws, effects, compare, paper):
        app.command(other)
    app.command(bench)
    return app
