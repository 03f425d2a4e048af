//! The shared library exports the functions of the header and nothing else.
#![cfg(target_os = "linux")]

mod native;

use std::collections::BTreeSet;
use std::process::Command;

#[test]
fn the_shared_library_exports_the_header_and_nothing_else() {
    let output = Command::new("nm")
        .args(["-D", "--defined-only", "--extern-only", "--format=posix"])
        .arg(native::shared_library())
        .output()
        .expect("nm (binutils) reads the symbols");
    assert!(output.status.success(), "nm: {}", String::from_utf8_lossy(&output.stderr));
    let symbols = String::from_utf8(output.stdout).expect("names are text");
    let exported: BTreeSet<&str> = symbols.lines().filter_map(|line| line.split_whitespace().next()).collect();

    let header =
        std::fs::read_to_string(native::root().join("include/masked_occlusion_culling.h")).expect("the header");
    let declared: BTreeSet<&str> = header
        .lines()
        .filter(|line| {
            line.starts_with("MOC_Status MOC_")
                || line.starts_with("uint32_t MOC_")
                || line.starts_with("const char *MOC_")
        })
        .filter_map(|line| line.split('(').next()?.rsplit([' ', '*']).next())
        .collect();
    assert!(declared.len() > 20, "found only {declared:?} in the header");
    assert_eq!(exported, declared);
}
