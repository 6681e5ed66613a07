"""How a recording prints, as text and as HTML."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from .._support.wording import plural

if TYPE_CHECKING:
    from .recording import Recording

_COLUMNS = ("channel", "least", "greatest", "unit")
_Row = tuple[str, str, str, str]


def as_text(recording: Recording) -> str:
    """Heading, one line a channel, and the notes."""
    rows = [_COLUMNS, *_rows(recording)]
    widths = [max(len(row[column]) for row in rows) for column in range(len(_COLUMNS))]
    lines = [_heading(recording)]
    for name, least, greatest, unit in rows:
        line = f"  {name:<{widths[0]}}  {least:>{widths[1]}}  {greatest:>{widths[2]}}  {unit}"
        lines.append(line.rstrip())
    lines += [f"  note: {note}" for note in recording.notes]
    return "\n".join(lines)


def as_html(recording: Recording) -> str:
    """The same as a table."""
    head = "".join(f"<th>{name}</th>" for name in _COLUMNS)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>"
        for row in _rows(recording)
    )
    notes = "".join(f"<li>{escape(note)}</li>" for note in recording.notes)
    return (
        f"<p><b>{escape(_heading(recording))}</b></p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        + (f"<ul>{notes}</ul>" if notes else "")
    )


def _heading(recording: Recording) -> str:
    name = f" {recording.path.name}" if recording.path else ""
    labels = ", ".join(filter(None, (recording.role, recording.kind)))
    return (
        f"Recording{name}: {plural(len(recording), 'row')} over {recording.duration:.6g} s, "
        f"median step {recording.dt:.6g} s" + (f" ({labels})" if labels else "")
    )


def _rows(recording: Recording) -> list[_Row]:
    channels = {"input": recording.input, "position": recording.position, **recording.channels}
    rows = []
    for name, array in channels.items():
        if array is None:
            continue
        finite = array[np.isfinite(array)]
        bounds = (f"{finite.min():.6g}", f"{finite.max():.6g}") if finite.size else ("", "")
        rows.append((name, *bounds, recording.units.get(name, "")))
    return rows
