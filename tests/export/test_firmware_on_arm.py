"""Exported C on a Cortex-M4F: cross-compiled as firmware is, run by an emulator."""

import shutil
import subprocess

import numpy as np
import pytest
from benches import firmware

from .test_firmware import NEAR_FLOAT, along, level_of, motion
from .test_steady import plant

SAMPLES = 400
STEPS = """
#include "stiction_feedforward.h"
static stiction_state state;
#define BEGIN stiction_init(&state)
#define STEP(v, dt, effort, load) stiction_step(&state, v, dt, effort, load, 25.0f)
"""
PROGRAM = """
#include "steps.h"
#include "motion.h"
static float friction[SAMPLES];
static void call(int number, int file, const void *data, int size)
{
    register int r0 __asm__("r0") = file;
    register const void *r1 __asm__("r1") = data;
    register int r2 __asm__("r2") = size;
    register int r7 __asm__("r7") = number;
    __asm__ volatile("svc 0" : "+r"(r0) : "r"(r1), "r"(r2), "r"(r7) : "memory");
}
void begin(void);
void begin(void)
{
    int k;
    BEGIN;
    for (k = 0; k < SAMPLES; ++k) {
        const float *m = motion_of[k];
        friction[k] = STEP(m[0], m[1], m[2], m[3]);
    }
    call(4, 1, friction, sizeof friction); /* write */
    call(1, 0, 0, 0); /* exit */
}
"""

needs_tools = pytest.mark.skipif(
    bool(firmware.missing()), reason=f"missing: {', '.join(firmware.missing())}"
)


def stepped_on_arm(folder, columns, steps, *sources):
    """Friction along a motion, by a program of bare metal; ``steps`` says how it steps."""
    rows = ",\n".join(f"{{{', '.join(float(x).hex() + 'f' for x in row)}}}" for row in columns.T)
    number = len(columns[0])
    header = f"#define SAMPLES {number}\nstatic const float motion_of[SAMPLES][4] = {{\n{rows}}};\n"
    (folder / "motion.h").write_text(header)
    (folder / "steps.h").write_text(steps)
    (folder / "main.c").write_text(PROGRAM)
    flags = [*firmware.FLAGS, "-Wall", "-Wextra", "-Werror"]
    link = [*firmware.LINK, "-o", "program.elf", "-lm"]
    command = ["arm-none-eabi-gcc", *flags, "main.c", *sources, *link]
    subprocess.run(command, cwd=folder, check=True)
    emulated = ["qemu-arm", "-cpu", firmware.CPU, folder / "program.elf"]
    done = subprocess.run(emulated, capture_output=True, check=True)
    return np.frombuffer(done.stdout, dtype="<f4").astype(float)


@needs_tools
@pytest.mark.parametrize("name", firmware.LAWS)
def test_a_law_steps_on_a_microcontroller(name, tmp_path):
    own = plant(firmware.friction_of(name))
    own.export("c").save(tmp_path)
    law = own.friction.model()
    columns = np.float32(motion(np.random.default_rng(5), law, SAMPLES))
    found = stepped_on_arm(tmp_path, columns, STEPS, "stiction_feedforward.c")
    core = along(law, *columns.astype(float))
    assert np.max(np.abs(found - core)) / level_of(law, core) < NEAR_FLOAT


@needs_tools
def test_what_a_step_takes_is_counted():
    cost = firmware.measured("coulomb")
    assert 5 < cost.slow < 100
    assert 5 < cost.turning < 100
    assert 50 < cost.flash < 1000
    assert cost.state == 4


def test_a_header_is_read_by_c_plus_plus(tmp_path):
    compiler = shutil.which("c++") or pytest.skip("no C++ compiler is installed")
    plant({"law": "maxwell_slip"}).export("c").save(tmp_path)
    (tmp_path / "main.cpp").write_text(
        '#include "stiction_feedforward.h"\nstiction_state state;\n'
        "int main() { stiction_init(&state); return 0; }\n"
    )
    flags = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]
    subprocess.run([compiler, *flags, str(tmp_path / "main.cpp")], check=True)
