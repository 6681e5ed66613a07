"""The file formats that recordings are read from.

A new format is one file with a ``FORMAT`` in it and one line in ``FORMATS``.
"""

from __future__ import annotations

import os
from pathlib import Path

from ..._support.given import path as file_path
from ..._support.given import regular
from ..._support.wording import nearest_file
from ...errors import InputError
from ..row_count import complete
from ..stamps import one_clock
from ..table import Table
from . import delimited, hdf, json_records, lvm, mat, mcap, mdf, npz, parquet, rosbag, tdms, ulog
from .format import Format

__all__ = ["FORMATS", "Format", "read_table"]

FORMATS: tuple[Format, ...] = (
    delimited.FORMAT,
    lvm.FORMAT,
    mat.FORMAT,
    npz.FORMAT,
    json_records.FORMAT,
    parquet.FORMAT,
    parquet.ARROW,
    hdf.FORMAT,
    mcap.FORMAT,
    rosbag.FORMAT,
    ulog.FORMAT,
    tdms.FORMAT,
    mdf.FORMAT,
)


def read_table(path: str | os.PathLike[str]) -> Table:
    """Read every column of a file, without units or meaning.

    Parameters
    ----------
    path : str or path-like
        The file; its ending chooses the format.

    Returns
    -------
    Table

    Raises
    ------
    InputError
        No path; if the file is missing, empty, a folder, of an unknown kind, or not what its ending
        says; if it says how many rows it has, and has others.
    """
    file = file_path(path, "read_table")
    # Asking for a file of an overlong name fails as reading one does.
    try:
        if file.is_dir():
            raise InputError(f"{file}: this is a folder; name a file in it")
        if not file.exists():
            raise InputError(f"{file}: there is no such file{_near_by(file)}")
        chosen = _format_of(file)
        before = regular(file)
        if before.st_size == 0:
            raise InputError(f"{file}: the file is empty; record it again or name another")
        table = chosen.read(file)
        after = file.stat()
    except OSError as error:
        reason = error.strerror or "the system refuses"
        raise InputError(
            f"{file}: the file cannot be read ({reason}); check the path, its rights and the disk"
        ) from error
    except MemoryError as error:
        raise InputError(
            f"{file}: there is not enough memory to read the file; leave out columns that are not "
            "needed, or split it"
        ) from error
    if (after.st_size, after.st_mtime_ns) != (before.st_size, before.st_mtime_ns):
        raise InputError(
            f"{file}: the file changed while it was read; wait until it is complete, or copy it"
        )
    return one_clock(complete(table))


def _format_of(file: Path) -> Format:
    suffix = file.suffix.casefold()
    for known in FORMATS:
        if suffix in known.suffixes:
            return known
    kinds = "; ".join(f"{known.name} ({' '.join(known.suffixes)})" for known in FORMATS)
    if suffix == ".toml":
        raise InputError(
            f"{file}: is a TOML file, as plants and sessions are, and a recording is wanted here; "
            f"the kinds read here are {kinds}"
        )
    given = f"the ending '{file.suffix}' is not known" if suffix else "the file has no ending"
    raise InputError(f"{file}: {given}; the kinds read here are {kinds}")


def _near_by(file: Path) -> str:
    if file.parts[0] in ("http:", "https:"):
        return ": it is an address; download the file and name the copy"
    folder = file.parent
    if not folder.is_dir():
        return f", and no folder '{folder}'; check the path"
    try:
        near = nearest_file(file.name, (entry.name for entry in folder.iterdir()))
    except OSError:  # a folder that may not be listed
        near = None
    return f" (did you mean '{near}'?)" if near else "; check the path"
