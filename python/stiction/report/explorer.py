"""What a reader walks through: every recording beside both models, linked in time and in motion."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from importlib import resources
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from markupsafe import Markup

from .._support.numbers import percent
from .._support.scale import Scale, scale_for, scale_of
from ..diagnosis.findings.pictures import ROLES
from ..plot import thinned
from ..residual.compared import comparison_of
from .packing import Packed, pack
from .titles import effect_title

if TYPE_CHECKING:
    from .._support.arrays import FloatArray
    from ..diagnosis.findings.pictures import Trace
    from ..diagnosis.findings.result import Diagnosis

__all__ = ["Explorer", "explorer"]

MOST_VALUES: Final = 4_400_000
"""Numbers that a page holds, at about 1.1 bytes each: of a longer session the rows are kept in
which something is extreme."""
FEWEST_BLOCKS: Final = 50
"""Stretches of a recording that are told apart all the same."""
FINER: Final = 24.0
"""Steps of an effort in what noise alone leaves: finer than a line on a screen."""
POSITIONS: Final = 4.0
"""Steps of a position in a count of its sensor."""
SLOWEST_S: Final = 0.1
"""Speeds are told apart that move the machine by a count within this time, s."""
STAMPS: Final = 1000.0
"""Steps of the time between two rows."""
APART: Final = 0.02
"""Between two recordings on one axis, as a share of the first one."""
ROWS: Final = (*("time", "position", "velocity", "effort", "inertial", "before", "after", "role"),)
"""What a recording has a value of in every row."""
LIBRARY: Final = "uplot/uPlot.iife.min.js"
SCRIPTS: Final = ("columns.js", "view.js", "panels.js", "explorer.js")
"""Parts of one script, in their order."""
STYLES: Final = ("uplot/uPlot.min.css", "templates/explorer.css")


@dataclass(frozen=True)
class Explorer:
    """The parts of a page that only a script brings to life.

    Attributes
    ----------
    data : Markup
        Elements that hold names, units and columns; nothing in them runs.
    scripts : tuple of Markup
        Texts of the scripts, in their order.
    style : Markup
    licence : str
        Of the library.
    """

    data: Markup
    scripts: tuple[Markup, ...]
    style: Markup
    licence: str

    @property
    def content_policy(self) -> Markup:
        """Sources of a content security policy: these scripts by their SHA-256, and no other."""
        digests = (b64encode(sha256(each.encode()).digest()).decode() for each in self.scripts)
        return Markup(" ".join(f"'sha256-{digest}'" for digest in digests))


def explorer(diagnosis: Diagnosis) -> Explorer | None:
    """What the page of a diagnosis lets its reader walk through; None where nothing was fitted."""
    pictures = diagnosis.pictures
    if pictures is None or not pictures.traces:
        return None
    columns = _columns(diagnosis, _kept(pictures.traces))
    told = _told(diagnosis, columns)
    blocks = [_block("explorer-data", "application/json", _json(told))]
    blocks += [
        _block(f"column-{key}", "text/plain", packed.text) for key, packed in columns.packed.items()
    ]
    return Explorer(
        data=Markup("\n").join(blocks),
        scripts=(Markup(_library()), Markup(_own())),
        style=Markup("\n".join(_read(name) for name in STYLES)),
        licence=_read("uplot/LICENSE"),
    )


@dataclass(frozen=True)
class _Columns:
    """All recordings one under the other, packed."""

    traces: Sequence[Trace]
    packed: dict[str, Packed]
    position: Scale
    speed: Scale
    effort: Scale
    residual: Scale
    error: Scale


def _columns(diagnosis: Diagnosis, traces: Sequence[Trace]) -> _Columns:
    pictures = diagnosis.pictures
    assert pictures is not None
    names = ("position", "velocity", "effort", "inertial", "before", "after")
    own = {name: np.concatenate([getattr(trace, name) for trace in traces]) for name in names}
    unit = pictures.position_unit
    position = scale_for([_greatest(own["position"])], unit)
    speed = scale_for([_greatest(own["velocity"])], f"{unit}/s")
    effort = scale_for([_greatest(own["effort"])], pictures.effort_unit)
    residual = scale_of(diagnosis)
    count = min((trace.step for trace in traces if trace.step > 0.0), default=0.0)
    fine = pictures.floor / FINER if np.isfinite(pictures.floor) else 0.0

    def packed(values: FloatArray, scale: Scale, step: float) -> Packed:
        return pack(scale.factor * values, abs(scale.factor) * step)

    found = {
        "time": _time(traces),
        "position": packed(own["position"], position, count / POSITIONS),
        "speed": packed(own["velocity"], speed, count / SLOWEST_S),
        "effort": packed(own["effort"], effort, fine),
        "inertial": packed(own["inertial"], effort, fine),
        "before": packed(own["before"], residual, fine),
        "after": packed(own["after"], residual, fine),
    }
    for key, values in _simulated(traces).items():
        found[key] = packed(values, position, count / POSITIONS)
    for number, name in enumerate(traces[0].contributions):
        values = np.concatenate([trace.contributions[name] for trace in traces])
        found[f"effect-{number}"] = packed(values, residual, fine)
    missed = scale_for(_missed(traces), unit)
    return _Columns(traces, found, position, speed, effort, residual, missed)


def _time(traces: Sequence[Trace]) -> Packed:
    steps = np.concatenate([np.diff(trace.time) for trace in traces])
    least = float(steps.min()) if steps.size else 1.0
    return pack(np.concatenate([trace.time for trace in traces]), least / STAMPS)


def _simulated(traces: Sequence[Trace]) -> dict[str, FloatArray]:
    """Positions of both models; blank in recordings that could not be simulated."""
    if all(trace.simulated is None for trace in traces):
        return {}
    blank = [np.full(len(trace.time), np.nan) for trace in traces]
    both = [t.simulated or (none, none) for t, none in zip(traces, blank, strict=True)]
    return {
        f"simulated-{name}": np.concatenate([each[place] for each in both])
        for place, name in enumerate(("before", "after"))
    }


def _told(diagnosis: Diagnosis, columns: _Columns) -> dict[str, Any]:
    """Names, units, and where each column stands."""
    pictures = diagnosis.pictures
    assert pictures is not None
    by = comparison_of(diagnosis.plant)
    recordings, begin, offset = [], 0, 0.0
    for trace in columns.traces:
        end = begin + len(trace.time)
        recordings.append(
            {
                "name": trace.name,
                "rows": [begin, end],
                "offset": offset,
                "parts": _parts(trace.role, begin),
            }
        )
        begin, offset = end, offset + (1.0 + APART) * float(trace.time[-1])
    first = pictures.stretches[0].name if pictures.stretches else ""
    residual = columns.residual
    return {
        "both": bool(diagnosis.effects),
        "friction": not by.loop,
        "roles": list(ROLES),
        "recordings": recordings,
        "first": next((k for k, r in enumerate(recordings) if r["name"] == first), 0),
        "units": {
            "position": columns.position.unit,
            "speed": columns.speed.unit,
            "effort": columns.effort.unit,
            "residual": residual.unit,
            "error": columns.error.unit,
        },
        # Residuals and efforts may be written in different units: mN·m and N·m.
        "ratio": columns.effort.factor / residual.factor,
        "finer": columns.error.factor / columns.position.factor,
        "noise": residual.factor * pictures.floor if np.isfinite(pictures.floor) else 0.0,
        "candidates": _candidates(diagnosis, list(columns.traces[0].contributions)),
        "columns": {key: each.to_dict() for key, each in columns.packed.items()},
    }


def _candidates(diagnosis: Diagnosis, stored: Sequence[str]) -> list[dict[str, str]]:
    accepted = {effect.name for effect in diagnosis.effects}
    rows = []
    for row in diagnosis.candidates:
        score = "" if row.score is None else f"score {percent(row.score)}"
        noise = "" if row.threshold is None else f"noise reaches {percent(row.threshold)}"
        told = [each for each in (score, noise, row.reason) if each]
        rows.append(
            {
                "title": effect_title(row.name),
                "group": "accepted" if row.name in accepted else "refused",
                "told": "; ".join(told),
                "column": f"effect-{stored.index(row.name)}" if row.name in stored else "",
            }
        )
    return sorted(rows, key=lambda row: (row["group"], not row["column"]))


def _missed(traces: Sequence[Trace]) -> list[float]:
    """Sizes of the errors of the positions that the last model simulates."""
    return [
        float(np.sqrt(np.mean((trace.position - trace.simulated[1]) ** 2)))
        for trace in traces
        if trace.simulated is not None
    ]


def _parts(role: np.ndarray, begin: int) -> list[list[int]]:
    """Stretches of rows of one role: first row, the one behind the last, and the role."""
    edges = np.flatnonzero(np.diff(role)) + 1
    ends = [0, *edges.tolist(), len(role)]
    return [[begin + low, begin + high, int(role[low])] for low, high in pairwise(ends)]


def _kept(traces: Sequence[Trace]) -> Sequence[Trace]:
    """The recordings, of long ones the rows in which effort or residual is extreme."""
    each = 9 + len(traces[0].contributions)
    rows = sum(len(trace.time) for trace in traces)
    if rows * each <= MOST_VALUES:
        return traces
    # Of each block least and greatest effort and residual are kept.
    share = 0.25 * MOST_VALUES / (rows * each)
    blocks = [max(int(len(trace.time) * share), FEWEST_BLOCKS) for trace in traces]
    return [_extremes(trace, own) for trace, own in zip(traces, blocks, strict=True)]


def _extremes(trace: Trace, blocks: int) -> Trace:
    """A recording by the rows in which its effort or its residual is extreme, block by block."""
    place = np.arange(len(trace.time), dtype=np.float64)
    found = [thinned(place, values, blocks)[0] for values in (trace.effort, trace.after)]
    rows = np.unique(np.concatenate(found)).astype(np.intp)
    one, two = trace.simulated or (None, None)
    return replace(
        trace,
        **{name: getattr(trace, name)[rows] for name in ROWS},
        simulated=None if one is None or two is None else (one[rows], two[rows]),
        contributions={name: own[rows] for name, own in trace.contributions.items()},
    )


def _greatest(values: FloatArray) -> float:
    return float(np.max(np.abs(values))) if values.size else 1.0


def _block(name: str, kind: str, text: str) -> Markup:
    return Markup('<script type="{}" id="{}">{}</script>').format(kind, name, Markup(text))


def _json(told: dict[str, Any]) -> str:
    """JSON that no name can end the element of."""
    text = json.dumps(told, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _library() -> str:
    """uPlot without the comment at its head: an address looks as if it were asked for."""
    return _read(LIBRARY).split("*/", 1)[1].lstrip()


def _own() -> str:
    """The parts as one script, which leaves no names in the page."""
    parts = (_read(f"templates/{name}") for name in SCRIPTS)
    return "\n".join(['"use strict";', "(() => {", *parts, "})();"])


def _read(name: str) -> str:
    return resources.files("stiction.report").joinpath(name).read_text("utf-8").strip()
