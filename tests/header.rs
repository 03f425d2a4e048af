//! `include/masked_occlusion_culling.h` is what cbindgen makes of `src/capi` now.
//! `UPDATE_HEADER=1 cargo test --test header` writes it anew.

use std::path::Path;

/// The files that export functions or define their types, in the order of the header.
const SOURCES: [&str; 11] =
    ["status", "messages", "types", "lifecycle", "callbacks", "draw", "query", "bins", "transform", "pool", "recorder"];

fn generate(root: &Path) -> String {
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml can be read");
    let builder = SOURCES.iter().fold(cbindgen::Builder::new().with_config(config), |builder, name| {
        builder.with_src(root.join("src/capi").join(name).with_extension("rs"))
    });
    let mut header = Vec::new();
    builder.generate().expect("cbindgen understands src/capi").write(&mut header);
    // Rust's heading for what the caller answers for means nothing in C.
    String::from_utf8(header).expect("the header is text").replace(" * # Safety\n", " * Required:\n")
}

#[test]
fn the_committed_header_is_current() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = root.join("include/masked_occlusion_culling.h");
    let made = generate(root);
    if std::env::var_os("UPDATE_HEADER").is_some_and(|v| v == "1") {
        std::fs::write(&path, &made).expect("the header can be written");
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default().replace("\r\n", "\n");
    let differs = committed.lines().zip(made.lines()).position(|(a, b)| a != b);
    assert!(
        committed == made,
        "include/masked_occlusion_culling.h is stale (first difference in line {}): \
         run `UPDATE_HEADER=1 cargo test --test header` and commit it",
        differs.map_or(committed.lines().count().min(made.lines().count()), |i| i) + 1
    );
}

/// Every function says what the caller answers for, and every one that can refuse says how.
#[test]
fn no_function_is_without_its_paragraphs() {
    let header = generate(Path::new(env!("CARGO_MANIFEST_DIR")));
    assert!(!header.contains("# Safety"), "a heading of Rust's documentation is left");
    for text in header.split("\n/**\n").filter(|text| text.contains("\n */\nMOC_Status MOC_")) {
        let (comment, function) = text.split_once(" */\n").expect("a comment ends");
        let name = function.split('(').next().unwrap_or(function);
        assert!(comment.contains(" * Required:\n"), "{name} does not say what it asks for");
        assert!(
            comment.contains(" * Errors: ")
                || comment.contains("Null is\n * allowed")
                || comment.contains("Null is allowed"),
            "{name} does not say what it refuses"
        );
    }
}

#[test]
fn every_source_with_exports_is_in_the_header() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = generate(root);
    let mut exports = 0;
    for entry in std::fs::read_dir(root.join("src/capi")).expect("src/capi") {
        let text = std::fs::read_to_string(entry.expect("an entry").path()).expect("a source");
        for line in text.lines().filter(|l| l.starts_with("pub") && l.contains("extern \"C\" fn ")) {
            let name = line.split("fn ").nth(1).and_then(|rest| rest.split('(').next()).expect("a name");
            assert!(header.contains(&format!("{name}(")), "{name} is not in the header");
            exports += 1;
        }
    }
    assert!(exports > 20, "only {exports} exported functions found");
}
