//! `include/masked_occlusion_culling.h` matches the output of cbindgen for `src/capi`, and `moc_names.h` and
//! `moc_names_end.h` list the functions exported there. `UPDATE_HEADER=1 cargo test --test header` regenerates them.

use std::fs;
use std::path::Path;

/// The files that export functions or define their types, in the order of the header.
const SOURCES: [&str; 13] = [
    "status",
    "messages",
    "types",
    "mesh",
    "lifecycle",
    "callbacks",
    "draw",
    "query",
    "bins",
    "transform",
    "pool",
    "pool_calls",
    "recorder",
];

/// The markers around the generated lines in the lists of names.
const BEGIN: &str = "/* The functions of src/capi, by `UPDATE_HEADER=1 cargo test --test header`. */\n";
const END: &str = "/* To here. */\n";

/// The header's sources, in order.
fn sources(root: &Path) -> impl Iterator<Item = (&'static str, String)> {
    let folder = root.join("src/capi");
    SOURCES.iter().map(move |&name| {
        let text = fs::read_to_string(folder.join(name).with_extension("rs")).expect("a source can be read");
        (name, text)
    })
}

fn generate(root: &Path) -> String {
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml can be read");
    // cbindgen does not see a function whose exported name comes from a macro.
    let plain = tempfile::tempdir().expect("a temporary folder");
    let mut builder = cbindgen::Builder::new().with_config(config);
    for (name, text) in sources(root) {
        let line = |line: &str| if exported(line).is_some() { "#[unsafe(no_mangle)]\n" } else { line }.to_string();
        let path = plain.path().join(name).with_extension("rs");
        fs::write(&path, text.split_inclusive('\n').map(line).collect::<String>()).expect("a file can be written");
        builder = builder.with_src(path);
    }
    let mut header = Vec::new();
    builder.generate().expect("cbindgen understands src/capi").write(&mut header);
    // Rust's heading for the caller's obligations means nothing in C.
    String::from_utf8(header).expect("the header is text").replace(" * # Safety\n", " * Required:\n")
}

/// The name in the attribute that exports a function.
fn exported(line: &str) -> Option<&str> {
    line.trim_end().strip_prefix("#[unsafe(export_name = symbol!(")?.strip_suffix("))]")
}

/// A header with one line between the markers for each exported function.
fn with_names(root: &Path, path: &Path, line: impl Fn(&str) -> String) -> String {
    let text = fs::read_to_string(path).expect("the header can be read").replace("\r\n", "\n");
    let (before, rest) = text.split_once(BEGIN).expect("a marker where the names begin");
    let (_, after) = rest.split_once(END).expect("a marker where the names end");
    let lines: String =
        sources(root).flat_map(|(_, text)| text.lines().filter_map(exported).map(&line).collect::<Vec<_>>()).collect();
    format!("{before}{BEGIN}{lines}{END}{after}")
}

fn is_current(path: &Path, made: &str) {
    if std::env::var_os("UPDATE_HEADER").is_some_and(|v| v == "1") {
        fs::write(path, made).expect("the header can be written");
    }
    let committed = fs::read_to_string(path).unwrap_or_default().replace("\r\n", "\n");
    let differs = committed.lines().zip(made.lines()).position(|(a, b)| a != b);
    assert!(
        committed == made,
        "{} is stale (first difference in line {}): run `UPDATE_HEADER=1 cargo test --test header` and commit it",
        path.display(),
        differs.map_or(committed.lines().count().min(made.lines().count()), |i| i) + 1
    );
}

#[test]
fn the_committed_header_is_current() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    is_current(&root.join("include/masked_occlusion_culling.h"), &generate(root));
}

#[test]
fn the_lists_of_names_are_current() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (begin, end) = (root.join("include/moc_names.h"), root.join("include/moc_names_end.h"));
    let define = |name: &str| format!("#define {name} MOC_DETAIL_JOIN(MOC_SYMBOL_PREFIX, {name})\n");
    is_current(&begin, &with_names(root, &begin, define));
    is_current(&end, &with_names(root, &end, |name| format!("#undef {name}\n")));
}

/// Every function documents the caller's obligations, and every one that can fail documents how.
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
fn every_export_is_in_the_header_by_its_own_name() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let header = generate(root);
    let mut exports = 0;
    for entry in fs::read_dir(root.join("src/capi")).expect("src/capi") {
        let text = fs::read_to_string(entry.expect("an entry").path()).expect("a source");
        let mut attribute = None;
        for line in text.lines() {
            attribute = exported(line).or(attribute);
            if !(line.starts_with("pub") && line.contains("extern \"C\" fn ")) {
                continue;
            }
            let name = line.split("fn ").nth(1).and_then(|rest| rest.split('(').next()).expect("a name");
            assert_eq!(attribute.take(), Some(name), "{name} needs #[unsafe(export_name = symbol!({name}))]");
            assert!(header.contains(&format!("{name}(")), "{name} is not in the header");
            exports += 1;
        }
        assert_eq!(attribute, None, "the attribute belongs to no function");
    }
    assert!(exports > 20, "only {exports} exported functions found");
}
