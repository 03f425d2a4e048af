//! Everything that programs written for Intel MOC do with its headers compiles with this library's, without warnings,
//! on every installed compiler and with each standard from C++11 on.
#![cfg(all(unix, feature = "capi", feature = "pool", feature = "recorder"))]

mod native;

use std::process::Command;

const STANDARDS: [&str; 4] = ["c++11", "c++14", "c++17", "c++20"];
const COMPILERS: [&str; 4] = ["g++", "clang++", "clang++-14", "clang++-19"];

/// The output of every compiler that rejects `source`; having no compiler at all is a failure.
fn refusals(source: &str, flags: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("program.cpp");
    std::fs::write(&file, source).expect("a file");
    let (mut compiled, mut refusals) = (0, Vec::new());
    for compiler in COMPILERS {
        if Command::new(compiler).arg("--version").output().is_err() {
            println!("skipped: no {compiler} here");
            continue;
        }
        for standard in STANDARDS {
            let mut command = Command::new(compiler);
            command.arg(format!("-std={standard}")).args(["-Wall", "-Wextra", "-Wswitch", "-pedantic", "-Werror"]);
            command.args(flags).arg("-fsyntax-only").arg("-I").arg(native::root().join("include")).arg(&file);
            let output = command.output().expect("a compiler");
            compiled += 1;
            if !output.status.success() {
                refusals.push(format!("{command:?}\n{}", String::from_utf8_lossy(&output.stderr)));
            }
        }
    }
    assert!(compiled > 0, "no compiler was found");
    refusals
}

fn compiles(source: &str) {
    let refusals = refusals(source, &[]);
    assert!(refusals.is_empty(), "{}", refusals.join("\n"));
}

#[test]
fn inside_of_extern_c() {
    for header in ["masked_occlusion_culling.h", "MaskedOcclusionCulling.h", "CullingThreadpool.h", "FrameRecorder.h"] {
        compiles(&format!("extern \"C\" {{\n#include \"{header}\"\n}}\n"));
    }
    compiles(
        r#"extern "C" {
        #include "MaskedOcclusionCulling.h"
        #include "CullingThreadpool.h"
        #include "FrameRecorder.h"
        int occluded(MaskedOcclusionCulling *moc) { return moc->TestRect(0, 0, 1, 1, 1); }
        }
        "#,
    );
}

const SWITCH: &str = r#"#include "MaskedOcclusionCulling.h"
    typedef MaskedOcclusionCulling Moc;
    int f(Moc::Implementation i) {
        switch (i) {
        CASES
        }
        return 0;
    }
    "#;

#[test]
fn a_switch_over_the_four_instruction_sets_of_intel_moc() {
    compiles(&SWITCH.replace("CASES", "case Moc::SSE2: case Moc::SSE41: case Moc::AVX2: case Moc::AVX512: return 1;"));
}

#[test]
fn a_switch_over_all_instruction_sets() {
    let all = "case Moc::SSE2: case Moc::SSE41: case Moc::AVX2: case Moc::AVX512: return 1;
        case Moc::SCALAR: return 2; case Moc::NEON: return 3; case Moc::SIMD128: return 4;";
    compiles(&SWITCH.replace("CASES", all));
}

/// The two tests above are meaningful only if the compiler gives this warning.
#[test]
fn a_switch_that_misses_one_of_the_four_is_warned_of() {
    let refusals =
        refusals(&SWITCH.replace("CASES", "case Moc::SSE2: case Moc::SSE41: case Moc::AVX2: return 1;"), &[]);
    assert!(!refusals.is_empty() && refusals.iter().all(|text| text.contains("AVX512")), "{}", refusals.join("\n"));
}

#[test]
fn every_way_to_create_an_object() {
    compiles(
        r#"#include "MaskedOcclusionCulling.h"
        typedef MaskedOcclusionCulling Moc;
        void *allocate(size_t alignment, size_t size);
        void release(void *memory);
        Moc *a() { return Moc::Create(); }
        Moc *b() { return Moc::Create(Moc::AVX2); }
        Moc *c() { return Moc::Create(Moc::AVX2, allocate, release); }
        Moc *d() { return Moc::Create(allocate, release); }
        Moc *e() { return Moc::Create(nullptr, nullptr); }
        Moc *f() { return Moc::Create(Moc::NEON, nullptr, nullptr); }
        Moc *g(Moc::pfnAlignedAlloc alloc, Moc::pfnAlignedFree free) { return Moc::Create(alloc, free); }
        void (Moc::*resize)(unsigned int, unsigned int) = &Moc::SetResolution;
        "#,
    );
}

#[test]
fn without_exceptions_and_run_time_types() {
    let source = "#include \"CullingThreadpool.h\"\n#include \"FrameRecorder.h\"\n
        static_assert(MOC_DETAIL_EXCEPTIONS == 0, \"\");\n";
    let refusals = refusals(source, &["-fno-exceptions", "-fno-rtti"]);
    assert!(refusals.is_empty(), "{}", refusals.join("\n"));
    compiles("#include \"MaskedOcclusionCulling.h\"\nstatic_assert(MOC_DETAIL_EXCEPTIONS == 1, \"\");\n");
}
