"""Counts of ordinary sessions."""

from __future__ import annotations

from stiction.bench.ordinary.draw import OWN_LAWS

from .table import answer, classed, confident, named, of_lost, rate, table, wrong_names

CLEAR = 0.03
"""Hidden effort, share of the dry friction, from which a name is asked for."""


def report(rows):
    """Everything that was counted, as Markdown."""
    parts = [of_lost(rows)]
    for kind, what in (
        ("grid", "Nothing hidden, the grid of 24 sessions of known effort"),
        ("null", "Nothing hidden, drawn"),
        ("hidden", "One effect hidden, drawn"),
    ):
        some = [row for row in rows if row["kind"] == kind]
        for own in (True, False):
            part = [row for row in some if has_own_law(row) is own]
            if part:
                law = "the machine's own law stated" if own else "another law stated"
                parts += [f"{what}, {law}:", _counts(part)]
    parts += [_each(rows)]
    return "\n\n".join(part for part in parts if part) + "\n"


def beside(judges):
    """Counts of several judges of the same sessions, a column each, as Markdown.

    Parameters
    ----------
    judges : dict of str to list of rows
    """
    tests = (
        ("nothing hidden: a name", False, lambda r: r["found"]),
        ("nothing hidden: a sure name", False, confident),
        ("nothing hidden: unexplained", False, _is("unexplained")),
        (
            "hidden: the name, and no other sure one",
            True,
            lambda r: named(r) and not wrong_names(r),
        ),
        ("hidden: name", True, named),
        ("hidden: class", True, classed),
        ("hidden: the first cause is of its class", True, _begins_right),
        ("hidden: the effect among all that is told", True, _among),
        ("hidden: a sure and wrong name", True, wrong_names),
        ("hidden: silence", True, _is("nothing_missing")),
    )
    told = {name: [r for r in rows if "verdict" in r] for name, rows in judges.items()}
    lines = [
        (
            what,
            *(
                rate([r for r in rows if bool(r["names"]) is hidden], test)
                for rows in told.values()
            ),
        )
        for what, hidden, test in tests
    ]
    return table(("what", *told), lines) + "\n"


def has_own_law(row):
    """Whether the plant file states the law that the machine has, in every detail."""
    spec = row["spec"]
    if "own_law" in spec:
        return spec["own_law"]
    return OWN_LAWS[spec["contact"]] == spec["law"] and spec["kind"] == "driven"


def _counts(rows):
    """Rates of sessions that had an answer; those without are counted as lost alone."""
    told = [row for row in rows if "verdict" in row]
    lines = [("lost", rate(rows, lambda r: r["lost"]))]
    if not rows[0]["names"]:
        lines += [
            ("a name", rate(told, lambda r: r["found"])),
            ("a sure name", rate(told, confident)),
            ("unexplained", rate(told, _is("unexplained"))),
            ("of these the law is told", rate([r for r in told if _is("unexplained")(r)], _law)),
            ("a name, or unexplained", rate(told, lambda r: not _silent(r))),
            ("not testable, or a fault of the data", rate(told, _refused)),
            ("right: nothing is missing", rate(told, _is("nothing_missing"))),
        ]
    else:
        clear = [row for row in told if row["reached"] >= CLEAR]
        lines += [
            ("a sure and wrong name", rate(told, wrong_names)),
            (f"rms from {CLEAR:g} of the dry friction: name", rate(clear, named)),
            (f"rms from {CLEAR:g}: class", rate(clear, classed)),
            (f"rms from {CLEAR:g}: the effect among the look-alikes", rate(clear, _among)),
            (f"rms from {CLEAR:g}: unexplained", rate(clear, _is("unexplained"))),
            (f"rms from {CLEAR:g}: silence", rate(clear, _is("nothing_missing"))),
        ]
    return table(("what", "measured (95 % Wilson interval)"), lines)


def _law(row):
    return bool(row.get("better_law"))


def _is(verdict):
    return lambda row: row["verdict"] == verdict


def _silent(row):
    return row["verdict"] in ("nothing_missing", "not_testable", "data_fault")


def _refused(row):
    return row["verdict"] in ("not_testable", "data_fault")


def _among(row):
    said = {name for cause in row["found"] for name in (cause["name"], *cause["look_alikes"])}
    return set(row["names"]) <= said


def _begins_right(row):
    return bool(row["found"]) and row["found"][0]["class"] in row["classes"]


def _each(rows):
    """Sessions that are lost or told wrongly, with their seeds."""
    lines = []
    for row in rows:
        lost = ", ".join(row["lost_kinds"])
        wrong = "verdict" in row and (wrong_names(row) or (not row["names"] and not _silent(row)))
        if not lost and not wrong:
            continue
        spec = row["spec"]
        found = ", ".join(c["name"] + ("" if c["decided"] else "?") for c in row.get("found", ()))
        said = f"{answer(row)}: {found}" if "verdict" in row else ""
        session = (
            f"{spec['law']} of {spec['contact']}, {spec['recordings']} recordings, "
            f"{1e3 * spec['dt']:g} ms, {spec['counts']} counts, log {spec['log_noise']:g}, "
            f"{spec['loop']}, {spec['drive']}"
        )
        lines.append((row["seed"], row["kind"], *(row["names"] or ["-"]), session, said, lost))
    if not lines:
        return ""
    head = ("seed", "kind", "hidden", "session", "said (? undecided)", "lost")
    return "Lost, or told wrongly:\n\n" + table(head, lines)
