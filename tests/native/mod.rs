//! The libraries of this package as C and C++ programs see them: where cargo put them, and how to link them.
#![allow(dead_code)]

mod program;

use std::env;
use std::path::{Path, PathBuf};

#[allow(unused_imports)]
pub use program::{Link, Program, build, run};

/// The folder of this package.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The shared library that C programs link.
pub fn shared_library() -> PathBuf {
    library(Link::Shared).unwrap_or_else(|e| panic!("{e}"))
}

/// The static library that C programs link.
pub fn static_library() -> PathBuf {
    library(Link::Static).unwrap_or_else(|e| panic!("{e}"))
}

/// cargo builds every kind of library that Cargo.toml names before a test or an example, and leaves those for C
/// beside the executable of a test, and in `../deps` of an example.
fn library(link: Link) -> Result<PathBuf, String> {
    let name = match (link, cfg!(all(windows, target_env = "msvc"))) {
        (Link::Static, true) => "masked_occlusion_culling.lib".into(),
        (Link::Static, false) => "libmasked_occlusion_culling.a".into(),
        // What is linked is not the library itself, but the list of its functions.
        (Link::Shared, true) => "masked_occlusion_culling.dll.lib".into(),
        (Link::Shared, false) => {
            format!("{}masked_occlusion_culling{}", env::consts::DLL_PREFIX, env::consts::DLL_SUFFIX)
        }
    };
    let executable = env::current_exe().map_err(|e| format!("where this program lies is unknown: {e}"))?;
    let folder = executable.parent().unwrap_or(Path::new("."));
    let places = [folder.join(&name), folder.join("../deps").join(&name), folder.join("..").join(&name)];
    places
        .into_iter()
        .find(|path| path.is_file())
        .ok_or_else(|| format!("{name} is not beside {}: was the library built for this target?", executable.display()))
}

/// The functions that the shared library exports.
pub fn exported_symbols() -> std::collections::BTreeSet<String> {
    let output = std::process::Command::new("nm")
        .args(["-D", "--defined-only", "--extern-only", "--format=posix"])
        .arg(shared_library())
        .output()
        .expect("nm (binutils) reads the symbols");
    assert!(output.status.success(), "nm: {}", String::from_utf8_lossy(&output.stderr));
    let symbols = String::from_utf8(output.stdout).expect("names are text");
    symbols.lines().filter_map(|line| line.split_whitespace().next()).map(String::from).collect()
}
