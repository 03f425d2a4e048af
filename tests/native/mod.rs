//! Where cargo put the libraries of this package, for the tests that link or read them.
#![allow(dead_code)]

use std::path::{Path, PathBuf};

/// The folder of this package.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The shared library that C programs link.
pub fn shared_library() -> PathBuf {
    use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
    library(&format!("{DLL_PREFIX}masked_occlusion_culling{DLL_SUFFIX}"))
}

/// The static library that C programs link.
pub fn static_library() -> PathBuf {
    library("libmasked_occlusion_culling.a")
}

/// cargo builds every kind of library that Cargo.toml names before an integration test, and leaves those for C
/// beside the test's own executable.
fn library(name: &str) -> PathBuf {
    let executable = std::env::current_exe().expect("a test has an executable");
    let folders = executable.ancestors().skip(1).take(2);
    folders.map(|folder| folder.join(name)).find(|path| path.is_file()).unwrap_or_else(|| {
        panic!("{name} is not beside {}: was the library built for this target?", executable.display())
    })
}
