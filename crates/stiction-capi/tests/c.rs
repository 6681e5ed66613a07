//! The header, and a C program against the static library.
#![allow(missing_docs)]

use std::path::{Path, PathBuf};
use std::process::Command;

use stiction_core::model::{FrictionModel, LawSpec};
use stiction_core::motor::{Motor, MotorSpec};

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_header_is_that_of_the_sources() {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml")).unwrap();
    let made = cbindgen::generate_with_config(folder(), config).unwrap();
    let mut text = Vec::new();
    made.write(&mut text);
    let text = String::from_utf8(text).unwrap();
    let path = folder().join("include/stiction.h");
    if std::env::var_os("STICTION_WRITE_HEADER").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let committed = std::fs::read_to_string(path).unwrap();
    assert!(
        text == committed,
        "include/stiction.h is out of date: run STICTION_WRITE_HEADER=1 cargo test -p stiction-capi"
    );
}

/// The newest static library beside this test: cargo puts it there under a name of its own.
fn library() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let files = std::fs::read_dir(test.parent().unwrap()).unwrap();
    let built = files.map(|file| file.unwrap().path()).filter(|path| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with("libstiction_capi") && name.ends_with(".a")
    });
    built.max_by_key(|path| path.metadata().unwrap().modified().unwrap()).unwrap()
}

fn compiler() -> Option<String> {
    let wanted = std::env::var("CC").unwrap_or_else(|_| "cc".to_owned());
    Command::new(&wanted).arg("--version").output().ok().map(|_| wanted)
}

#[test]
fn a_c_program_steps_to_the_bit() {
    let Some(compiler) = compiler() else {
        eprintln!("skipped: no C compiler is at hand; install one or name it in CC");
        return;
    };
    let source = folder().join("../../examples/c/step.c");
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("step");
    let built = Command::new(compiler)
        .args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-O2"])
        .arg(source)
        .arg("-I")
        .arg(folder().join("include"))
        .arg(library())
        .args(["-lm", "-lpthread", "-ldl", "-o"])
        .arg(&program)
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let run = Command::new(program).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let shown = String::from_utf8(run.stdout).unwrap();
    let mut shown = shown.lines();
    let mut next = || shown.next().unwrap().split(' ').next_back().unwrap().to_owned();

    let stated = [("breakaway".to_owned(), 0.5), ("viscous".to_owned(), 0.05)];
    let spec = LawSpec::new("hsieh_pan", &stated, &[]).unwrap();
    let mut friction = FrictionModel::new(spec.clone());
    let mut motor = Motor::new(MotorSpec::new(0.0076, 1.0, spec)).unwrap();
    let hex = |x: f64| format!("{:016x}", x.to_bits());
    for k in 0..2000 {
        let around = stiction_core::friction::Channels::default();
        let force = friction.step(if k < 1000 { 1e-3 } else { -1e-3 }, 1e-3, &around).unwrap();
        let (position, velocity) =
            motor.step(if k % 200 < 100 { 0.6 } else { -0.1 }, 0.0, 1e-3).unwrap();
        if k % 100 == 99 {
            assert_eq!([next(), next(), next()], [hex(force), hex(position), hex(velocity)], "{k}");
        }
    }
    assert!(motor.statistics().breakaways > 0);
    assert_eq!(next(), "coulombs");
}
