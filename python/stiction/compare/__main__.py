"""``python -m stiction.compare docs``: refreshes the pages and figures of the documentation."""

from __future__ import annotations

import sys
from pathlib import Path

from ..errors import InputError
from .document import write
from .run import compare


def main(arguments: list[str]) -> int:
    """Compare all laws and write what came of it into the folder of the documentation."""
    if len(arguments) != 1:
        print("usage: python -m stiction.compare docs", file=sys.stderr)
        return 2
    try:
        written = write(Path(arguments[0]), compare())
    except (InputError, OSError) as error:
        print(f"stiction: {error}", file=sys.stderr)
        return 2
    print("\n".join(str(path) for path in written))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
