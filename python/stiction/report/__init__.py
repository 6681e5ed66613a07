"""The report of a diagnosis: one page that opens anywhere, and the files beside it.

A section is a builder in ``sections`` and a template of the same name in ``templates``.
"""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Final

from .._support import given
from .._support.atomic_files import subfolder, write_text
from .._support.best_effort import Failure, attempt
from ..plant.begins import save_begins
from .files import folder_error, make_folder, without_others

if TYPE_CHECKING:
    from ..diagnosis import Diagnosis
    from .drawings import Drawings

__all__ = ["write"]

REPORT: Final = "report.html"
BASE: Final = "base.toml"
"""The plant without what was added."""


def write(diagnosis: Diagnosis, folder: Path) -> Path:
    """Write report.html, findings.json, plant.toml, base.toml, begins.toml and figures/*.svg.

    The numbers are on the disk before anything is drawn, and no file is ever half there. A figure
    or a section that fails is a sentence in its place. The same diagnosis gives the same bytes,
    except for ``seconds`` in findings.json, which is how long it took.

    Parameters
    ----------
    diagnosis : Diagnosis
    folder : Path
        Made where it is not there; files of an earlier report in it are replaced, also where one
        is a link.

    Returns
    -------
    Path
        Of report.html.

    Raises
    ------
    InputError
        The folder cannot be made or written to; no diagnosis.
    """
    from ..diagnosis import Diagnosis

    given.instance(diagnosis, Diagnosis, "report.write: diagnosis", "what st.diagnose returns")
    folder = make_folder(given.path(folder, "report.write: folder"))
    try:
        write_text(folder / "findings.json", diagnosis.to_json() + "\n")
        diagnosis.plant.save(folder / "plant.toml")
        base, extended = diagnosis.baseline, diagnosis.extended
        (diagnosis.plant if base is None else base.plant).save(folder / BASE)
        save_begins(folder, {} if extended is None else extended.begins)
        drawn = attempt("the figures", lambda: _drawn(diagnosis))
        drawings = {} if isinstance(drawn, Failure) else drawn
        figures = subfolder(folder, "figures")
        kept = {f"{each.name}.svg": each.svg for each in drawings.values() if each.svg}
        for name, svg in kept.items():
            write_text(figures / name, svg)
        without_others(figures, kept)
        remarks = (str(drawn),) if isinstance(drawn, Failure) else ()
        page = attempt("the page", lambda: _rendered(diagnosis, drawings, remarks))
        write_text(folder / REPORT, _bare(diagnosis, page) if isinstance(page, Failure) else page)
    except OSError as error:
        raise folder_error(folder, "cannot be written to", error) from None
    return folder / REPORT


def _drawn(diagnosis: Diagnosis) -> Drawings:
    from .drawings import draw

    return draw(diagnosis)


def _rendered(diagnosis: Diagnosis, drawings: Drawings, remarks: tuple[str, ...]) -> str:
    from .page import render

    return render(diagnosis, drawings, remarks)


def _bare(diagnosis: Diagnosis, failure: Failure) -> str:
    """The page where there is none: the verdict, and why there is no more."""
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8"><title>stiction diagnosis'
        f"</title></head><body><h1>stiction diagnosis</h1><p>{escape(diagnosis.sentence)}</p>"
        f'<p role="note">{escape(failure.sentence)}</p><p>All numbers are in '
        '<a href="findings.json">findings.json</a>.</p></body></html>\n'
    )
