//! Small programs in C and C++ against an installed prefix, by pkg-config and by CMake.
#![cfg(unix)]
#![allow(missing_docs)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The newest library beside this test with such an ending: cargo gives it a name of its own.
fn built(ending: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let files = std::fs::read_dir(test.parent().unwrap()).unwrap();
    let found = files.map(|file| file.unwrap().path()).filter(|path| {
        let name = path.file_name().unwrap().to_string_lossy();
        name.starts_with("libstiction_capi") && name.ends_with(ending)
    });
    found.max_by_key(|path| path.metadata().unwrap().modified().unwrap()).unwrap()
}

fn there(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok();
    if !found {
        eprintln!("skipped: {program} is missing; install it to test this way");
    }
    found
}

fn done(command: &mut Command) -> Output {
    let output = command.output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{command:?}: {told}");
    output
}

/// An installed prefix in a folder of its own.
fn prefix(name: &str) -> PathBuf {
    let own = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let libraries = own.join("built");
    let _ = std::fs::remove_dir_all(&own);
    std::fs::create_dir_all(&libraries).unwrap();
    let shared = if cfg!(target_os = "macos") { ".dylib" } else { ".so" };
    for ending in [".a", shared] {
        let copy = libraries.join(format!("libstiction_capi{ending}"));
        std::fs::copy(built(ending), copy).unwrap();
    }
    let mut install = Command::new(folder().join("install.sh"));
    done(install.arg(own.join("prefix")).env("BUILT", &libraries).env_remove("DESTDIR"));
    own.join("prefix")
}

fn plant(prefix: &Path) -> PathBuf {
    let path = prefix.join("plant.toml");
    let text = "[body]\ninertia = 0.01\n[friction]\nlaw = \"coulomb\"\ncoulomb = 0.3\n";
    std::fs::write(&path, text).unwrap();
    path
}

/// 0.5 N·m against 0.3 N·m on 0.01 kg·m² for 1 s.
const WHERE: f64 = 0.5 * (0.5 - 0.3) / 0.01;

fn shows_where_it_is(program: &Path, prefix: &Path) {
    let mut run = Command::new(program);
    run.arg(plant(prefix));
    let place = if cfg!(target_os = "macos") { "DYLD_LIBRARY_PATH" } else { "LD_LIBRARY_PATH" };
    let shown = done(run.env(place, prefix.join("lib"))).stdout;
    let shown: f64 = String::from_utf8(shown).unwrap().trim().parse().unwrap();
    assert!((shown - WHERE).abs() < 1e-9, "{shown}");
}

#[test]
fn pkg_config_leads_to_the_shared_and_to_the_static_library() {
    if !(there("pkg-config") && there("cc") && there("c++")) {
        return;
    }
    let prefix = prefix("pkg-config");
    let flags = |more: &[&str]| -> Vec<String> {
        let mut ask = Command::new("pkg-config");
        ask.args(["--cflags", "--libs"]).args(more).arg("stiction");
        ask.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
        let told = String::from_utf8(done(&mut ask).stdout).unwrap();
        told.split_whitespace().map(str::to_owned).collect()
    };
    let examples = folder().join("../../examples");
    for (compiler, source, standard) in
        [("cc", "c/plant.c", "-std=c99"), ("c++", "cpp/plant.cpp", "-std=c++11")]
    {
        let program = prefix.join(standard);
        let mut compile = Command::new(compiler);
        compile.args([standard, "-Wall", "-Wextra", "-Werror"]).arg(examples.join(source));
        compile.args(flags(&[])).arg("-o").arg(&program);
        done(&mut compile);
        shows_where_it_is(&program, &prefix);
    }
    let program = prefix.join("static");
    let mut compile = Command::new("cc");
    compile.arg(examples.join("c/plant.c"));
    // The archive by its name, where a linker would take the shared one.
    let named = prefix.join("lib/libstiction.a").to_string_lossy().into_owned();
    let whole = flags(&["--static"]);
    let whole =
        whole.into_iter().map(|flag| if flag == "-lstiction" { named.clone() } else { flag });
    done(compile.args(whole).arg("-o").arg(&program));
    std::fs::remove_file(prefix.join("lib/pkgconfig/stiction.pc")).unwrap();
    shows_where_it_is(&program, &prefix);
}

#[test]
fn cmake_finds_both_libraries() {
    if !(there("cmake") && there("cc") && there("c++")) {
        return;
    }
    let prefix = prefix("cmake");
    let (source, build) = (prefix.join("project"), prefix.join("build"));
    std::fs::create_dir_all(&source).unwrap();
    let examples = folder().join("../../examples");
    let examples = examples.canonicalize().unwrap();
    let text = format!(
        "cmake_minimum_required(VERSION 3.15)\nproject(plants C CXX)\n\
         set(CMAKE_CXX_STANDARD 11)\n\
         find_package(stiction 1.0 REQUIRED)\n\
         add_executable(shared \"{0}/cpp/plant.cpp\")\n\
         target_link_libraries(shared PRIVATE stiction::stiction)\n\
         add_executable(static \"{0}/c/plant.c\")\n\
         target_link_libraries(static PRIVATE stiction::static)\n",
        examples.display()
    );
    std::fs::write(source.join("CMakeLists.txt"), text).unwrap();
    let mut configure = Command::new("cmake");
    configure.arg("-S").arg(&source).arg("-B").arg(&build);
    configure.arg(format!("-DCMAKE_PREFIX_PATH={}", prefix.display()));
    done(&mut configure);
    done(Command::new("cmake").arg("--build").arg(&build));
    for name in ["shared", "static"] {
        shows_where_it_is(&build.join(name), &prefix);
    }
}
