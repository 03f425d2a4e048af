//! The libraries of this package as C and C++ programs use them: where cargo put them, and how to link them.
#![allow(dead_code)]

mod program;
mod target;

use std::env;
use std::path::{Path, PathBuf};

#[allow(unused_imports)]
pub use program::{Link, Program, build, run};
#[allow(unused_imports)]
pub use target::target;

/// The package's folder: this one, or the one above it if the demo uses this module.
pub fn root() -> &'static Path {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    package.ancestors().find(|folder| folder.join("cpp-examples").is_dir()).unwrap_or(package)
}

/// The shared library that C programs link: on Windows, its import library.
pub fn shared_library() -> PathBuf {
    library(Link::Shared).unwrap_or_else(|e| panic!("{e}"))
}

/// The static library that C programs link.
pub fn static_library() -> PathBuf {
    library(Link::Static).unwrap_or_else(|e| panic!("{e}"))
}

fn library(link: Link) -> Result<PathBuf, String> {
    find(match (link, target().is_msvc()) {
        (Link::Static, true) => "masked_occlusion_culling.lib",
        (Link::Static, false) => "libmasked_occlusion_culling.a",
        (Link::Shared, true) => "masked_occlusion_culling.dll.lib",
        (Link::Shared, false) if target().is_windows() => "libmasked_occlusion_culling.dll.a",
        (Link::Shared, false) if target().triple.contains("-apple-") => "libmasked_occlusion_culling.dylib",
        (Link::Shared, false) => "libmasked_occlusion_culling.so",
    })
}

/// cargo builds every kind of library in Cargo.toml before a test or a program that depends on it. It places those for
/// C next to the executable of a test, and in `deps` next to that of a program. A library next to a program itself may
/// be out of date.
fn find(name: &str) -> Result<PathBuf, String> {
    let executable = env::current_exe().map_err(|e| format!("where this program lies is unknown: {e}"))?;
    let folder = executable.parent().unwrap_or(Path::new("."));
    let places = match target().libraries() {
        Some(libraries) => vec![libraries.join(name)],
        None => vec![folder.join("deps").join(name), folder.join(name), folder.join("..").join(name)],
    };
    places
        .iter()
        .find(|path| path.is_file())
        .cloned()
        .ok_or_else(|| format!("{name} is not in {}: was the library built for this target?", places[0].display()))
}

/// The functions that the shared library exports.
pub fn exported_symbols() -> std::collections::BTreeSet<String> {
    let windows = target().is_windows();
    let (tool, arguments, library) = if windows {
        ("objdump", &["-p"][..], find("masked_occlusion_culling.dll").unwrap_or_else(|e| panic!("{e}")))
    } else {
        ("nm", &["-D", "--defined-only", "--extern-only", "--format=posix"][..], shared_library())
    };
    let output = std::process::Command::new(tool)
        .args(arguments)
        .arg(library)
        .output()
        .unwrap_or_else(|e| panic!("{tool} (binutils) reads the symbols: {e}"));
    assert!(output.status.success(), "{tool}: {}", String::from_utf8_lossy(&output.stderr));
    let symbols = String::from_utf8(output.stdout).expect("names are text");
    if windows {
        // Lines such as `[   3] +base[   4]  0003 name`, up to an empty one.
        let table = symbols.lines().skip_while(|line| !line.starts_with("[Ordinal/Name Pointer] Table")).skip(1);
        let names = table.take_while(|line| !line.trim().is_empty());
        names.filter_map(|line| line.split_whitespace().last()).map(String::from).collect()
    } else {
        symbols.lines().filter_map(|line| line.split_whitespace().next()).map(String::from).collect()
    }
}
