//! The shared library exports the functions of the header and nothing else.
#![cfg(all(target_os = "linux", feature = "capi", feature = "pool", feature = "recorder"))]

mod native;

use std::collections::BTreeSet;

#[test]
fn the_shared_library_exports_the_header_and_nothing_else() {
    let exported = native::exported_symbols();
    let header =
        std::fs::read_to_string(native::root().join("include/masked_occlusion_culling.h")).expect("the header");
    let declared: BTreeSet<String> = header
        .lines()
        .filter(|line| {
            line.starts_with("MOC_Status MOC_")
                || line.starts_with("uint32_t MOC_")
                || line.starts_with("int32_t MOC_")
                || line.starts_with("const char *MOC_")
        })
        .filter_map(|line| line.split('(').next()?.rsplit([' ', '*']).next())
        .map(String::from)
        .collect();
    assert!(declared.len() > 20, "found only {declared:?} in the header");
    assert_eq!(exported, declared);
}
