"""``python -m docs.site [-o FOLDER]``: builds the site and checks it."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from .check import complaints
from .excerpts import write_excerpts
from .stage import stage

HERE = Path(__file__).parent


def main() -> int:
    """Lays out, builds, checks; 1 where something is wrong with the site."""
    reader = argparse.ArgumentParser(prog="python -m docs.site", description=__doc__)
    reader.add_argument("-o", "--out", type=Path, default=Path("target/site"))
    out = reader.parse_args().out.resolve()
    try:
        from sphinx.cmd.build import build_main
    except ImportError:
        print("the site needs Sphinx: pip install 'stiction[docs]'", file=sys.stderr)
        return 2
    os.environ.setdefault("MPLBACKEND", "Agg")
    source = stage(out / "source")
    site = out / "html"
    words = ["-q", "-W", "--keep-going", "-b", "html", "-c", str(HERE), "-d", str(out / "doctrees")]
    failed = build_main([*words, str(source), str(site)])
    write_excerpts(site)
    wrong = complaints(site)
    for each in wrong:
        print(each, file=sys.stderr)
    if failed or wrong:
        return 1
    print(f"the site is in {site}/index.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
