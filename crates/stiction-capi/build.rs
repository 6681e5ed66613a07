//! Names the shared library by its version, so that programs ask for the one they were made with.

use std::env;

fn main() {
    // As install.sh names the files.
    let major = env::var("CARGO_PKG_VERSION_MAJOR").unwrap_or_default();
    println!("cargo:rerun-if-changed=build.rs");
    match env::var("CARGO_CFG_TARGET_OS").as_deref() {
        Ok("linux") => println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libstiction.so.{major}"),
        Ok("macos") => {
            println!(
                "cargo:rustc-cdylib-link-arg=-Wl,-install_name,@rpath/libstiction.{major}.dylib"
            );
        }
        _ => (),
    }
}
