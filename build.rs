//! Refuses a build whose interface version does not follow the crate's version, tells the tests which target the library was
//! built for, so that they compile C and C++ for the same one, and passes on the prefix of the exported names.

use std::env;
use std::fs;

const DECLARATION: &str = "pub const MOC_ABI_VERSION: u32 = ";
const PREFIX: &str = "MOC_SYMBOL_PREFIX";

fn main() {
    let source = "src/capi/status.rs";
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed={source}");

    let number = |name: &str| -> u32 { env::var(name).unwrap().parse().expect("cargo gives numbers") };
    let expected = 1000 * number("CARGO_PKG_VERSION_MAJOR") + number("CARGO_PKG_VERSION_MINOR");
    let text = fs::read_to_string(source).expect("the source of the interface version");
    let declared = text.lines().find_map(|line| line.strip_prefix(DECLARATION)?.strip_suffix(';'));
    assert!(
        declared == Some(expected.to_string().as_str()),
        "{source}: MOC_ABI_VERSION is {declared:?}, the crate's version asks for {expected}"
    );

    for name in ["TARGET", "HOST"] {
        println!("cargo:rustc-env=MOC_{name}={}", env::var(name).unwrap());
    }

    println!("cargo:rerun-if-env-changed={PREFIX}");
    println!("cargo:rustc-env={PREFIX}={}", symbol_prefix());
}

/// The prefix of the exported function names: `acme_` with `MOC_SYMBOL_PREFIX=acme_ cargo build`, empty by default. The C and
/// C++ headers take it from a macro of the same name.
fn symbol_prefix() -> String {
    let prefix = match env::var(PREFIX) {
        Err(env::VarError::NotPresent) => String::new(),
        other => other.unwrap_or_else(|e| panic!("{PREFIX}: {e}")),
    };
    let is_identifier = !prefix.starts_with(|c: char| c.is_ascii_digit())
        && prefix.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    assert!(
        is_identifier,
        "{PREFIX} is {prefix:?}: a prefix consists of letters, digits and underscores, and does not start with a digit"
    );
    prefix
}
