"""The Rust of each law and each effect, built without std and stepped along a motion."""

import ctypes
import re
import shutil
import subprocess

import numpy as np
import pytest

import stiction as st
from stiction.export.fragments import names_of
from stiction.export.translation import TranslationError, parse, rust_of

from .test_firmware import LAWS, NEAR, NEAR_FLOAT, along, level_of, motion, record_of, tables
from .test_firmware_on_arm import firmware, needs_tools, stepped_on_arm
from .test_steady import plant

SAMPLES = 2000
ARMED = "thumbv7em-none-eabihf"
DRIVER = """
#[no_mangle]
pub unsafe extern "C" fn {name}(n: usize, columns: *const Real, friction: *mut Real) {{
    let columns = core::slice::from_raw_parts(columns, 5 * n);
    let friction = core::slice::from_raw_parts_mut(friction, n);
    let mut contact = {name}::Contact::new();
    for k in 0..n {{
        let at = |column: usize| columns[column * n + k];
        friction[k] = contact.step(at(0), at(1), at(2), at(3), at(4));
    }}
}}
"""


def effects():
    return [
        {"name": each.name, **{p.name: p.typical for p in each.parameters}}
        for each in st.effects()
        if each.name in names_of("effects")
    ]


def typical_of(law):
    return {"law": law, **{each.name: each.typical for each in record_of(law).parameters}}


def with_options(law):
    number = 2 + sum(len(option.choices) - 1 for option in record_of(law).options)
    return {f"{law}_{k}": plant(tables(law)[k]) for k in range(number)}


def built(folder, plants, *flags):
    """A library that steps each of the plants, by their names."""
    cargo = shutil.which("cargo") or pytest.skip("no cargo is installed")
    names = list(plants)
    for name, own in plants.items():
        made = own.export("rust")
        made.save(folder / name)
        text = made.files["Cargo.toml"].replace("stiction_plant", name)
        (folder / name / "Cargo.toml").write_text(text)
    (folder / "Cargo.toml").write_text(
        f"[workspace]\nmembers = {[*names, 'driver']}\nresolver = '2'\n"
        "[profile.dev]\nopt-level = 1\ndebug = false\noverflow-checks = true\n"
    )
    (folder / "driver").mkdir()
    needed = "".join(f'{name} = {{ path = "../{name}" }}\n' for name in names)
    features = ", ".join(f'"{name}/f32"' for name in names)
    (folder / "driver" / "Cargo.toml").write_text(
        '[package]\nname = "driver"\nversion = "0.1.0"\nedition = "2021"\n'
        '[lib]\npath = "lib.rs"\ncrate-type = ["cdylib"]\n'
        f"[features]\nf32 = [{features}]\n[dependencies]\n{needed}"
    )
    text = f"use {names[0]}::Real;\n" + "".join(DRIVER.format(name=name) for name in names)
    (folder / "driver" / "lib.rs").write_text(text)
    command = [cargo, "build", "--quiet", "--package", "driver", *flags]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if "failed to download" in done.stderr or "failed to get `libm`" in done.stderr:
        pytest.skip("libm cannot be fetched here")
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr, done.stderr
    files = (folder / "target" / "debug").glob("libdriver.*")
    return ctypes.CDLL(str(next(file for file in files if file.suffix in (".so", ".dylib"))))


def stepped(library, name, columns, number=np.float64):
    n = len(columns[0])
    rows = np.array([np.broadcast_to(each, n) for each in columns], dtype=number)
    friction = np.zeros(n, dtype=number)
    pointers = [each.ctypes.data_as(ctypes.c_void_p) for each in (rows, friction)]
    getattr(library, name)(ctypes.c_size_t(n), *pointers)
    return friction.astype(float)


@pytest.fixture(scope="module")
def laws(tmp_path_factory):
    plants = {law: plant(typical_of(law)) for law in LAWS}
    return built(tmp_path_factory.mktemp("laws"), plants)


@pytest.mark.parametrize("law", LAWS)
def test_each_law_steps_as_the_core_does(law, laws):
    model = plant(typical_of(law)).friction.model()
    columns = motion(np.random.default_rng(len(law)), model, SAMPLES)
    core = along(model, *columns)
    found = stepped(laws, law, (*columns, np.nan))
    off = np.max(np.abs(found - core)) / level_of(model, core)
    assert off < NEAR, off


@pytest.mark.parametrize("law", LAWS)
def test_a_step_ends_whatever_it_is_given(law, laws):
    for velocity in (np.nan, 1e6, -1e-300, np.inf):
        stepped(laws, law, ([1e-3, velocity, -1e-3, 0.0], 1e-3, 0.0, 0.0, np.nan))
    found = stepped(laws, law, ([1e-3, 1e6, -1e6, 1e-300, 0.0], 1e-3, 0.0, 0.0, np.nan))
    assert np.all(np.isfinite(found))


@pytest.fixture(scope="module")
def contacts(tmp_path_factory):
    """All effects at once, with each law."""
    plants = {law: plant({"law": law, "viscous": 0.05}, *effects()) for law in LAWS}
    return built(tmp_path_factory.mktemp("contacts"), plants)


@pytest.mark.parametrize("law", LAWS)
def test_all_effects_go_with_every_law(law, contacts):
    own = plant({"law": law, "viscous": 0.05}, *effects())
    model = own.friction_model()
    columns = motion(np.random.default_rng(len(law)), own.friction.model(), SAMPLES)
    velocity, dt, effort, load = columns
    core = np.array(
        [
            model.step(float(v), float(t), effort=float(e), load=float(q), temperature=30.0)
            for v, t, e, q in zip(velocity, dt, effort, load, strict=True)
        ]
    )
    found = stepped(contacts, law, (*columns, 30.0))
    off = np.max(np.abs(found - core)) / level_of(own.friction.model(), core)
    assert off < NEAR, off


@pytest.mark.slow
def test_options_and_defaults_step_as_the_core_does(tmp_path):
    plants = {name: own for law in LAWS for name, own in with_options(law).items()}
    library = built(tmp_path, plants)
    for k, (name, own) in enumerate(plants.items()):
        model = own.friction.model()
        columns = motion(np.random.default_rng(k), model, SAMPLES)
        core = along(model, *columns)
        off = np.max(np.abs(stepped(library, name, (*columns, np.nan)) - core))
        assert off / level_of(model, core) < NEAR, (name, off)


@pytest.mark.slow
def test_each_law_steps_in_floats(tmp_path):
    plants = {law: plant({"law": law}) for law in LAWS}
    library = built(tmp_path, plants, "--features", "f32")
    for law, own in plants.items():
        model = own.friction.model()
        columns = motion(np.random.default_rng(7), model, SAMPLES)
        rounded = [np.float32(each).astype(float) for each in columns]
        core = along(model, *rounded)
        found = stepped(library, law, (*rounded, np.nan), np.float32)
        off = np.max(np.abs(found - core)) / level_of(model, core)
        assert off < NEAR_FLOAT, (law, off)


def test_the_crate_is_plain_rust_without_std():
    dry = {"law": "coulomb", "coulomb": 0.3}
    text = plant({"law": "hsieh_pan", "breakaway": 0.5}).export("rust").files
    assert "#![no_std]\n#![forbid(unsafe_code)]" in text["lib.rs"]
    assert not re.search(r"\b(alloc|std::|Vec|Box)\b", text["plant.rs"] + text["math.rs"])
    told = plant(dry, {"name": "input_delay", "delay": 0.01}).export("rust")
    assert any(each.startswith("input_delay:") for each in told.lost)
    assert "//! - input_delay:" in told.files["lib.rs"]


def test_feed_forward_and_observer_are_those_of_the_c(tmp_path):
    rustc = shutil.which("cargo") or pytest.skip("no cargo is installed")
    own = plant(
        {"law": "coulomb", "coulomb": 0.3, "viscous": 0.02},
        {"name": "cogging", "cosine": 0.04, "order": 6.0},
        body={"inertia": 0.01, "gravity_amplitude": 0.2},
        drive={"input": "current_a", "gain": 0.5},
    )
    own.export("rust").save(tmp_path)
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests" / "plant.rs").write_text(
        """
use stiction_plant::*;
#[test]
fn steps() {
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    near(feedforward(1.0, 5.0, 0.3), friction(1.0) + 0.05 + place(0.3));
    near(input(1.0), 2.0);
    near(gravity(0.7), -0.2 * 0.7f64.sin());
    let mut contact = Contact::default();
    contact.set_position(0.5);
    near(contact.step(0.0, 1e-3, 0.1, 0.0, f64::NAN), 0.1);
    near(contact.step(2.0, 1e-3, 0.0, 0.0, f64::NAN), 0.34 - 0.04 * (6.0 * 0.502f64).cos());
    let mut seen = Observer::new(50.0, 0.0);
    let mut velocity = 0.0;
    let mut found = 0.0;
    for _ in 0..1000 {
        velocity += 1e-3 * (0.5 * 2.0 - 0.3 + 0.07) / 0.01;
        found = seen.observe(2.0, velocity, 0.3, 1e-3);
    }
    near(found, 0.07);
}
"""
    )
    command = [rustc, "test", "--quiet"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    if "failed to get `libm`" in done.stderr:
        pytest.skip("libm cannot be fetched here")
    assert done.returncode == 0, done.stdout + done.stderr


STATIC = """
#![no_std]
use core::panic::PanicInfo;
use stiction_plant::Contact;
static mut CONTACT: Option<Contact> = None;
#[no_mangle]
pub extern "C" fn begin_contact() {
    unsafe { CONTACT = Some(Contact::new()) };
}
#[no_mangle]
pub extern "C" fn step_contact(v: f32, dt: f32, effort: f32, load: f32) -> f32 {
    match unsafe { &mut *core::ptr::addr_of_mut!(CONTACT) } {
        Some(contact) => contact.step(v, dt, effort, load, 25.0),
        None => f32::NAN,
    }
}
#[panic_handler]
fn panic(_: &PanicInfo) -> ! {
    loop {}
}
"""
STEPS = """
void begin_contact(void);
float step_contact(float v, float dt, float effort, float load);
#define BEGIN begin_contact()
#define STEP(v, dt, effort, load) step_contact(v, dt, effort, load)
"""


def built_for_arm(folder, own):
    """A static library for a microcontroller that steps a plant in floats."""
    cargo = shutil.which("cargo") or pytest.skip("no cargo is installed")
    rustup = shutil.which("rustup") or pytest.skip("no rustup is installed")
    there = subprocess.run(
        [rustup, "target", "list", "--installed"], capture_output=True, text=True
    )
    if ARMED not in there.stdout.split():
        pytest.skip(f"rustup has no {ARMED}")
    own.export("rust").save(folder / "plant")
    (folder / "Cargo.toml").write_text(
        '[package]\nname = "driver"\nversion = "0.1.0"\nedition = "2021"\n'
        '[lib]\npath = "lib.rs"\ncrate-type = ["staticlib"]\n'
        '[dependencies]\nstiction_plant = { path = "plant", features = ["f32"] }\n'
        '[profile.release]\nopt-level = "s"\nlto = true\npanic = "abort"\n[workspace]\n'
    )
    (folder / "lib.rs").write_text(STATIC)
    command = [cargo, "build", "--quiet", "--release", "--target", ARMED]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if "failed to get `libm`" in done.stderr:
        pytest.skip("libm cannot be fetched here")
    assert done.returncode == 0, done.stderr
    assert not done.stderr
    return folder / "target" / ARMED / "release" / "libdriver.a"


def test_a_processor_without_an_operating_system_gets_it(tmp_path):
    assert built_for_arm(tmp_path, plant({"law": "lugre"}, *effects())).is_file()


@needs_tools
@pytest.mark.parametrize("name", firmware.LAWS)
def test_a_law_steps_on_a_microcontroller(name, tmp_path):
    own = plant(firmware.friction_of(name))
    library = built_for_arm(tmp_path, own)
    law = own.friction.model()
    columns = np.float32(motion(np.random.default_rng(5), law, 400))
    found = stepped_on_arm(tmp_path, columns, STEPS, str(library))
    core = along(law, *columns.astype(float))
    assert np.max(np.abs(found - core)) / level_of(law, core) < NEAR_FLOAT


@pytest.mark.parametrize(
    "text",
    [
        "#pragma once\n",
        "static real f(real x)\n{\n    goto out;\n}\n",
        "static real f(real x)\n{\n    return g(x);\n}\n",
        "static real f(real x)\n{\n    return y;\n}\n",
        "static real f(unknown x)\n{\n    return x;\n}\n",
        "static real f(real x)\n{\n    switch (x) {}\n}\n",
        "static real f(real x)\n{\n    return @x;\n}\n",
    ],
)
def test_c_beyond_what_is_translated_is_refused(text):
    with pytest.raises(TranslationError):
        rust_of(parse(text))
