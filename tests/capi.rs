//! Compiles the programs of `capi-tests` with the installed C and C++ compilers, as a user of the library would, and
//! runs them with the shared and the static library.
#![cfg(all(unix, feature = "capi", feature = "pool", feature = "recorder"))]

mod native;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const STRICT: [&str; 4] = ["-Wall", "-Wextra", "-pedantic", "-Werror"];
const SANITIZERS: &str = "-fsanitize=address,undefined";

#[derive(Clone, Copy, Debug)]
enum Library {
    Shared,
    Static,
}

struct Program {
    name: &'static str,
    sources: &'static [&'static str],
    cpp: bool,
}

const ALL_FUNCTIONS: Program = Program { name: "all_functions", sources: &["all_functions.c"], cpp: false };
const HOSTILE: Program = Program { name: "hostile", sources: &["hostile.c"], cpp: false };
const EXACT_ARRAYS: Program = Program { name: "exact_arrays", sources: &["exact_arrays.c"], cpp: false };
const PEER_STYLE: Program = Program { name: "peer_style", sources: &["peer_style.cpp"], cpp: true };
const SWITCHES: Program = Program {
    name: "switches",
    sources: &["switches_main.cpp", "switches_quick.cpp", "switches_accurate.cpp", "switches_four_layer.cpp"],
    cpp: true,
};
const STATISTICS: Program = Program { name: "statistics", sources: &["statistics.cpp"], cpp: true };
const STATISTICS_LAYOUT: Program =
    Program { name: "statistics_layout", sources: &["statistics_layout.cpp"], cpp: true };
const THROWING_ALLOCATOR: Program = Program {
    name: "throwing_allocator",
    sources: &["throwing_allocator.cpp", "throwing_allocator_none.cpp"],
    cpp: true,
};
const FLOAT_ENVIRONMENT: Program =
    Program { name: "float_environment", sources: &["float_environment.cpp"], cpp: true };
const MESSAGES: Program = Program { name: "messages", sources: &["messages.cpp"], cpp: true };
const THEIR_PROGRAMS: Program = Program { name: "their_programs", sources: &["their_programs.cpp"], cpp: true };
const THREADS: Program = Program { name: "threads", sources: &["threads.cpp"], cpp: true };
const THREAD_POOL: Program = Program { name: "thread_pool", sources: &["thread_pool.cpp"], cpp: true };
const RECORDER: Program = Program { name: "recorder", sources: &["recorder.cpp"], cpp: true };
const POOL_CONTRACT: Program = Program { name: "pool_contract", sources: &["pool_contract.cpp"], cpp: true };
const POOL_THREADS: Program = Program { name: "pool_threads", sources: &["pool_threads.cpp"], cpp: true };
const THREAD_POOL_C: Program = Program { name: "thread_pool_c", sources: &["thread_pool_c.c"], cpp: false };

fn compiler(cpp: bool, folder: &Path) -> Command {
    native::target().compiler(cpp, folder).opt_level(0).debug(true).get_compiler().to_command()
}

fn succeed(what: &str, output: &Output) {
    assert!(
        output.status.success(),
        "{what}: {}\n{}{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
}

/// Compiles and links; `None` if the compiler cannot even link an empty program with `flags`.
fn build(program: &Program, library: Library, flags: &[&str], folder: &Path) -> Option<PathBuf> {
    if !flags.is_empty() && !links_an_empty_program(flags, folder) {
        return None;
    }
    let target = native::target();
    let executable = folder.join(program.name).with_extension(target.executable_extension());
    let mut command = compiler(program.cpp, folder);
    command.arg(if program.cpp { "-std=c++11" } else { "-std=c99" }).args(STRICT).args(flags);
    command.arg("-I").arg(native::root().join("include"));
    command.args(program.sources.iter().map(|source| native::root().join("capi-tests").join(source)));
    command.arg("-o").arg(&executable);
    match library {
        Library::Shared => target.link(&mut command, &native::shared_library(), true),
        Library::Static => target.link(&mut command, &native::static_library(), false),
    }
    succeed(&format!("compiling {}", program.name), &command.output().expect("a C compiler"));
    Some(executable)
}

fn links_an_empty_program(flags: &[&str], folder: &Path) -> bool {
    let source = folder.join("empty.c");
    std::fs::write(&source, "int main(void) { return 0; }\n").expect("a temporary file");
    let mut command = compiler(false, folder);
    command.args(flags).arg(&source).arg("-o").arg(folder.join("empty"));
    command.output().expect("a C compiler").status.success()
}

fn run(program: &Program, library: Library) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let executable = build(program, library, &[], folder.path()).expect("no flags to refuse");
    let output = native::target().command(executable).current_dir(folder.path()).output().expect("the program starts");
    succeed(&format!("{} with the {library:?} library", program.name), &output);
}

macro_rules! programs {
    ($($name:ident: $program:expr, $library:expr;)*) => {$(
        #[test]
        fn $name() {
            run(&$program, $library);
        }
    )*};
}

programs! {
    all_functions_shared: ALL_FUNCTIONS, Library::Shared;
    all_functions_static: ALL_FUNCTIONS, Library::Static;
    exact_arrays_shared: EXACT_ARRAYS, Library::Shared;
    exact_arrays_static: EXACT_ARRAYS, Library::Static;
    float_environment_shared: FLOAT_ENVIRONMENT, Library::Shared;
    float_environment_static: FLOAT_ENVIRONMENT, Library::Static;
    hostile_shared: HOSTILE, Library::Shared;
    hostile_static: HOSTILE, Library::Static;
    messages_shared: MESSAGES, Library::Shared;
    messages_static: MESSAGES, Library::Static;
    peer_style_shared: PEER_STYLE, Library::Shared;
    peer_style_static: PEER_STYLE, Library::Static;
    pool_contract_shared: POOL_CONTRACT, Library::Shared;
    pool_contract_static: POOL_CONTRACT, Library::Static;
    pool_threads_shared: POOL_THREADS, Library::Shared;
    pool_threads_static: POOL_THREADS, Library::Static;
    recorder_shared: RECORDER, Library::Shared;
    recorder_static: RECORDER, Library::Static;
    statistics_shared: STATISTICS, Library::Shared;
    statistics_static: STATISTICS, Library::Static;
    statistics_layout_shared: STATISTICS_LAYOUT, Library::Shared;
    statistics_layout_static: STATISTICS_LAYOUT, Library::Static;
    switches_shared: SWITCHES, Library::Shared;
    switches_static: SWITCHES, Library::Static;
    their_programs_shared: THEIR_PROGRAMS, Library::Shared;
    their_programs_static: THEIR_PROGRAMS, Library::Static;
    thread_pool_shared: THREAD_POOL, Library::Shared;
    thread_pool_static: THREAD_POOL, Library::Static;
    thread_pool_c_shared: THREAD_POOL_C, Library::Shared;
    thread_pool_c_static: THREAD_POOL_C, Library::Static;
    throwing_allocator_shared: THROWING_ALLOCATOR, Library::Shared;
    throwing_allocator_static: THROWING_ALLOCATOR, Library::Static;
    threads_shared: THREADS, Library::Shared;
    threads_static: THREADS, Library::Static;
}

/// Each call runs in a process of its own, which its assertion must stop.
#[test]
fn layout_check() {
    const PROGRAM: Program = Program { name: "layout_check", sources: &["layout_check.cpp"], cpp: true };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let executable = build(&PROGRAM, Library::Shared, &[], folder.path()).expect("no flags to refuse");
    for which in -1..6 {
        let mut command = native::target().command(executable.clone());
        let output = command.arg(which.to_string()).current_dir(folder.path()).output().expect("the program starts");
        succeed(&format!("layout_check {which}"), &output);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(said.contains("x, y, z, w packed is VertexLayout(16, 4, 8)"), which >= 0, "{which}: {said}");
    }
}

/// Only 32-bit programs compute with the x87 unit.
#[test]
#[cfg(target_arch = "x86")]
fn precision_control() {
    const PROGRAM: Program = Program { name: "precision_control", sources: &["precision_control.c"], cpp: false };
    run(&PROGRAM, Library::Shared);
    run(&PROGRAM, Library::Static);
}

#[test]
fn exact_arrays_under_sanitizers() {
    under_sanitizers(&EXACT_ARRAYS);
}

#[test]
fn hostile_under_sanitizers() {
    under_sanitizers(&HOSTILE);
}

#[test]
fn peer_style_under_sanitizers() {
    under_sanitizers(&PEER_STYLE);
}

#[test]
fn recorder_under_sanitizers() {
    under_sanitizers(&RECORDER);
}

#[test]
fn pool_contract_under_sanitizers() {
    under_sanitizers(&POOL_CONTRACT);
}

#[test]
fn pool_threads_under_sanitizers() {
    under_sanitizers(&POOL_THREADS);
}

#[test]
fn throwing_allocator_under_sanitizers() {
    under_sanitizers(&THROWING_ALLOCATOR);
}

#[test]
fn thread_pool_under_sanitizers() {
    under_sanitizers(&THREAD_POOL);
}

#[test]
fn thread_pool_c_under_sanitizers() {
    under_sanitizers(&THREAD_POOL_C);
}

fn under_sanitizers(program: &Program) {
    if native::target().is_windows() {
        println!("skipped: gcc has no sanitizers for Windows");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let flags = [SANITIZERS, "-fno-sanitize-recover=all"];
    let Some(executable) = build(program, Library::Static, &flags, folder.path()) else {
        // Nobody reads the output of a passing test, so on CI the check must not be skipped silently.
        assert!(std::env::var("CI").as_deref() != Ok("true"), "this compiler cannot link {SANITIZERS}");
        println!("skipped: this compiler cannot link {SANITIZERS}");
        return;
    };
    let output = Command::new(executable)
        .current_dir(folder.path())
        .env("ASAN_OPTIONS", "detect_leaks=1:allocator_may_return_null=1")
        .output()
        .expect("the program starts");
    succeed(&format!("{} under {SANITIZERS}", program.name), &output);
}

/// Each header on its own, with every installed compiler and each standard from the oldest on.
#[test]
fn headers_compile_without_warnings() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut compiled = 0;
    for (compilers, suffix, standards, headers) in [
        (["gcc", "clang"], "c", &["c99", "c11", "c17"][..], &["masked_occlusion_culling.h"][..]),
        (
            ["g++", "clang++"],
            "cpp",
            &["c++11", "c++14", "c++17", "c++20"][..],
            &["masked_occlusion_culling.h", "MaskedOcclusionCulling.h", "CullingThreadpool.h", "FrameRecorder.h"][..],
        ),
    ] {
        for header in headers {
            let source = folder.path().join(header).with_extension(suffix);
            std::fs::write(&source, format!("#include \"{header}\"\n#include \"{header}\"\n")).expect("a file");
            for compiler in compilers {
                if Command::new(compiler).arg("--version").output().is_err() {
                    println!("skipped: no {compiler} here");
                    continue;
                }
                for standard in standards {
                    let mut command = Command::new(compiler);
                    command.arg(format!("-std={standard}")).args(STRICT).args(["-Wshadow", "-Wconversion", "-Wundef"]);
                    command.arg("-fsyntax-only").arg("-I").arg(native::root().join("include")).arg(&source);
                    succeed(&format!("{command:?}"), &command.output().expect("a compiler"));
                    compiled += 1;
                }
            }
        }
    }
    assert!(compiled > 0, "no compiler was found");
}

/// windows.h defines `min`, `max`, `near` and others as macros.
#[test]
fn headers_compile_beside_that_of_windows() {
    if !native::target().is_windows() {
        println!("skipped: not for Windows");
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("headers.cpp");
    let headers = ["masked_occlusion_culling.h", "MaskedOcclusionCulling.h", "CullingThreadpool.h", "FrameRecorder.h"];
    for header in headers {
        for text in [
            format!("#include <windows.h>\n#include \"{header}\"\n"),
            format!("#include \"{header}\"\n#include <windows.h>\n"),
        ] {
            std::fs::write(&file, text).expect("a file");
            for standard in ["c++11", "c++20"] {
                let mut command = compiler(true, folder.path());
                command.arg(format!("-std={standard}")).args(STRICT).args(["-DMOC_RECORDER_ENABLE=1", "-fsyntax-only"]);
                command.arg("-I").arg(native::root().join("include")).arg(&file);
                succeed(&format!("{header}: {command:?}"), &command.output().expect("a compiler"));
            }
        }
    }
}

/// Each header with every switch on and off, and the programs that `.ci/install-ways` installs.
#[test]
fn headers_compile_with_every_switch() {
    const SWITCHES: [&str; 9] = [
        "QUICK_MASK",
        "MOC_FOUR_LAYERS",
        "USE_D3D",
        "PRECISE_COVERAGE",
        "USE_AVX512",
        "CLIPPING_PRESERVES_ORDER",
        "ENABLE_STATS",
        "MOC_RECORDER_ENABLE",
        "MOC_RECORDER_ENABLE_PLAYBACK",
    ];
    let folder = tempfile::tempdir().expect("a temporary folder");
    let headers = folder.path().join("headers.cpp");
    let text =
        "#include \"CullingThreadpool.h\"\n#include \"FrameRecorder.h\"\n#include \"MaskedOcclusionCulling.h\"\n";
    std::fs::write(&headers, text).expect("a file");
    let check = |compiler: &str, standard: &str, defines: &[String], source: &Path| {
        let mut command = Command::new(compiler);
        command.arg(format!("-std={standard}")).args(STRICT).args(defines).arg("-fsyntax-only");
        command.arg("-I").arg(native::root().join("include")).arg(source);
        succeed(&format!("{command:?}"), &command.output().expect("a compiler"));
    };
    for compiler in ["g++", "clang++"] {
        if Command::new(compiler).arg("--version").output().is_err() {
            println!("skipped: no {compiler} here");
            continue;
        }
        for standard in ["c++11", "c++17", "c++20"] {
            for value in 0..2 {
                check(compiler, standard, &SWITCHES.map(|switch| format!("-D{switch}={value}")), &headers);
            }
        }
    }
    let programs = native::root().join("install-tests");
    check("cc", "c99", &[], &programs.join("engine.c"));
    check("c++", "c++11", &[], &programs.join("engine.cpp"));
}
