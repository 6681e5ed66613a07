"""Writing what is generated, and only where it changed: Sphinx reads again what is newer."""

from __future__ import annotations

import shutil
from pathlib import Path

__all__ = ["copied", "written"]


def written(path: Path, text: str) -> Path:
    """Writes a file unless it holds this text already; makes its folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text("utf-8") != text:
        path.write_text(text, encoding="utf-8")
    return path


def copied(source: Path, target: Path) -> Path:
    """Copies a file with its time unless the copy is as new; makes its folder."""
    target.parent.mkdir(parents=True, exist_ok=True)
    if not target.exists() or target.stat().st_mtime != source.stat().st_mtime:
        shutil.copy2(source, target)
    return target
