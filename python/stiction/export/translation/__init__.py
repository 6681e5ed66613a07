"""The C of a plant as Rust, and over dual numbers: the same statements, read and written anew.

The C that fragments make is a small part of the language, and typed strictly; what is beyond that
part is refused where a fragment is translated, which the tests do with all of them.
"""

from __future__ import annotations

from .dual import call_graph, dual_of
from .parser import parse
from .rust import rust_of
from .tokens import TranslationError

__all__ = ["TranslationError", "call_graph", "dual_of", "parse", "rust_of"]
