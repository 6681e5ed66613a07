"""ULog, the logs of PX4: a group of columns a topic, its fields under dotted names.

Read through `pyulog`, an optional extra.
"""

from __future__ import annotations

from contextlib import redirect_stdout
from importlib import import_module
from io import StringIO
from pathlib import Path
from typing import Any, Final

import numpy as np

from ...errors import InputError
from ..gathered import Gathered, damage_error, missing_package
from ..table import Table
from .format import Format

_SIGNATURE: Final = b"ULog\x01\x12\x35"
_CLOCK: Final = "timestamp"


def read(path: Path) -> Table:
    """Read a ULog file (see the module's text)."""
    with path.open("rb") as file:
        start = file.read(len(_SIGNATURE))
    if start != _SIGNATURE:
        raise InputError(
            f"{path}: this is not a ULog file (it does not start with ULog); correct the file's "
            "ending"
        )
    try:
        pyulog: Any = import_module("pyulog")
    except ImportError as error:
        raise missing_package(path, "ULog", "pyulog", "ulog", error) from error
    found = Gathered(path)
    # Nothing in it is packed: as numbers an eighth of a byte each would be eight times as much.
    found.room("its topics", path.stat().st_size)
    try:
        # It prints what it stumbles over.
        with path.open("rb") as file, redirect_stdout(StringIO()):
            log = pyulog.ULog(file, disable_str_exceptions=True)
        if log.file_corruption:
            raise ValueError("a part of it is damaged")
        for each in log.data_list:
            group = each.name if each.multi_id == 0 else f"{each.name}_{each.multi_id}"
            signals = {
                name: np.asarray(values, dtype=np.float64)
                for name, values in each.data.items()
                if name != _CLOCK
            }
            found.whole(group, 1e-6 * np.asarray(each.data[_CLOCK], dtype=np.float64), signals)
    except Exception as error:
        raise damage_error(path, "ULog", error) from error
    return found.table("topic")


FORMAT = Format("ULog", (".ulg", ".ulog"), read)
