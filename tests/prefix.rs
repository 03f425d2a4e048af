//! Programs compiled for a library with a prefix (`MOC_SYMBOL_PREFIX`): the symbols that they call and define, and that
//! all names of the library's functions are free for the program. `.ci/prefix` builds such a library, then links and
//! runs programs with it.
#![cfg(all(target_os = "linux", feature = "capi", feature = "pool", feature = "recorder"))]

mod native;

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

const STRICT: [&str; 6] = ["-Wall", "-Wextra", "-pedantic", "-Wundef", "-Wshadow", "-Werror"];
const PREFIX: &str = "-DMOC_SYMBOL_PREFIX=acme_";
const C_HEADER: &str = "#include \"masked_occlusion_culling.h\"\n";
const CPP_HEADERS: &str =
    "#include \"CullingThreadpool.h\"\n#include \"FrameRecorder.h\"\n#include \"MaskedOcclusionCulling.h\"\n";

/// Methods of each class, as they appear in an object file.
const CLASSES: &str = "void use(MaskedOcclusionCulling *moc, CullingThreadpool &pool);\n\
    void use(MaskedOcclusionCulling *moc, CullingThreadpool &pool)\n{\n\
    FrameRecording recording;\n\
    moc = MaskedOcclusionCulling::Create();\n\
    moc->ClearBuffer();\n    moc->SetResolution(8, 4);\n    moc->TestRect(0, 0, 1, 1, 1);\n    moc->GetStatistics();\n\
    pool.ClearBuffer();\n    pool.Flush();\n    pool.TestRect(0, 0, 1, 1, 1);\n    CullingThreadpool other(1, 1, 1);\n\
    FrameRecording::Load(\"\", recording);\n    MaskedOcclusionCulling::Destroy(moc);\n}\n";

fn compile(file: &Path, text: &str, flags: &[&str]) -> Result<String, String> {
    std::fs::write(file, text).expect("a file");
    let cpp = file.extension().is_some_and(|e| e == "cpp");
    let mut command = Command::new(if cpp { "c++" } else { "cc" });
    command.args(STRICT).args(flags).arg("-I").arg(native::root().join("include"));
    native::run(command.arg("-c").arg(file).arg("-o").arg(file.with_extension("o")))
}

/// The symbols that an object file defines and references.
fn symbols(object: &Path) -> (BTreeSet<String>, BTreeSet<String>) {
    let list = |kind| {
        let mut command = Command::new("nm");
        let text = native::run(command.args([kind, "--extern-only", "--format=posix"]).arg(object));
        let text = text.unwrap_or_else(|e| panic!("{e}"));
        text.lines().filter_map(|line| line.split_whitespace().next()).map(String::from).collect()
    };
    (list("--defined-only"), list("--undefined-only"))
}

fn library_functions() -> Vec<String> {
    let text = std::fs::read_to_string(native::root().join("include/moc_names_end.h")).expect("the list of names");
    let names: Vec<String> = text.lines().filter_map(|line| line.strip_prefix("#undef ")).map(String::from).collect();
    assert!(names.len() > 50, "only {} names", names.len());
    names
}

/// A program may define all of these names in the file that includes the headers, with any arguments.
#[test]
fn every_name_of_the_library_is_free() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut facade = String::new();
    for name in library_functions() {
        write!(facade, "#ifdef {name}\n#error \"{name} is a macro\"\n#endif\n").expect("a string");
        writeln!(facade, "double {name}(double a);\ndouble {name}(double a) {{ return a; }}").expect("a string");
    }
    for standard in ["-std=c99", "-std=c11"] {
        let file = folder.path().join("facade.c");
        compile(&file, &format!("{C_HEADER}{facade}"), &[PREFIX, standard]).unwrap_or_else(|e| panic!("{e}"));
    }
    for standard in ["-std=c++11", "-std=c++17", "-std=c++20"] {
        let file = folder.path().join("facade.cpp");
        let text = format!("{CPP_HEADERS}extern \"C\" {{\n{facade}}}\n{CLASSES}");
        compile(&file, &text, &[PREFIX, standard]).unwrap_or_else(|e| panic!("{e}"));
        let (defined, called) = symbols(&file.with_extension("o"));
        assert!(library_functions().iter().all(|name| defined.contains(name)), "{defined:?}");
        assert!(called.contains("acme_MOC_ClearBuffer") && called.contains("acme_MOC_RecordingLoad"), "{called:?}");
    }
    // Without a prefix the names are taken.
    let file = folder.path().join("facade.c");
    let error = compile(&file, &format!("{C_HEADER}{facade}"), &[]).expect_err("it is accepted");
    assert!(error.contains("conflicting types for"), "{error}");
}

/// The linker merges inline functions of the same name, so object files for two copies of the library must have none in
/// common.
#[test]
fn files_for_two_copies_share_no_function_of_the_library() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut all = Vec::new();
    for (name, flags) in
        [("plain.cpp", &[][..]), ("acme.cpp", &[PREFIX]), ("other.cpp", &["-DMOC_SYMBOL_PREFIX=other_"])]
    {
        let file = folder.path().join(name);
        compile(&file, &format!("{CPP_HEADERS}{CLASSES}"), flags).unwrap_or_else(|e| panic!("{e}"));
        let (defined, called) = symbols(&file.with_extension("o"));
        let prefix = flags.first().and_then(|flag| flag.split('=').next_back()).unwrap_or_default();
        let functions: BTreeSet<String> = library_functions().iter().map(|name| format!("{prefix}{name}")).collect();
        let used = called.iter().filter(|name| name.contains("MOC_")).collect::<Vec<_>>();
        assert!(used.len() > 10, "{used:?}");
        assert!(used.iter().all(|name| functions.contains(*name)), "{prefix}: {used:?}");
        let ours = |name: &String| {
            ["MaskedOcclusion", "CullingThreadpool", "FrameRecording", "MOC_"].iter().any(|part| name.contains(part))
        };
        let defined: BTreeSet<String> = defined.into_iter().filter(ours).collect();
        assert!(defined.len() > 20, "{defined:?}");
        all.push(defined);
    }
    for (k, a) in all.iter().enumerate() {
        for b in &all[k + 1..] {
            assert_eq!(a.intersection(b).collect::<Vec<_>>(), Vec::<&String>::new());
        }
    }
}

/// The files of `link`, for headers that cannot change, call the functions with the prefix.
#[test]
fn the_link_files_follow_the_prefix() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let headers = format!("-I{}", native::root().join("capi-tests/abstract_header").display());
    for name in ["MaskedOcclusionCullingLink.cpp", "CullingThreadpoolLink.cpp"] {
        let file = folder.path().join("link.cpp");
        let text = format!("#include \"{}\"\n", native::root().join("link").join(name).display());
        compile(&file, &text, &[PREFIX, "-std=c++11", &headers]).unwrap_or_else(|e| panic!("{e}"));
        let (_, called) = symbols(&file.with_extension("o"));
        let (with, without): (Vec<_>, Vec<_>) = called
            .iter()
            .filter(|name| name.contains("MOC_") && !name.starts_with("_Z"))
            .partition(|name| name.starts_with("acme_MOC_"));
        assert!(with.len() > 10 && without.is_empty(), "{with:?} and {without:?}");
    }
}

/// If a header was included earlier, its declarations have different names from those that later ones would call.
#[test]
fn a_prefix_that_comes_too_late_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("late.cpp");
    let text = "#include \"masked_occlusion_culling.h\"\n#define MOC_SYMBOL_PREFIX acme_\n\
                #include \"MaskedOcclusionCulling.h\"\n";
    let error = compile(&file, text, &[]).expect_err("it is accepted");
    assert!(error.contains("must be defined before the first header"), "{error}");
}

/// Existing C code with one more include. An empty prefix counts as none.
#[test]
fn a_file_that_wants_the_short_names_has_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("short.c");
    let text = format!(
        "{C_HEADER}#include \"moc_names.h\"\nint clear(MaskedOcclusionCulling *moc);\n\
         int clear(MaskedOcclusionCulling *moc) {{ return MOC_ClearBuffer(moc); }}\n"
    );
    for (flags, name) in [
        (&[][..], "MOC_ClearBuffer"),
        (&[PREFIX], "acme_MOC_ClearBuffer"),
        (&["-DMOC_SYMBOL_PREFIX="], "MOC_ClearBuffer"),
    ] {
        compile(&file, &text, flags).unwrap_or_else(|e| panic!("{e}"));
        let (_, called) = symbols(&file.with_extension("o"));
        assert!(called.contains(name), "{flags:?}: {called:?}");
    }
}
