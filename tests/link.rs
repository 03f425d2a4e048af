//! Programs with a header that declares a class with virtual methods, which cannot change, link the files of `link` and
//! run. The header is written for these tests (`capi-tests/abstract_header`), with the methods in the order of Intel's.
#![cfg(all(feature = "capi", feature = "pool", feature = "recorder"))]

mod native;

use std::path::{Path, PathBuf};
use std::process::Command;

use native::{Link, Program};

const CLASS: &str = "link/MaskedOcclusionCullingLink.cpp";
const POOL: &str = "link/CullingThreadpoolLink.cpp";

fn path(name: &str) -> String {
    native::root().join(name).display().to_string()
}

fn build(program: &str, link: Link, defines: &[(&str, &str)], files: &[&str], flags: &[&str], out: &Path) -> PathBuf {
    let source = native::root().join("capi-tests").join(program);
    // Before this repository's own headers, which are found after it.
    let mut all = vec![format!("-I{}", path("capi-tests/abstract_header"))];
    all.extend(files.iter().map(|f| path(f)));
    all.push(if native::target().is_msvc() { "/WX" } else { "-Werror" }.into());
    all.extend(flags.iter().map(|f| f.to_string()));
    let flags: Vec<&str> = all.iter().map(String::as_str).collect();
    native::build(&Program { source: &source, out, link, defines, flags: &flags }).unwrap_or_else(|e| panic!("{e}"))
}

fn run(program: &str, defines: &[(&str, &str)], files: &[&str]) {
    for link in [Link::Static, Link::Shared] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let exe = build(program, link, defines, files, &[], folder.path());
        let chosen = defines.iter().any(|(name, _)| *name == "QUICK_MASK").then_some("chosen");
        native::run(native::target().command(exe).args(chosen)).unwrap_or_else(|e| panic!("{program}, {link:?}: {e}"));
    }
}

#[test]
fn with_no_switch() {
    run("abstract_class.cpp", &[], &[CLASS, POOL]);
}

#[test]
fn with_every_switch_the_one_way() {
    let switches = [("QUICK_MASK", "0"), ("USE_D3D", "0"), ("PRECISE_COVERAGE", "0"), ("USE_AVX512", "0")];
    run("abstract_class.cpp", &[&switches[..], &[("ENABLE_STATS", "1")]].concat(), &[CLASS, POOL]);
}

#[test]
fn with_every_switch_the_other_way() {
    let switches = [("QUICK_MASK", "1"), ("USE_D3D", "1"), ("PRECISE_COVERAGE", "1"), ("USE_AVX512", "1")];
    run("abstract_class.cpp", &[&switches[..], &[("ENABLE_STATS", "0")]].concat(), &[CLASS, POOL]);
}

#[test]
fn with_callbacks_that_throw() {
    run("abstract_throwing.cpp", &[], &[CLASS, POOL]);
}

#[test]
fn with_four_layers() {
    run("abstract_class.cpp", &[("MOC_FOUR_LAYERS", "1")], &[CLASS, POOL]);
    let switches = [("MOC_FOUR_LAYERS", "1"), ("QUICK_MASK", "0"), ("USE_AVX512", "0")];
    run("abstract_class.cpp", &switches, &[CLASS, POOL]);
}

#[test]
fn with_the_recorder_of_the_program() {
    run("abstract_recorder.cpp", &[("MOC_RECORDER_ENABLE", "1")], &[CLASS]);
}

/// Existing object files are linked unchanged, also in programs without exceptions and type information.
#[test]
#[cfg(unix)]
fn with_an_object_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let object = folder.path().join("engine.o");
    let engine = folder.path().join("engine.cpp");
    let text = "#include <stddef.h>\n#include \"MaskedOcclusionCulling.h\"\nint main() { MaskedOcclusionCulling *m = \
                MaskedOcclusionCulling::Create(); m->SetResolution(8, 4); m->ClearBuffer(); int r = \
                m->TestRect(-1, -1, 1, 1, 1); MaskedOcclusionCulling::Destroy(m); return r; }\n";
    std::fs::write(&engine, text).expect("a file");
    let plain = ["-fno-exceptions", "-fno-rtti"];
    let mut command = compiler(folder.path());
    command.args(plain).arg("-c").arg(format!("-I{}", path("capi-tests/abstract_header"))).arg(&engine);
    native::run(command.arg("-o").arg(&object)).unwrap_or_else(|e| panic!("{e}"));
    let object = object.display().to_string();
    let source = native::root().join(CLASS);
    let include = format!("-I{}", path("capi-tests/abstract_header"));
    let flags = [include.as_str(), &object, "-Werror", plain[0], plain[1]];
    let exe = native::build(&Program {
        source: &source,
        out: folder.path(),
        link: Link::Static,
        defines: &[],
        flags: &flags,
    })
    .unwrap_or_else(|e| panic!("{e}"));
    native::run(&mut native::target().command(exe)).unwrap_or_else(|e| panic!("{e}"));
}

#[test]
#[cfg(unix)]
fn under_sanitizers() {
    if native::target().is_windows() {
        println!("skipped: gcc has no sanitizers for Windows");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let flags = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g"];
    let empty = folder.path().join("empty.cpp");
    std::fs::write(&empty, "int main() { return 0; }\n").expect("a file");
    let mut command = compiler(folder.path());
    if native::run(command.args(flags).arg(&empty).arg("-o").arg(folder.path().join("empty"))).is_err() {
        assert!(std::env::var("CI").as_deref() != Ok("true"), "this compiler cannot link {flags:?}");
        println!("skipped: this compiler cannot link {flags:?}");
        return;
    }
    let exe = build("abstract_class.cpp", Link::Static, &[], &[CLASS, POOL], &flags, folder.path());
    native::run(native::target().command(exe).env("ASAN_OPTIONS", "detect_leaks=1")).unwrap_or_else(|e| panic!("{e}"));
}

/// With every installed compiler, and the warnings that engines enable.
#[test]
#[cfg(unix)]
fn without_warnings() {
    let mut compiled = 0;
    for compiler in ["g++", "clang++"] {
        if Command::new(compiler).arg("--version").output().is_err() {
            println!("skipped: no {compiler} here");
            continue;
        }
        for standard in ["c++11", "c++14", "c++17", "c++20"] {
            for file in [CLASS, POOL] {
                let mut command = Command::new(compiler);
                command.arg(format!("-std={standard}")).args(["-Wall", "-Wextra", "-pedantic", "-Werror"]);
                command.args(["-Wshadow", "-Wconversion", "-Wundef", "-fsyntax-only"]);
                command.arg(format!("-I{}", path("capi-tests/abstract_header"))).arg(path(file));
                native::run(&mut command).unwrap_or_else(|e| panic!("{command:?}: {e}"));
                compiled += 1;
            }
        }
    }
    assert!(compiled > 0, "no compiler was found");
}

/// With this repository's header instead of the program's, and a pool that would not record.
#[test]
#[cfg(unix)]
fn what_cannot_work_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (file, flags, message) in [
        (CLASS, [format!("-I{}", path("include")), "-DX".into()], "found the header of this repository"),
        (POOL, [format!("-I{}", path("include")), "-DX".into()], "found the header of this repository"),
        (
            POOL,
            [format!("-I{}", path("capi-tests/abstract_header")), "-DMOC_RECORDER_ENABLE=1".into()],
            "would not be recorded",
        ),
    ] {
        let mut command = compiler(folder.path());
        let error = native::run(command.args(flags).arg("-fsyntax-only").arg(path(file))).expect_err("it is accepted");
        assert!(error.contains(message), "{error}");
    }
}

#[cfg(unix)]
fn compiler(out: &Path) -> Command {
    let mut build = native::target().compiler(true, out);
    build.std("c++11").opt_level(0).debug(false);
    build.get_compiler().to_command()
}
