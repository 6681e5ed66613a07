"""C99 of a plant: a step of its contact, its feed-forward and an observer of what is left."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from .fragments import Fragments, known

if TYPE_CHECKING:
    from ..plant import Plant
    from ..stated import Effect

__all__ = ["Firmware"]

TYPES: Final = re.compile(r"^typedef [^;{}]*(?:\{(?:(?!^\}).)*\})? ?(stiction_\w+);\n", re.M | re.S)
MATHS: Final = re.compile(r"\br_(\w+)\(")
RUNNING: Final = {
    "POSITION": ("position", "since stiction_init, by the velocity; see stiction_set_position"),
    "TIME": ("time", "since stiction_init, s"),
    "PATH": ("path", "travelled since stiction_init"),
}
"""What a state sums up where a fragment asks for it."""


@dataclass(frozen=True)
class Firmware:
    """C of a plant.

    Attributes
    ----------
    source : str
        What comes after the head of the file.
    header : str
    steps : bool
        Whether the law has C, so that there is a step.
    held : tuple of str
        Effects of the plant that the step holds.
    """

    source: str
    header: str
    steps: bool
    held: tuple[str, ...]

    @classmethod
    def of(cls, plant: Plant, curves: Mapping[str, Any]) -> Firmware:
        """Of a plant and the constants of its feed-forward."""
        zero = plant.body.get("gravity_zero_rad")
        numbers = {
            "PI": math.pi,
            "LN_2": math.log(2.0),
            "GRAVITY": plant.gravity,
            "GRAVITY_ZERO": 0.0 if zero is None else zero.value,
            "WEIGHT_FORCE": plant.weight,
            "HANGS": plant.gravity != 0.0 or plant.weight != 0.0,
        }
        fragments = Fragments({**numbers, **curves})
        steps = plant.friction.law in known("laws")
        effects = tuple(e for e in plant.effects if steps and e.name in known("effects"))
        step, types = _step(plant, effects, fragments) if steps else ("", "")
        text = step + "\n".join(map(fragments.expand, ("feedforward", "gravity", "observer")))
        header = fragments.expand("header").replace("@types@\n", types)
        source = _head(text) + fragments.constants(text) + "\n" + text
        return cls(_spaced(source), _spaced(header), steps, tuple(e.name for e in effects))


def _spaced(text: str) -> str:
    """A text as a compiler gets it, with no more than one empty line at a time."""
    return re.sub(r"\n{3,}", "\n\n", re.sub(r"^# ", "#", text, flags=re.M))


def _step(plant: Plant, effects: tuple[Effect, ...], fragments: Fragments) -> tuple[str, str]:
    """Source of the step, and the types of the header."""
    model = plant.friction.model()
    fragments.numbers |= {name.upper(): value for name, value in model.parameters.items()}
    fragments.numbers |= {name.upper(): word for name, word in model.options.items()}
    contact = fragments.expand(f"laws/{plant.friction.law}")
    for effect in effects:
        fragments.numbers |= _numbers_of(effect)
        contact += "\n" + fragments.expand(f"effects/{effect.name}")
    fragments.hooks = _hooks(contact, effects)
    fragments.flags |= {flag for flag, (name, _) in RUNNING.items() if f"s->{name}" in contact}
    sums = [flag for flag in RUNNING if flag in fragments.flags]
    levels = {"level", "viscous_level"} & fragments.hooks.keys()
    drags = model.parameters.get("viscous", 0.0) != 0.0 and "OWN_VISCOUS" not in fragments.flags
    there = {
        "SUMS": sums,
        "LEVELS": levels,
        "USES_WAY": "WAY(" in contact,
        "USES_SPEED": "SPEED *" in contact,
        "CREEPS_BESIDE": "creep" in fragments.hooks,
        "EFFORTS": "effort" in fragments.hooks,
        "TEMPERATURE": "m->temperature" in contact,
        "DRAGS": drags,
        "LAW_INIT": "law_init(" in contact,
        "STEPS": True,
    }
    fragments.flags |= {flag for flag, any_of_it in there.items() if any_of_it}
    types = [found[0] for found in TYPES.finditer(contact)]
    source = (
        fragments.expand("motion") + "\n" + TYPES.sub("", contact) + "\n" + fragments.expand("step")
    )
    return source + "\n", _types(types, sums, effects)


def _numbers_of(effect: Effect) -> dict[str, float]:
    """Parameters of an effect as its fragment calls them."""
    stated = {name: parameter.value for name, parameter in effect.parameters.items()}
    return {
        f"{effect.name}_{record.name.upper()}": stated.get(record.name, record.default)
        for record in effect.record.parameters
    }


def _hooks(contact: str, effects: tuple[Effect, ...]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    names = {effect.name for effect in effects}
    for match in re.finditer(r"^static \w+ (\w+)\(", contact, re.M):
        for hook in ("init", "remember", "viscous_level", "level", "effort", "creep"):
            name = match[1].removesuffix(f"_{hook}")
            if match[1].endswith(f"_{hook}") and name in names:
                found.setdefault(hook, []).append(name)
                break
    return found


def _types(types: list[str], sums: list[str], effects: tuple[Effect, ...]) -> str:
    """What a contact remembers, for the header."""
    text = "".join(f"\n{each}" for each in types)
    if "STICTION_REVERSALS" in text:
        text = f"\n{REVERSALS}" + text
    own = [f"    stiction_{e.name} {e.name};" for e in effects if f" stiction_{e.name};" in text]
    if " stiction_law;" in text:
        own.insert(0, "    stiction_law law;")
    if "int32_t" in text:
        text = "\n#include <stdint.h>\n" + text
    if sums:
        text += "\ntypedef struct {\n    STICTION_REAL value, rest;\n} stiction_sum;\n"
    own += [f"    stiction_sum {RUNNING[f][0]}; /* {RUNNING[f][1]} */" for f in sums]
    own.append("    STICTION_REAL friction; /* of the law, at the end of the last step */")
    return text + "\ntypedef struct {\n" + "\n".join(own) + "\n} stiction_state;\n"


REVERSALS: Final = """\
/* Reverse points that a contact remembers; beside more, those that tell least are forgotten. */
#ifndef STICTION_REVERSALS
#define STICTION_REVERSALS 32
#endif
"""


def _head(text: str) -> str:
    """Number type and the functions of math.h that a text asks for."""
    lines = [
        "#include <math.h>",
        "",
        "typedef STICTION_REAL real;",
        "#define R(x) ((real)(x))",
        "#define IS_FLOAT (sizeof(real) == sizeof(float))",
    ]
    if "EPSILON" in text:
        lines.append("#define EPSILON ((real)(IS_FLOAT ? 1.1920929e-7 : 2.220446049250313e-16))")
    for name in sorted(set(MATHS.findall(text))):
        many = name in ("hypot", "pow")
        given = "real x, real y" if many else "real x"
        single, double = (
            ("(float)x, (float)y", "(double)x, (double)y") if many else ("(float)x", "(double)x")
        )
        lines += [
            f"static real r_{name}({given})",
            "{",
            f"    return IS_FLOAT ? (real){name}f({single}) : (real){name}({double});",
            "}",
        ]
    return "\n".join(lines) + "\n\n"
