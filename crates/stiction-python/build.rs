//! The name of the build profile, for `stiction --version`.

use std::path::PathBuf;

fn main() {
    // Cargo tells a custom profile by this folder alone: target/PROFILE/build/PACKAGE/out.
    let out = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default());
    let profile = out.iter().rev().nth(3).map_or("unknown".into(), |name| name.to_string_lossy());
    println!("cargo:rustc-env=STICTION_PROFILE={profile}");
    println!("cargo:rerun-if-changed=build.rs");
}
