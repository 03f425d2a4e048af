//! Refuses a build whose interface version does not follow the crate's version, and tells the tests which
//! target the library was built for, so that they compile C and C++ for the same one.

use std::env;
use std::fs;

const DECLARATION: &str = "pub const MOC_ABI_VERSION: u32 = ";

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
}
