"""Drafts: what recordings tell of a machine, as the files that a user goes on with."""

from __future__ import annotations

from .assumed import assumptions
from .draft import FILES, Draft, draft
from .tables import recordings_in

__all__ = ["FILES", "Draft", "assumptions", "draft", "recordings_in"]
