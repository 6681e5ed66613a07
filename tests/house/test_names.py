"""No function is named by a participle: what it does is a verb, what it returns a noun."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "python" / "stiction"

IRREGULAR = frozenset(
    [
        "bent",
        "bet",
        "born",
        "bound",
        "bought",
        "broken",
        "brought",
        "built",
        "caught",
        "chosen",
        "come",
        "dealt",
        "done",
        "drawn",
        "driven",
        "felt",
        "flown",
        "forgotten",
        "found",
        "given",
        "gone",
        "grown",
        "heard",
        "held",
        "hidden",
        "hung",
        "kept",
        "known",
        "laid",
        "led",
        "left",
        "lent",
        "lost",
        "made",
        "meant",
        "met",
        "mown",
        "paid",
        "ridden",
        "risen",
        "said",
        "seen",
        "sent",
        "set",
        "shaken",
        "shown",
        "slid",
        "sold",
        "sought",
        "spent",
        "spoken",
        "spun",
        "stood",
        "struck",
        "sunk",
        "swept",
        "swung",
        "taken",
        "taught",
        "thought",
        "thrown",
        "told",
        "torn",
        "unstuck",
        "stuck",
        "understood",
        "woken",
        "won",
        "worn",
        "wound",
        "written",
    ]
)
"""Past participles that do not end in -ed. Those that are verbs as they stand (read, run, split,
fit, put, cut, spread) name what a function does."""

NOUNS = frozenset(
    [
        "bearing",
        "bound",
        "ceiling",
        "clipping",
        "drawing",
        "feed",
        "hardening",
        "heading",
        "mapping",
        "meaning",
        "need",
        "presliding",
        "reading",
        "recording",
        "ring",
        "rounding",
        "sampling",
        "seed",
        "setting",
        "sliding",
        "speed",
        "spring",
        "string",
        "timing",
        "tracking",
    ]
)
"""Nouns, and what only ends like a participle."""

PARTICLES = frozenset(
    [
        "again",
        "alone",
        "anyway",
        "apart",
        "around",
        "as",
        "at",
        "before",
        "behind",
        "beside",
        "between",
        "beyond",
        "by",
        "for",
        "from",
        "in",
        "into",
        "last",
        "of",
        "off",
        "on",
        "once",
        "only",
        "out",
        "over",
        "round",
        "soon",
        "through",
        "to",
        "together",
        "under",
        "up",
        "wide",
        "wider",
        "with",
        "within",
        "where",
        "without",
    ]
)

PUBLIC = {
    "closed_loop:Controller.acting",
    "compensation:Compensation.stepped",
    "demo_session:hidden",
    "diagnosis.findings.result:Diagnosis.gap_closed",
    "library.comparison:UnitComparison.differing",
    "library.comparison:UnitComparison.left",
    "library.entry_file:EntryNumber.expected",
    "plant.plant:Plant.following",
    "plot:thinned",
    "recording.recording:Recording.entered",
    "recording.table:Table.renamed",
    "residual.effort:started",
    "robot.fit:RobotFit.carried",
}
"""Documented to users under these names, which stay valid."""


def is_participle(word: str) -> bool:
    if word in NOUNS:
        return False
    return word in IRREGULAR or (len(word) > 4 and word.endswith(("ed", "ing")))


def is_named_by_a_participle(name: str) -> bool:
    """Whether a participle stands for the whole name: before a noun it only describes that one.

    So ``held`` and ``led_by``, but neither ``known_unit`` nor ``is_missing``.
    """
    words = name.split("_")
    if words[0] in ("is", "has", "are"):
        return False
    following = [*words[1:], ""]
    return any(
        is_participle(word) and (not after or after in PARTICLES)
        for word, after in zip(words, following, strict=True)
    )


FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef)


def functions(tree: ast.Module) -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef]]:
    """Public functions and methods of a module, with the names of their classes."""
    stack: list[tuple[str, ast.stmt]] = [("", node) for node in tree.body]
    while stack:
        owner, node = stack.pop()
        if isinstance(node, ast.ClassDef):
            stack += [(f"{owner}{node.name}.", each) for each in node.body]
        elif isinstance(node, ast.If | ast.Try):
            stack += [(owner, each) for each in (*node.body, *node.orelse)]
        elif isinstance(node, FUNCTIONS) and not node.name.startswith("_"):
            yield owner + node.name, node


def is_an_adjective(node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Whether it is a property that says yes or no: ``choice.decided`` reads as it should."""
    decorators = [ast.unparse(each) for each in node.decorator_list]
    is_property = any(each.endswith(("property", ".setter")) for each in decorators)
    return is_property and ast.unparse(node.returns or ast.Constant("")) == "bool"


def test_no_function_is_named_by_a_participle() -> None:
    found = set()
    for path in sorted(PACKAGE.rglob("*.py")):
        module = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        module = module.removesuffix(".__init__")
        for name, node in functions(ast.parse(path.read_text("utf-8"))):
            if is_named_by_a_participle(node.name) and not is_an_adjective(node):
                found.add(f"{module}:{name}")
    assert found - PUBLIC == set(), "say what it does, or what it returns"
    assert found >= PUBLIC, "what is gone needs no exception"


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("told", True),
        ("as_read", False),
        ("led_by", True),
        ("left_out", True),
        ("lost_on_test", True),
        ("gained_again", True),
        ("wait_until_finished", True),
        ("known_unit", False),
        ("undetermined_directions", False),
        ("starting_velocity", False),
        ("is_missing", False),
        ("feed_forward", False),
        ("reading", False),
        ("setting", False),
        ("speed_of", False),
        ("read_table", False),
        ("split", False),
    ],
)
def test_a_participle_before_a_noun_is_no_name_by_a_participle(name: str, told: bool) -> None:
    assert is_named_by_a_participle(name) is told
