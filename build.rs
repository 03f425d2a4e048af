//! Passes on the prefix of the exported names: `acme_` with `MOC_SYMBOL_PREFIX=acme_ cargo build`, empty by default. The C and
//! C++ headers take it from a macro of the same name.

use std::env;

const PREFIX: &str = "MOC_SYMBOL_PREFIX";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed={PREFIX}");
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
    // Set even when empty: the exported name is a literal, which the source cannot form from an unset variable.
    println!("cargo:rustc-env={PREFIX}={prefix}");
}
