"""The sentences of a diagnosis."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence, Set
from types import MappingProxyType
from typing import TYPE_CHECKING

from ..._support.scale import loop_scale_of
from ..._support.wording import join_words, plural
from ...catalogue import EffectRecord
from ...catalogue import effects as catalogue
from ...fitting.pushes import omission_words
from ...fitting.result import FitParameter
from ...fitting.rows import Push
from ...fitting.waves import amplitude_of, parts_of, phase_of
from ...plant.stated import Effect
from ...residual.compared import EFFORT, Compared, comparison_of
from ..phrases import ALONE, DOUBTFUL, NO_COORDINATE, OUTWEIGHED, UNCONFIRMED, UNREPEATED
from ..screening.orders import order_words
from .directions import describe_effect

if TYPE_CHECKING:
    from ...recording import Check
    from ..data.gain import Gain
    from ..records import Cause, Unexplained, Verdict
    from .result import Diagnosis

__all__ = [
    "WORSE",
    "gain_words",
    "loop_words",
    "no_machine",
    "push_words",
    "sentence",
    "shown_rows",
    "summary",
    "unseen_words",
    "value_words",
    "what",
    "worse_loop_words",
]

MOST_TOLD = 3
"""Pushes that a sentence names."""
MOST_ROWS = 5
"""Candidates that the command line shows."""
WORSE = 1.1
"""A loop does worse with the causes where its error is so many times that without."""
MISSED = 0.1
"""Share of the recorded input that a stated controller may miss before it is doubted."""


def value_words(name: str, parameter: FitParameter) -> str:
    """A parameter with its interval: ``"bias 3.1 N (2.6 to 3.6)"``."""
    low, high = parameter.ci95
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    known = math.isfinite(low) and math.isfinite(high)
    interval = f"{low:.3g} to {high:.3g}" if known else "not determined"
    # An interval about an end of a range says nothing beyond it: a speed is not negative.
    ended = f", at its {parameter.at_bound} bound" if parameter.at_bound else ""
    return f"{name} {parameter.value:.4g}{unit} ({interval}{ended})"


def gain_words(gain: Gain | None) -> str:
    """A gain with its interval, in per cent."""
    if gain is None:
        return "not measured: no rows were left to test on"
    low, high = gain.ci95
    return (
        f"{100 * gain.value:.1f} % of the power of what was not explained, on held-out rows "
        f"(95 %: {100 * low:.1f} to {100 * high:.1f} %)"
    )


def what(
    record: EffectRecord,
    parameters: Mapping[str, FitParameter],
    effect: Effect,
    waves: Mapping[str, FitParameter] = MappingProxyType({}),
) -> str:
    """What was found of an effect, with its fitted values, and those chosen of a grid.

    ``parameters`` are those of the whole model, ``waves`` amplitudes and phases of its waves, which
    are told in the place of the cosine and the sine that were fitted.
    """
    values = []
    for path, p in parameters.items():
        if not path.startswith(f"effects.{record.name}."):
            continue
        parts = parts_of(path)
        if parts is None or amplitude_of(parts) not in waves:
            values.append(order_words(path, p) or value_words(path.rsplit(".", 1)[-1], p))
        elif path == parts[0]:
            told = (amplitude_of(parts), phase_of(parts))
            values += [value_words(wave.rsplit(".", 1)[-1], waves[wave]) for wave in told]
    chosen = [
        shape.parameter
        for shape in record.shapes
        if shape.scale == "order" or (not shape.fitted and len(shape.grid) > 1)
    ]
    chosen += [name for name in record.second if name not in record.gains and "order" in name]
    values += [
        f"{name} {effect.parameters[name].value:g}"
        for name in chosen
        if name in effect.parameters and effect.parameters[name].fixed
    ]
    meaning = describe_effect(record, parameters)
    return f"{meaning}: {', '.join(values)}" if values else meaning


def sentence(
    verdict: Verdict,
    effects: Sequence[Cause],
    gain: Gain | None,
    unexplained: Sequence[Unexplained],
    reason: str,
    *,
    slight: bool = False,
) -> str:
    """The verdict in words; ``slight`` where more is left than noise, and too little to count."""
    if verdict in ("data_fault", "not_testable"):
        return reason
    named = _causes(effects)
    adding = f"Adding {'it' if len(effects) == 1 else 'them'}"
    lacks, gained = "The simulation lacks", f" {adding} removes {gain_words(gain)}."
    if gain is not None and gain.value < 0.0:
        # What does not bear out must not begin as if it were so.
        lacks = "By the rows that decide, and by no others, the simulation lacks"
        gained = f" {adding} makes the held-out rows worse."
    if verdict == "nothing_missing" and slight:
        # The tables show what is there: that it is no more than noise would contradict them.
        return (
            "Nothing that counts is missing: some of what is left is more than noise, but too "
            "little beside the friction, or too uncertain, to name an effect of the catalogue."
        )
    if verdict == "nothing_missing":
        return (
            "Nothing is missing: no effect of the catalogue explains more than noise, and what is "
            "left shows in no coordinate."
        )
    if verdict == "unexplained":
        depends = _depends(unexplained)
        if not effects:
            return (
                "Something is missing that no effect of the catalogue explains: the residual "
                f"{depends}."
            )
        return (
            f"{lacks} {named}, and something without a name: what is left "
            f"{depends}.{gained}"
            f"{_unconfirmed(effects)}"
        )
    # Most of what is left may be more than noise and yet little beside what was named.
    more = any(
        left.coordinate == NO_COORDINATE or left.coordinate.endswith(ALONE) for left in unexplained
    )
    outweighed = [cause.name for cause in effects if cause.doubt == OUTWEIGHED]
    left = f" What is left {_depends(unexplained)}." if more or outweighed else ""
    if outweighed:
        took = join_words(outweighed)
        left += f" What has no name there is worth more than half of what {took} took."
    for cause in effects:
        if cause.doubt == UNREPEATED:
            left += f" Of {cause.name} {cause.doubt}."
        elif cause.doubt and cause.doubt not in (OUTWEIGHED, UNCONFIRMED):
            left += f" {cause.name} may be something else: {cause.doubt}."
    return f"{lacks} {named}.{gained}{_unconfirmed(effects)}{left}"


def unseen_words(unseen: Mapping[str, float], beside: bool) -> str:
    """What shows in rows that were fitted and cannot be judged by those that were not.

    ``unseen`` are shares of what is left there; ``beside`` something else that was found.
    """
    if not unseen:
        return ""
    summaries = {record.name: record.summary for record in catalogue()}
    told = [
        f"{name} ({summaries[name]}) would explain {100 * share:.0f} %"
        for name, share in unseen.items()
    ]
    them = "it" if len(unseen) == 1 else "them"
    judged = (
        f"of what is left where the plant was fitted {join_words(told)}. In rows that decide, or "
        f"were left out in turn, too little of {them} shows, or too unevenly: they neither bear "
        f"{them} out nor refute {them}."
    )
    if beside:
        return f" {judged[0].upper()}{judged[1:]}"
    return f"These data cannot decide whether anything is missing: {judged}"


def no_machine(left: float, named: bool, verdict: Verdict, by: Compared = EFFORT) -> str:
    """What to look at first where the plant leaves most of the effort, "" where it does not.

    ``left`` is the share of its power on rows that the plant was not fitted to, 0 where it is less;
    ``by`` what they are compared by.
    """
    if not left or verdict in ("data_fault", "not_testable"):
        return ""
    share = f"{100 * left:.0f} % of" if left < 1.0 else "more than"
    return (
        f" The plant{', causes and all,' if named else ''} leaves {share} the power of {by.whole} "
        "on rows that it was not fitted to: before any cause counts, check columns, units, signs "
        "and clocks, and what the plant file states, holds fixed or leaves out, as gravity or a "
        "load."
    )


def stands_still(left: float, verdict: Verdict) -> str:
    """What to look at first where the simulated plant misses most of the motion, "" elsewhere.

    ``left`` is the share of the power of the accelerations, 0 where it is less.
    """
    if not left or verdict != "unexplained":
        return ""
    return (
        f" Simulated over short times, the plant leaves {100 * min(left, 1.0):.0f} % of the power "
        "of the measured accelerations: it stands still, or moves otherwise, where the machine "
        "moved. If the machine stays below its break-away, a law without pre-sliding cannot "
        "describe it: state one that yields, as dahl or maxwell_slip, or record a slide."
    )


def push_words(pushes: Sequence[Push], names: Sequence[str]) -> str:
    """The first pushes, those that are sure in a sentence of their own; "" without any."""
    shown = pushes[:MOST_TOLD]
    words = [
        _pushed([push for push in shown if push.sure == sure], names) for sure in (True, False)
    ]
    if len(pushes) > MOST_TOLD:
        more = len(pushes) - MOST_TOLD
        words.append(f"{more} more {'stands' if more == 1 else 'stand'} among the data checks.")
    return " ".join(filter(None, words))


def _pushed(pushes: Sequence[Push], names: Sequence[str]) -> str:
    """Pushes that are all as sure, in one sentence."""
    if not pushes:
        return ""
    of = {push.recording: [p for p in pushes if p.recording == push.recording] for push in pushes}
    times = [
        f"from {join_words([push.when() for push in own])} in {names[recording]}"
        for recording, own in of.items()
    ]
    what = pushes[0].what
    return f"{what[0].upper()}{what[1:]} {join_words(times)}; {omission_words(pushes[0])}."


def apart_words(apart: Sequence[tuple[str, Check]]) -> str:
    """Recordings that test and stand apart from all others, as one sentence; "" without any."""
    if not apart:
        return ""
    each = join_words([f"{name} {check.what}" for name, check in apart[:MOST_TOLD]])
    return (
        f"Of the recordings that test, {each}: something is different there, and no verdict rests "
        "on it."
    )


def _unconfirmed(effects: Sequence[Cause]) -> str:
    """What the rows that test do not bear out, "" where they bear out everything."""
    open_: list[str] = []
    worse: list[str] = []
    for cause in effects:
        if cause.gain is not None and cause.gain.ci95[0] <= 0.0:
            (worse if cause.gain.ci95[1] <= 0.0 else open_).append(cause.name)
    told = f" The held-out rows do not confirm {join_words(open_)}." if open_ else ""
    return told + (f" The held-out rows speak against {join_words(worse)}." if worse else "")


def _depends(unexplained: Sequence[Unexplained]) -> str:
    """On what the residual still depends, and how much of it on nothing that was looked at."""
    shown = [each for each in unexplained if each.coordinate != NO_COORDINATE][:3]
    on = join_words([f"{each.coordinate} ({100 * each.share:.0f} %)" for each in shown])
    nowhere = [each.share for each in unexplained if each.coordinate == NO_COORDINATE]
    if not nowhere:
        return f"still depends on {on}"
    share = f"{100 * nowhere[0]:.0f} %"
    if not shown:
        return f"is more than noise and goes with {NO_COORDINATE} ({share})"
    return (
        f"is more than noise ({share}); some of it depends on {on}, and most goes with "
        f"{NO_COORDINATE}"
    )


def _causes(effects: Sequence[Cause]) -> str:
    """All causes; relatives that are told from nothing but each other stand together."""
    told: list[str] = []
    undecided: list[str] = []
    groups: list[str] = []
    together: set[str] = set()
    for cause in effects:
        group = {cause.name, *cause.look_alikes}
        kin = [c for c in effects if {c.name, *c.look_alikes} == group]
        if len(kin) < 2 or len(kin) < len(group):
            others = {each.name for each in effects if each is not cause}
            (told if cause.decided else undecided).append(_cause(cause, others))
        elif cause.name not in together:
            together |= group
            each = join_words([_with_meaning(one) for one in kin])
            groups.append(f"{each}, which together may be another cause that resembles them")
    # What is told first: after "cannot tell apart" each further name would seem to be one of these.
    return join_words([*told, *undecided, *groups])


def _with_meaning(cause: Cause) -> str:
    return f"{cause.name} ({cause.what.partition(':')[0]})"


def _cause(cause: Cause, others: Set[str]) -> str:
    """A cause with its meaning, or the effects that it may be with theirs, or more of others."""
    own = _with_meaning(cause)
    if cause.decided:
        return own
    if not cause.look_alikes:
        return f"perhaps {own}"
    known = {record.name: f"{record.name} ({record.summary})" for record in catalogue()}
    alike = (known.get(n, n) if n not in others else f"more of {n}" for n in cause.look_alikes)
    names = [own, *alike]
    either = "either" if len(names) == 2 else "one of"
    return f"{either} {join_words(names, 'or')}, which these data cannot tell apart"


def shown_rows(diagnosis: Diagnosis) -> list[str]:
    """The first candidates as lines of a table."""
    rows = [("candidate", "score", "threshold", "gain", "reason")]
    rows += [
        (
            row.name,
            _percent(row.score),
            _percent(row.threshold),
            _percent(row.select_gain),
            row.reason,
        )
        for row in diagnosis.candidates[:MOST_ROWS]
    ]
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    return [
        "  ".join([*(f"{row[k]:<{widths[k]}}" for k in range(4)), row[4]]).rstrip() for row in rows
    ]


def loop_words(diagnosis: Diagnosis) -> str:
    """The position error in closed loop, "" where no loop was replayed."""
    after = diagnosis.extended
    found = _loop_errors(diagnosis)
    if found is None or after is None or after.replay is None:
        return ""
    rows, known = found
    if not known:
        return "closed loop: the simulated loop runs away; see the remarks in the report"
    scale = loop_scale_of(diagnosis)
    told = [f"{scale.factor * error:.3g} {scale.unit}" for error in known]
    words = f"closed loop {rows}: position error {told[0]} rms"
    if diagnosis.effects:
        words += f" before, {told[1]} after"
    missed = after.replay.controller_error
    if missed is not None and missed > MISSED:
        words += (
            f"; the stated controller misses the recorded input by {100 * missed:.0f} %, so check "
            "[controller]"
        )
    return words


def worse_loop_words(diagnosis: Diagnosis) -> str:
    """That the causes make the simulated loop worse, "" where they do not."""
    found = _loop_errors(diagnosis)
    if not diagnosis.effects or found is None or not found[1]:
        return ""
    rows, (before, after) = found
    if after <= WORSE * before:
        return ""
    scale = loop_scale_of(diagnosis)
    one, two = (f"{scale.factor * error:.3g}" for error in (before, after))
    which = "it" if len(diagnosis.effects) == 1 else "them"
    return (
        f" But the simulated loop does worse with {which}: its position error {rows} is {two} "
        f"{scale.unit} rms, {one} without, so what was named stands for something else or is not "
        "all of it."
    )


def _loop_errors(diagnosis: Diagnosis) -> tuple[str, list[float]] | None:
    """Rows and position errors in closed loop before and after, none of them for one that ran away.

    None where no loop was replayed.
    """
    before, after = diagnosis.baseline, diagnosis.extended
    if before is None or after is None or before.replay is None or after.replay is None:
        return None
    rows, errors = "held out", [before.replay.heldout_rms, after.replay.heldout_rms]
    if None in errors:
        rows, errors = "on the rows fitted", [before.replay.train_rms, after.replay.train_rms]
    known = [error for error in errors if error is not None]
    return rows, known if len(known) == 2 else []


def _percent(share: float | None) -> str:
    return "" if share is None else f"{100 * share:.1f} %"


def _base_words(diagnosis: Diagnosis) -> str:
    """Numbers of body, drive and law as they are known beside the causes, "" without a fit.

    Those of the causes stand beside their names.
    """
    model = diagnosis.extended or diagnosis.baseline
    if model is None:
        return ""
    own = {path: p for path, p in model.parameters.items() if not path.startswith("effects.")}
    told = [value_words(path.rsplit(".", 1)[-1], p) for path, p in own.items()]
    return f"fitted: {', '.join(told)}" if told else ""


def summary(diagnosis: Diagnosis) -> str:
    """What the command line prints: sentence, findings, candidates, next experiment."""
    lines = [diagnosis.sentence]
    for cause in diagnosis.effects:
        lines += ["", f"{cause.name}: {cause.what}"]
        lines += [f"  means: {cause.means}", f"  try: {cause.try_}"]
        lines.append(f"  gain: {gain_words(cause.gain)}")
        if cause.doubtful:
            lines.append(f"  care: {DOUBTFUL}")
        if cause.track_record:
            lines.append(f"  track record: {cause.track_record}")
    before, after = diagnosis.baseline, diagnosis.extended
    if before is not None and before.heldout_relative is not None and after is not None:
        by = comparison_of(diagnosis.plant)
        told = f"{by.error} held out: {by.share(before.heldout_relative)}"
        if diagnosis.effects and after.heldout_relative is not None:
            told += f" before, {by.share(after.heldout_relative)} after"
        lines += ["", told]
    if len(diagnosis.evidence.each) > 1:
        lines.append(diagnosis.evidence.words)
    if before is not None:
        lines += before.assumed
    if diagnosis.ceiling is not None:
        lines.append(diagnosis.ceiling.words(bool(diagnosis.effects)))
    if looped := loop_words(diagnosis):
        lines.append(looped)
    if numbers := _base_words(diagnosis):
        lines += ["", numbers]
    if diagnosis.laws:
        lines.append("")
        for row in diagnosis.laws:
            lines.append(f"law {row.law}: {row.reason}")
    if diagnosis.candidates:
        lines += ["", *shown_rows(diagnosis)]
        more = len(diagnosis.candidates) - MOST_ROWS
        if more > 0:
            lines.append(f"and {plural(more, 'other')} in findings.json")
    if diagnosis.advice:
        first = diagnosis.advice[0]
        lines += ["", f"record next: {first.experiment} ({first.reason})"]
    return "\n".join(lines)
