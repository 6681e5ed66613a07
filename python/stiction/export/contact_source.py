"""C of a contact: its law and its effects as their fragments say them, with one plant's numbers."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from .fragments import Fragments, names_of

if TYPE_CHECKING:
    from ..plant import Plant
    from ..plant.stated import Effect

__all__ = [
    "ContactSource",
    "collapse_blank_lines",
    "numbers_of",
    "plant_numbers",
    "prologue",
    "structures_of",
]

TYPES: Final = re.compile(r"^typedef [^;{}]*(?:\{(?:(?!^\}).)*\})? ?(stiction_\w+);\n", re.M | re.S)
MATHS: Final = re.compile(r"\br_(\w+)\(")
HOOKS: Final = ("init", "remember", "viscous_level", "level", "effort", "creep", "input")
RUNNING: Final = {
    "POSITION": ("position", "since stiction_init, by the velocity; see stiction_set_position"),
    "TIME": ("time", "since stiction_init, s"),
    "PATH": ("path", "travelled since stiction_init"),
}
"""What a state sums up where a fragment asks for it."""


@dataclass(frozen=True)
class ContactSource:
    """C of a contact.

    Attributes
    ----------
    source : str
        The motion that reaches it, its law and its effects.
    types : str
        What it remembers, for a header.
    effects : tuple of str
        Of the plant, that it has.
    """

    source: str
    types: str
    effects: tuple[str, ...]

    @classmethod
    def of(cls, plant: Plant, fragments: Fragments, *, driven: bool = False) -> ContactSource:
        """Of a plant whose law has C; numbers, hooks and flags come to the fragments.

        ``driven`` says whether effects of the drive come with it.
        """
        model = plant.friction.model()
        fragments.numbers |= {name.upper(): value for name, value in model.parameters.items()}
        fragments.numbers |= {name.upper(): word for name, word in model.options.items()}
        folders = ("effects", "drive") if driven else ("effects",)
        places = {name: folder for folder in folders for name in names_of(folder)}
        effects = tuple(each for each in plant.effects if each.name in places)
        law = fragments.expand(f"laws/{plant.friction.law}")
        contact = law
        for effect in effects:
            fragments.numbers |= numbers_of(effect)
            contact += "\n" + fragments.expand(f"{places[effect.name]}/{effect.name}")
        fragments.hooks = _hooks(contact, {effect.name for effect in effects})
        fragments.flags |= {flag for flag, (name, _) in RUNNING.items() if f"s->{name}" in contact}
        sums = [flag for flag in RUNNING if flag in fragments.flags]
        drags = model.parameters.get("viscous", 0.0) != 0.0
        there = {
            "SUMS": sums,
            "LEVELS": {"level", "viscous_level"} & fragments.hooks.keys(),
            "USES_WAY": "WAY(" in contact,
            "USES_SPEED": "SPEED *" in contact,
            "USES_VELOCITY": "m->velocity" in law,
            "CREEPS_BESIDE": "creep" in fragments.hooks,
            "APART": "creep" in fragments.hooks or "MACHINE" in fragments.flags,
            "EFFORTS": "effort" in fragments.hooks,
            "REMEMBERS": "remember" in fragments.hooks,
            "TEMPERATURE": "m->temperature" in contact,
            "DRAGS": drags and "OWN_VISCOUS" not in fragments.flags,
            "LAW_INIT": "law_init(" in contact,
            "HAS_BREAKS": "law_breaks(" in contact,
            "STEPS": True,
        }
        fragments.flags |= {flag for flag, any_of_it in there.items() if any_of_it}
        types = [found[0] for found in TYPES.finditer(contact)]
        source = fragments.expand("motion") + "\n" + TYPES.sub("", contact)
        names = tuple(effect.name for effect in effects)
        moves = "MACHINE" in fragments.flags
        return cls(source, _types(types, sums, names, moves=moves), names)


def plant_numbers(plant: Plant) -> dict[str, float]:
    """Numbers of a plant beside its contact, as fragments call them."""
    zero = plant.body.get("gravity_zero_rad")
    return {
        "PI": math.pi,
        "LN_2": math.log(2.0),
        "GRAVITY": plant.gravity,
        "GRAVITY_ZERO": 0.0 if zero is None else zero.value,
        "WEIGHT_FORCE": plant.weight,
        "HANGS": plant.gravity != 0.0 or plant.weight != 0.0,
        "INERTIA": 0.0 if plant.prescribed_motion else plant.inertia,
        "GAIN": plant.gain,
    }


def numbers_of(effect: Effect) -> dict[str, float]:
    """Parameters of an effect as its fragment calls them."""
    stated = {name: parameter.value for name, parameter in effect.parameters.items()}
    return {
        f"{effect.name}_{record.name.upper()}": stated.get(record.name, record.default)
        for record in effect.record.parameters
    }


def collapse_blank_lines(text: str) -> str:
    """A text as a compiler gets it, with no more than one empty line at a time."""
    return re.sub(r"\n{3,}", "\n\n", re.sub(r"^# ", "#", text, flags=re.M))


def structures_of(header: str) -> str:
    """What a contact remembers, of a header, without what is the compiler's business."""
    reversals = re.findall(r"^#define STICTION_REVERSALS \d+\n", header, re.M)
    return "".join([*reversals, *(found[0] for found in TYPES.finditer(header))])


def prologue(text: str) -> str:
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


def _hooks(contact: str, names: set[str]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for match in re.finditer(r"^static \w+ (\w+)\(", contact, re.M):
        for hook in HOOKS:
            name = match[1].removesuffix(f"_{hook}")
            if match[1].endswith(f"_{hook}") and name in names:
                found.setdefault(hook, []).append(name)
                break
    return found


def _types(types: list[str], sums: list[str], effects: tuple[str, ...], *, moves: bool) -> str:
    """What a contact remembers, for the header."""
    text = "".join(f"\n{each}" for each in types)
    if "STICTION_REVERSALS" in text:
        text = f"\n{REVERSALS}" + text
    own = [f"    stiction_{name} {name};" for name in effects if f" stiction_{name};" in text]
    if " stiction_law;" in text:
        own.insert(0, "    stiction_law law;")
    if "int32_t" in text:
        text = "\n#include <stdint.h>\n" + text
    if sums:
        text += "\ntypedef struct {\n    STICTION_REAL value, rest;\n} stiction_sum;\n"
    own += [f"    stiction_sum {RUNNING[f][0]}; /* {RUNNING[f][1]} */" for f in sums]
    if moves:
        own.append("    STICTION_REAL moved; /* since effects took a sample into their memory */")
    own.append("    STICTION_REAL friction; /* of the law, at the end of the last step */")
    return text + "\ntypedef struct {\n" + "\n".join(own) + "\n} stiction_state;\n"


REVERSALS: Final = """\
/* Reverse points that a contact remembers; beside more, those that tell least are forgotten. */
#ifndef STICTION_REVERSALS
#define STICTION_REVERSALS 32
#endif
"""
