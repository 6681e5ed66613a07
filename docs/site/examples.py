"""A runnable example of each law and effect, written from its record, with what it prints."""

from __future__ import annotations

import contextlib
import io
import json
from typing import Any, Final

import stiction as st
from stiction.catalogue import EffectRecord, LawRecord

from .effect_figure import ABOUT, DRIVEN, SERVO

__all__ = ["effect_example", "law_example", "printed"]

WIDEST: Final = 72
"""Characters of a line that show without scrolling."""
LAW: Final = """\
import numpy as np
import stiction as st

law = st.FrictionModel({name!r}{values})
time = np.linspace(0.0, 2.0, 4001)
velocity = 0.02 * np.sin(2.0 * np.pi * time)  # rad/s or m/s
friction = law.simulate(velocity, time[1])
print(f"friction between {{friction.min():.4g}} and {{friction.max():.4g}} N·m")
print({{name: np.shape(value) or round(float(value), 6) for name, value in law.state.items()}})
"""
EFFECT: Final = """\
import numpy as np
import stiction as st

plant = {plant}
effect = {effect}
time = np.arange(4000) * 1e-3
given = {given}
moved = []
for effects in ([], [effect]):
    machine = st.Plant.from_dict({{**plant, "effects": effects}})
    read = machine.simulate(given, 1e-3{channels}, outputs=["measured"])
    moved.append(read.measured)
off = np.sqrt(np.mean((moved[1] - moved[0]) ** 2))
print(f"without the effect the reading is off by {{1e3 * off:.4g}} mrad rms over 4 s")
"""
GIVEN: Final = {
    False: "0.35 * np.sin(2.0 * np.pi * time) + 0.25 * np.sin(7.0 * np.pi * time)  # N·m",
    True: "0.8 * np.sign(np.sin(np.pi * time))  # the goal, rad",
}


def law_example(record: LawRecord) -> str:
    """Code that moves a contact with this law to and fro.

    Parameters
    ----------
    record : LawRecord
    """
    stated = {each.name: each.typical for each in record.parameters if not each.optional}
    values = "".join(f", {name}={value:g}" for name, value in stated.items())
    return wrapped(LAW.format(name=record.name, values=values))


def effect_example(record: EffectRecord) -> str:
    """Code that simulates a machine with this effect and without it.

    Parameters
    ----------
    record : EffectRecord
    """
    servo = bool(record.impossible("rotary", servo=False))
    plant: dict[str, Any] = SERVO if servo else DRIVEN
    effect = {"name": record.name} | {each.name: each.typical for each in record.parameters}
    channels = "".join(
        f", {name}=np.full(4000, {ABOUT[name] or 0.2:g})"
        for name in record.channels
        if name in ABOUT
    )
    return EFFECT.format(
        plant=laid_out(plant),
        effect=laid_out(effect),
        given=GIVEN[servo],
        channels=channels,
    )


def laid_out(table: dict[str, Any]) -> str:
    """A dict as one would write it: an entry a line."""
    lines = []
    for key, value in table.items():
        line = f"    {json.dumps(key)}: {json.dumps(value)},"
        if len(line) > WIDEST and isinstance(value, dict):
            within = [f"        {json.dumps(k)}: {json.dumps(v)}," for k, v in value.items()]
            line = "\n".join([f"    {json.dumps(key)}: {{", *within, "    },"])
        lines.append(line)
    return "\n".join(["{", *lines, "}"])


def wrapped(code: str) -> str:
    """Code whose call of a law with many numbers goes over several lines."""
    lines = []
    for line in code.splitlines():
        if len(line) > WIDEST and line.startswith("law = "):
            head, _, rest = line.partition("(")
            arguments = rest.removesuffix(")").split(", ")
            line = "\n".join([f"{head}(", *(f"    {each}," for each in arguments), ")"])
        lines.append(line)
    return "\n".join(lines) + "\n"


def printed(code: str) -> str:
    """What code prints when it is run by itself."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(code, "example", "exec"), {"st": st})
    return out.getvalue()
