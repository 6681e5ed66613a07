"""Counts: confusion, rates with Wilson intervals, and every wrong name with its seed."""

from __future__ import annotations

import math
from collections import Counter
from itertools import pairwise

import numpy as np

import stiction as st
from stiction.bench.rates import wilson

from .control import shuffled

BINS = (0.0, 0.01, 0.02, 0.04, 0.07, 0.12, 0.20, 0.40, 1.0)
"""Edges of clair, the gain of an oracle; below .02 silence is right."""
SILENCE_IS_RIGHT = 0.02
FEWEST = 12
"""Sessions from which a curve can be drawn."""
LARGE, MIDDLE = (0.25, 1.0), (0.1, 0.25)
FOREIGN_FROM = 0.15
EXPECTED = {
    "acceleration_friction": {"acceleration"},
    "stick_patch": {
        "position along the motion",
        "angle along the motion",
        "order along the motion",
    },
    "torque_bursts": {"session time", "single moments in time"},
    "half_turn_asymmetry": {"position", "angle", "order over position"},
    "root_speed_drag": {"speed", "velocity"},
    "wandering_bias": {"session time"},
    "mains_ripple": {"frequency"},
}
"""Coordinates that show a foreign effect."""
NOTHING = "none"
"""In place of a rate over no sessions."""
PAIRS = (
    {"torque_bias", "direction_asymmetry"},
    {"warm_up", "run_in"},
    {"torque_constant_ripple", "position_dependent_friction"},
)
"""Declared to be alike on ordinary data: between them only the class is asked for."""
COGGING, UNBALANCE = "cogging", "gravity_unbalance"


# --- what a session says


def confident(row):
    """Names given without reserve."""
    if row["verdict"] == "unexplained":
        return []
    return [cause["name"] for cause in row["found"] if cause["decided"]]


def wrong_names(row):
    """Confident names of effects that are not there."""
    return [name for name in confident(row) if name not in row["names"]]


def wrong_classes(row):
    """Confident names whose class is not there either."""
    causes = {cause["name"]: cause["class"] for cause in row["found"]}
    return [name for name in wrong_names(row) if causes[name] not in row["classes"]]


def named(row):
    """Whether every hidden effect is named without reserve."""
    return bool(row["names"]) and set(row["names"]) <= set(confident(row))


def classed(row):
    """Whether the class of every hidden effect is named: an undecided set may lie in one class."""
    if row["verdict"] == "unexplained":
        return False
    sure = {cause["classes"][0] for cause in row["found"] if len(cause["classes"]) == 1}
    return bool(row["names"]) and set(row["classes"]) <= sure


def answer(row):
    """Column of the confusion matrix."""
    if row["verdict"] == "missing_effect":
        return row["found"][0]["name"] if len(row["found"]) == 1 else "several"
    if row["verdict"] == "ambiguous":
        return "ambiguous, right class" if classed(row) else "ambiguous"
    return {"nothing_missing": "silence"}.get(row["verdict"], row["verdict"])


def shown(row):
    """Whether a foreign effect is called unexplained in one of its coordinates, first or second."""
    return any(name in EXPECTED[row["names"][0]] for name, _ in row["unexplained"][:2])


# --- words


def rate(rows, test):
    """`count/number = share (interval)` of rows that pass a test."""
    count = sum(bool(test(row)) for row in rows)
    return _share(count, len(rows))


def _share(count, number):
    if not number:
        return NOTHING
    low, high = wilson(count, number)
    return f"{count}/{number} = {100 * count / number:.1f} % ({100 * low:.1f}–{100 * high:.1f})"


def table(head, lines):
    rule = "|".join("---" for _ in head)
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in (head, *lines)).replace(
        "\n", f"\n|{rule}|\n", 1
    )


def _within(rows, low, high):
    return [row for row in rows if low <= row["clair"] < high or high == 1.0 <= row["clair"]]


def _sized(rows, low, high):
    return [row for row in rows if row["hidden"] and low <= row["hidden"][0]["reached"] <= high]


# --- the report


def report(rows):
    """Everything that was counted, as Markdown: what was lost, then those that had an answer."""
    lost = of_lost(rows)
    rows = [_rightly_named(row) for row in rows if "verdict" in row]
    kinds = {kind: [row for row in rows if row["kind"] == kind] for kind in _kinds(rows)}
    single = kinds.get("single", [])
    forms = {
        form: [row for row in single if row["hidden"][0]["form"] == form]
        for form in ("library", "foreign")
    }
    parts = [lost, _rates(kinds), _answers(single)]
    for form, some in forms.items():
        if some:
            parts += [f"Single effects in the {form} form, by clair:", _by_clair(some)]
    parts += [_by_effect(single), _foreign(kinds.get("foreign", [])), _errors(rows)]
    return "\n\n".join(part for part in parts if part) + "\n"


def of_lost(rows):
    """What was lost, by kind: no answer, or one that a user cannot go on with."""
    kinds = Counter(kind for row in rows for kind in row.get("lost_kinds", ()))
    lines = [("**lost**: no whole answer", rate(rows, lambda row: row.get("lost")))]
    lines += [(f"lost: {kind}", number) for kind, number in kinds.most_common()]
    return table(("what", "measured (95 % Wilson interval)"), lines)


def _rightly_named(row):
    """A row under the names of what was hidden: a plain wave of one period a turn is an unbalance.

    Both are a cos(x - phase), whatever they were drawn as, and no recording tells them apart.
    """
    names = [
        UNBALANCE if _is_plain_turn(each) and COGGING not in confident(row) else name
        for name, each in zip(row["names"], row["hidden"], strict=True)
    ]
    return {**row, "names": names}


def _is_plain_turn(hidden):
    library = hidden["name"] == COGGING and hidden["form"] == "library"
    return library and hidden["shape"]["order"] == 1.0


def _kinds(rows):
    return dict.fromkeys(row["kind"] for row in rows)


def _rates(kinds):
    null, single = kinds.get("null", []), kinds.get("single", [])
    pair = kinds.get("pair", [])
    left = [row for row in kinds.get("without", []) if row["clair"] >= SILENCE_IS_RIGHT]
    foreign = [r for r in kinds.get("foreign", []) if r["clair"] >= FOREIGN_FROM]
    large, middle = _within(single, *LARGE), _within(single, *MIDDLE)
    alone = [row for row in large if not _has_twin(row["names"][0])]
    faint = [row for row in single if row["clair"] < SILENCE_IS_RIGHT]
    clear = [row for row in single if row["clair"] >= SILENCE_IS_RIGHT]
    hit = [row for row in single if classed(row) and row["gain"] and row["clair"] > 0.0]
    ratio = [row["gain"] / row["clair"] for row in hit]
    intervals = [each for row in single for each in row["intervals"] if _sure(row)]
    covered = sum(low <= true <= high for _, true, _, low, high in intervals)
    every = [row for some in kinds.values() for row in some]
    lines = [
        ("null: any entry in `effects`", rate(null, lambda r: r["found"])),
        ("null: a confident name", rate(null, confident)),
        ("null: unexplained", rate(null, lambda r: r["verdict"] == "unexplained")),
        ("null: not testable", rate(null, lambda r: r["verdict"] == "not_testable")),
        ("single, 1–1.5 % F_c: class", rate(_sized(single, 0.0095, 0.0155), classed)),
        ("single, 1–1.5 % F_c: name", rate(_sized(single, 0.0095, 0.0155), named)),
        ("single, 0.4–0.5 % F_c: class", rate(_sized(single, 0.0038, 0.0053), classed)),
        ("single, clair ≥ .25: class", rate(large, classed)),
        ("single, clair ≥ .25, outside the declared pairs: name", rate(alone, named)),
        ("single, clair .1–.25: class", rate(middle, classed)),
        ("single, clair < .02: silence", rate(faint, lambda r: not r["found"])),
        ("single, any size: a confident wrong name", rate(single, wrong_names)),
        ("single, any size: a confident wrong class", rate(single, wrong_classes)),
        ("single, clair ≥ .02: ambiguous", rate(clear, _is("ambiguous"))),
        ("single, clair ≥ .02: unexplained", rate(clear, _is("unexplained"))),
        ("single, clair ≥ .02: silence", rate(clear, _is("nothing_missing"))),
        ("left out, clair ≥ .02: confident wrong class", rate(left, wrong_classes)),
        ("left out, clair ≥ .15: unexplained", rate(_within(left, 0.15, 1.0), _is("unexplained"))),
        ("left out, clair ≥ .15: silence", rate(_within(left, 0.15, 1.0), _is("nothing_missing"))),
        ("foreign, clair ≥ .15: no confident name", rate(foreign, lambda r: not confident(r))),
        ("foreign, clair ≥ .15: coordinate in the first two", rate(foreign, shown)),
        ("pairs: both classes, no third", rate(pair, _both)),
        ("pairs, every clair ≥ .25: both classes, no third", rate(_within(pair, *LARGE), _both)),
        ("pairs: classes of what has an own clair ≥ .02, no third", rate(pair, _seen)),
        ("pairs, both own clairs ≥ .02: both classes, no third", rate(_plain(pair), _both)),
        ("intervals of gains that cover the truth", _share(covered, len(intervals))),
        ("control: name with labels shuffled", rate(shuffled(clear), named)),
        ("gain ÷ clair, right class", _quantiles(ratio)),
        ("single: distance d at which 80 % of the classes are right", _distance(single)),
        ("seconds for a diagnosis", _quantiles([row["seconds"] for row in every])),
    ]
    lines = [line for line in lines if line[1] != NOTHING]
    return table(("what", "measured (95 % Wilson interval)"), lines)


def _is(verdict):
    return lambda row: row["verdict"] == verdict


def _sure(row):
    return classed(row) and not wrong_names(row)


def _both(row):
    return classed(row) and len(row["found"]) == 2


def _seen(row):
    """Whether the classes of what can be seen are told and nothing that is not there."""
    if row["verdict"] == "unexplained" or wrong_names(row):
        return False
    classes = {cause["classes"][0] for cause in row["found"] if len(cause["classes"]) == 1}
    return _visible(row) <= classes and len(row["found"]) <= len(row["names"])


def _visible(row):
    """Classes of the hidden effects about which silence would be wrong."""
    families = {record.name: record.family for record in st.effects()}
    return {
        families[name]
        for name, clair in zip(row["names"], row["own_clairs"], strict=True)
        if clair >= SILENCE_IS_RIGHT
    }


def _plain(pairs):
    return [row for row in pairs if min(row["own_clairs"]) >= SILENCE_IS_RIGHT]


def _has_twin(name):
    known = {record.name for record in st.effects()}
    return any(name in pair and pair <= known for pair in PAIRS)


def _distance(rows):
    """Where a logistic curve over log d passes 80 %, with the interval of its delta method."""
    rows = [row for row in rows if row.get("distance", 0.0) > 0.0]
    right = np.array([1.0 if classed(row) else 0.0 for row in rows])
    if len(rows) < FEWEST or right.min() == right.max():
        return NOTHING
    place = np.log([row["distance"] for row in rows])
    columns = np.column_stack([np.ones(len(rows)), place])
    curve = np.zeros(2)
    for _ in range(100):
        share = 1.0 / (1.0 + np.exp(-columns @ curve))
        normal = columns.T @ (columns * (share * (1.0 - share))[:, None]) + 1e-9 * np.eye(2)
        curve = curve + np.clip(np.linalg.solve(normal, columns.T @ (right - share)), -2.0, 2.0)
    at = (math.log(4.0) - curve[0]) / curve[1]
    slope = np.array([-1.0, -at]) / curve[1]
    width = 1.96 * math.sqrt(float(slope @ np.linalg.solve(normal, slope)))
    low, middle, high = (math.exp(min(at + k * width, 700.0)) for k in (-1.0, 0.0, 1.0))
    return f"{middle:.0f} ({low:.0f}–{high:.0f}), n = {len(rows)}"


def _quantiles(values):
    if not values:
        return NOTHING
    low, middle, high = np.quantile(values, [0.1, 0.5, 0.9])
    return f"median {middle:.3f}, 80 % within {low:.3f}–{high:.3f}, n = {len(values)}"


def _answers(single):
    if not single:
        return ""
    seen = [row for row in single if row["clair"] >= SILENCE_IS_RIGHT]
    names = sorted({row["names"][0] for row in seen})
    columns = [*names, *sorted({answer(row) for row in seen} - set(names))]
    lines = []
    for name in names:
        counts = Counter(answer(row) for row in seen if row["names"][0] == name)
        lines.append((name, *(counts[column] or "" for column in columns), counts.total()))
    return "Single effects with clair ≥ .02, hidden by row, answered by column:\n\n" + table(
        ("hidden", *columns, "n"), lines
    )


def _by_clair(single):
    lines = []
    for low, high in pairwise(BINS):
        # An oracle that gains nothing may come out below 0.
        some = _within(single, low if low else -math.inf, high)
        tests = (
            lambda r: r["verdict"] != "nothing_missing",
            named,
            classed,
            wrong_names,
            wrong_classes,
            _is("ambiguous"),
            _is("unexplained"),
        )
        lines.append((f"{low:g}–{high:g}", len(some), *(_counted(some, test) for test in tests)))
    head = "clair n detected name class wrong-name wrong-class ambiguous unexplained"
    return table(tuple(word.replace("-", " ") for word in head.split()), lines)


def _counted(rows, test):
    count = sum(bool(test(row)) for row in rows)
    return f"{count} ({count / len(rows):.2f})" if rows else ""


def _by_effect(single):
    if not single:
        return ""
    lines = []
    for name in sorted({row["names"][0] for row in single}):
        own = [r for r in single if r["names"][0] == name and r["clair"] >= MIDDLE[0]]
        ratio = [r["gain"] / r["clair"] for r in own if classed(r) and r["gain"]]
        intervals = [each for r in own for each in r["intervals"] if _sure(r)]
        covered = sum(low <= true <= high for _, true, _, low, high in intervals)
        median = f"{np.median(ratio):.3f}" if ratio else ""
        lines.append(
            (name, rate(own, named), rate(own, classed), median, f"{covered}/{len(intervals)}")
        )
    return "Single effects with clair ≥ .1:\n\n" + table(
        ("hidden", "name", "class", "gain ÷ clair", "intervals that cover"), lines
    )


def _foreign(foreign):
    if not foreign:
        return ""
    lines = []
    for name in sorted({row["names"][0] for row in foreign}):
        own = [r for r in foreign if r["names"][0] == name and r["clair"] >= FOREIGN_FROM]
        verdicts = Counter(row["verdict"] for row in own)
        told = Counter(cause for row in own for cause in confident(row))
        lines.append((name, len(own), _tally(verdicts), _tally(told), _counted(own, shown)))
    return "Foreign effects with clair ≥ .15:\n\n" + table(
        ("hidden", "n", "verdicts", "confident names", "coordinate in the first two"), lines
    )


def _tally(counts):
    return ", ".join(f"{number} {name}" for name, number in counts.most_common())


def _errors(rows):
    lines = []
    for row in rows:
        if not (wrong_names(row) or (not row["names"] and row["found"])):
            continue
        hidden = " + ".join(f"{h['name']}:{h['form']}" for h in row["hidden"]) or "nothing"
        size = ", ".join(f"{100 * h['reached']:.2f} %" for h in row["hidden"])
        found = ", ".join(c["name"] + ("" if c["decided"] else "?") for c in row["found"])
        lines.append(
            (row["base"], row["seed"], row["kind"], hidden, size, f"{row['clair']:.3f}", found)
        )
    if not lines:
        return ""
    head = ("base", "seed", "kind", "hidden", "size", "clair", "named (? undecided)")
    return "Wrong names:\n\n" + table(head, lines)
