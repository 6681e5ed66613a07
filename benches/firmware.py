"""Exported C on a Cortex-M4F: instructions a step and bytes of flash, at -Os in floats.

Compiled for bare metal and run by an emulator, one instruction at a time, which counts what is
executed, the functions of math.h with it. Needs arm-none-eabi-gcc with newlib, and qemu-arm; on
Debian: apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-user.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import stiction as st

LAWS = ("coulomb", "dahl", "lugre", "maxwell_slip", "gms", "hsieh_pan")
CORE = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"]
FLAGS = [
    *CORE,
    "-std=c99",
    "-Os",
    "-ffunction-sections",
    "-fdata-sections",
    "-DSTICTION_REAL=float",
]
LINK = ["-nostartfiles", "--specs=nosys.specs", "-Wl,--gc-sections", "-Wl,-e,begin"]
CPU = "cortex-a15"
"""Runs the same Thumb instructions as they are; the emulator has no M core for programs."""
SAMPLES = 1000
TOOLS = ("arm-none-eabi-gcc", "arm-none-eabi-size", "qemu-arm")
PROGRAM = """
#include "stiction_feedforward.h"
stiction_state state;
volatile float friction;
void begin(void)
{
    int k;
    float v = 0.0f, push = 1e-4f;
    stiction_init(&state);
    for (k = 0; k < SAMPLES; ++k) {
        friction = STEP(&state, v, 1e-3f, 0.1f, 0.0f, 25.0f);
        push = k % 100 == 25 || k % 100 == 75 ? -push : push;
        v = SLIDES ? (k % 2 ? 0.5f : -0.5f) : v + push;
    }
    __asm__ volatile("mov r7, #1\\n mov r0, #0\\n svc 0"); /* exit of the emulator */
}
"""


def friction_of(law: str) -> dict[str, str | float]:
    """The table of a law: by default, the paper's model with its hook."""
    return {"law": law} | ({"breakaway": 0.5} if law == "hsieh_pan" else {})


def program(law: str, folder: Path, *, steps: bool = True, slides: bool = False) -> Path:
    """A program that takes steps of a law, or none in as many turns.

    It creeps to and fro, or ``slides``: each step turns a fast slide round.
    """
    table = {
        "drive": {"input": "torque_nm", "gain": 1.0},
        "body": {"inertia": 0.01},
        "friction": friction_of(law),
    }
    st.Plant.from_dict(table).export("c").save(folder)
    step = "stiction_step(a, b, c, d, e, f)" if steps else "((a)->friction + (b))"
    defined = {"STEP(a, b, c, d, e, f)": step, "SAMPLES": SAMPLES, "SLIDES": int(slides)}
    text = "".join(f"#define {name} {value}\n" for name, value in defined.items()) + PROGRAM
    if not steps:
        text = text.replace("stiction_init(&state);", "")
    (folder / "main.c").write_text(text)
    built = folder / "program.elf"
    sources = ["main.c", "stiction_feedforward.c"]
    link = [*LINK, "-o", built.name, "-lm"]
    subprocess.run(["arm-none-eabi-gcc", *FLAGS, *sources, *link], cwd=folder, check=True)
    return built


def flash(built: Path) -> int:
    """Bytes of code and constants."""
    done = subprocess.run(["arm-none-eabi-size", built], capture_output=True, text=True, check=True)
    return int(done.stdout.splitlines()[1].split()[0])


def instructions(built: Path) -> int:
    """Instructions of a whole run, one a line of the emulator's log."""
    log = built.with_suffix(".log")
    command = ["qemu-arm", "-cpu", CPU, "-singlestep", "-d", "exec,nochain", "-D", log, built]
    subprocess.run(command, check=True)
    with log.open("rb") as lines:
        count = sum(line.startswith(b"Trace") for line in lines)
    log.unlink()
    return count


@dataclass(frozen=True)
class Cost:
    """Of a step: instructions in slow motion and where a slide turns, bytes of flash and state.

    Functions of math.h count.
    """

    slow: float
    turning: float
    flash: int
    state: int


def measured(law: str) -> Cost:
    """What a step of a law takes."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bare = program(law, folder, steps=False)
        nothing, without = instructions(bare), flash(bare)
        slow = (instructions(program(law, folder)) - nothing) / SAMPLES
        whole = program(law, folder, slides=True)
        turning = (instructions(whole) - nothing) / SAMPLES
        return Cost(slow, turning, flash(whole) - without, state_size(folder))


def state_size(folder: Path) -> int:
    """Bytes of a state, from the symbols of the program."""
    done = subprocess.run(
        ["arm-none-eabi-nm", "-S", folder / "program.elf"],
        capture_output=True,
        text=True,
        check=True,
    )
    found = re.search(r"^\w+ (\w+) [bB] state$", done.stdout, re.M)
    return int(found[1], 16) if found else 0


def missing() -> list[str]:
    """Tools that are not there."""
    return [tool for tool in TOOLS if shutil.which(tool) is None]


def main() -> None:
    """Print a row for each law of the command line, or of the table in docs/export.md."""
    if missing():
        sys.exit(f"not run: {', '.join(missing())} missing; see the head of this file")
    print("law                  slow  turning  flash  state")
    for law in sys.argv[1:] or LAWS:
        cost = measured(law)
        print(f"{law:17} {cost.slow:7.0f} {cost.turning:8.0f} {cost.flash:6} {cost.state:6}")


if __name__ == "__main__":
    main()
