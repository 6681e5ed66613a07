"""The report of a diagnosis: one page that opens anywhere, and the files beside it.

A section is a builder in ``sections`` and a template of the same name in ``templates``.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Final

from .files import encoded, made, moved, refused

if TYPE_CHECKING:
    from ..diagnosis import Diagnosis

__all__ = ["write"]

REPORT: Final = "report.html"


def write(diagnosis: Diagnosis, folder: Path) -> Path:
    """Write report.html, findings.json, plant.toml and figures/*.svg.

    Every file is written under another name and then moved to its own, the report last: whatever
    stops this, no file is half there. The same diagnosis gives the same bytes, except for
    ``seconds`` in findings.json, which is how long it took.

    Parameters
    ----------
    diagnosis : Diagnosis
    folder : Path
        Made where it is not there; files of an earlier report in it are replaced.

    Returns
    -------
    Path
        Of report.html.

    Raises
    ------
    InputError
        The folder cannot be made or written to.
    """
    from .drawings import draw
    from .page import render

    made(folder)
    try:
        with TemporaryDirectory(dir=folder, prefix=".writing-") as name:
            drafts = Path(name)
            drawings = draw(diagnosis, made(drafts / "figures"))
            diagnosis.plant.save(drafts / "plant.toml")
            (drafts / "findings.json").write_bytes(encoded(diagnosis.to_json() + "\n"))
            (drafts / REPORT).write_bytes(encoded(render(diagnosis, drawings)))
            moved(drafts, folder, ("plant.toml", "findings.json", REPORT))
    except OSError as error:
        raise refused(folder, "cannot be written to", error) from None
    return folder / REPORT
