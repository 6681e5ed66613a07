"""What a module asks of an effect it asks of the effect's record, and not by its name."""

from __future__ import annotations

import ast
from pathlib import Path

import stiction as st

PACKAGE = Path(st.__file__).parent

TABLES: dict[str, tuple[int, str]] = {
    "bam/format.py": (2, "the effects that models of another tool hold"),
    "bench/ordinary/hidden.py": (11, "what each hides in a machine that knows no catalogue"),
    "compare/document.py": (3, "properties of laws that are called as effects are"),
    "compare/properties/sliding.py": (2, "properties of laws that are called as effects are"),
    "diagnosis/findings/presentation.py": (30, "the entry of each effect"),
    "export/mjcf.py": (4, "the effects that simulators have elements for"),
    "ode.py": (3, "the formula of each"),
    "paper/local.py": (1, "the effect that an experiment is simulated with"),
    "plant/steady.py": (1, "a family that is called as one of its effects is"),
}
"""Names that may stand in a file, and why: the tables themselves. None is added without need."""


def literals(path: Path) -> list[str]:
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
    values = (node.value for node in nodes if isinstance(node, ast.Constant))
    return [value for value in values if isinstance(value, str) and value in st.effects()]


def test_effects_are_named_in_tables_alone() -> None:
    found = {
        path.relative_to(PACKAGE).as_posix(): len(names)
        for path in sorted(PACKAGE.rglob("*.py"))
        if (names := literals(path))
    }
    assert found == {name: number for name, (number, _) in TABLES.items()}


def test_every_effect_has_an_entry() -> None:
    assert sorted(literals(PACKAGE / "diagnosis" / "findings" / "presentation.py")) == sorted(
        st.effects().names
    )


def test_properties_tell_the_effects_that_are_meant() -> None:
    meant = {
        "constant": ["torque_bias"],
        "falls": ["stribeck"],
        "friction_lags": ["frictional_lag"],
        "limits": ["drive_saturation", "voltage_limit"],
        "misreads": ["encoder_eccentricity"],
        "over_speed": ["stribeck", "viscous_quadratic"],
        "second": ["cogging", "position_dependent_friction", "torque_constant_ripple"],
        "two_levels": ["direction_asymmetry"],
        "weighs": ["gravity_unbalance"],
    }
    for asked, names in meant.items():
        assert [each.name for each in st.effects() if getattr(each, asked)] == names, asked
