"""An FMU as an archive: descriptions, sources and, where a C compiler is here, a binary."""

from __future__ import annotations

import io
import platform
import shutil
import subprocess
import zipfile
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from .._support.atomic_files import write_text
from .fmi_description import IDENTIFIER

__all__ = ["Binary", "archive", "binary_of", "compiler"]

PLATFORMS: Final = {
    ("Linux", "x86_64"): ("x86_64-linux", "linux64", "so"),
    ("Linux", "aarch64"): ("aarch64-linux", "aarch64-linux", "so"),
    ("Darwin", "x86_64"): ("x86_64-darwin", "darwin64", "dylib"),
    ("Darwin", "arm64"): ("aarch64-darwin", "aarch64-darwin", "dylib"),
}
"""What FMI 3.0 and 2.0 call a platform, and how its libraries end."""
FLAGS: Final = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden")
NO_TIME: Final = (1980, 1, 1, 0, 0, 0)
"""Of every file, so that one plant gives one archive."""

Binary = tuple[tuple[str, str, str], bytes]
"""The names of a platform and its library."""


def compiler() -> str | None:
    """A C compiler of this computer."""
    return shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


def binary_of(source: str) -> Binary | str:
    """The library of a source for this computer, or why there is none."""
    own = PLATFORMS.get((platform.system(), platform.machine()))
    if own is None:
        return f"none is made on {platform.system()} {platform.machine()}"
    found = compiler()
    if found is None:
        return "there is no C compiler here (cc, gcc or clang)"
    library = _compiled(source, found, own[2])
    return library if isinstance(library, str) else (own, library)


@lru_cache(maxsize=64)
def _compiled(source: str, command: str, ending: str) -> bytes | str:
    with TemporaryDirectory() as folder:
        # Relative names, for a path would be part of the library.
        write_text(Path(folder) / f"{IDENTIFIER}.c", source)
        files = [f"{IDENTIFIER}.c", "-o", f"{IDENTIFIER}.{ending}"]
        done = subprocess.run(
            [command, *FLAGS, *files, "-lm"], capture_output=True, text=True, cwd=folder
        )
        if done.returncode != 0:
            return f"{command} cannot compile it: {done.stderr.strip().splitlines()[-1]}"
        return (Path(folder) / f"{IDENTIFIER}.{ending}").read_bytes()


def archive(files: Mapping[str, str | bytes]) -> bytes:
    """Files as an archive, the same to the bit for the same files."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as into:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, NO_TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            into.writestr(entry, content)
    return made.getvalue()
