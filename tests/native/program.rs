//! Compiles C and C++ programs against include/ and the library, and runs them.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::{library, root, target};

/// How a program gets the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Link {
    Static,
    Shared,
}

/// A program to be compiled.
pub struct Program<'a> {
    /// `.c` or `.cpp`.
    pub source: &'a Path,
    /// The folder for the program and intermediate files. It must exist.
    pub out: &'a Path,
    pub link: Link,
    /// Macros.
    pub defines: &'a [(&'a str, &'a str)],
    /// Additional compiler arguments.
    pub flags: &'a [&'a str],
}

/// Compiles and links; returns the program's path, or the compiler's output.
pub fn build(program: &Program) -> Result<PathBuf, String> {
    let cpp = program.source.extension().is_some_and(|e| e == "cpp");
    let mut build = target().compiler(cpp, program.out);
    build.opt_level(2).debug(false).warnings(true).extra_warnings(true).static_crt(false);
    build.std(if cpp { if target().is_msvc() { "c++14" } else { "c++11" } } else { "c11" });
    let compiler = build.try_get_compiler().map_err(|e| format!("no C++ compiler was found: {e}"))?;

    // A unique name: Windows may still lock the file of a program that has just run.
    static BUILT: AtomicUsize = AtomicUsize::new(0);
    let stem = program.source.file_stem().unwrap_or_default().display();
    let name = program.out.join(format!("{stem}-{}", BUILT.fetch_add(1, Ordering::Relaxed)));
    let exe = name.with_extension(target().executable_extension());
    let mut command = compiler.to_command();
    command.current_dir(program.out);
    for (name, value) in program.defines {
        command.arg(format!("-D{name}={value}"));
    }
    command.args(program.flags).arg("-I").arg(root().join("include")).arg(program.source);
    let library = library(program.link)?;
    if compiler.is_like_msvc() {
        let mut out = std::ffi::OsString::from("/Fe:");
        out.push(&exe);
        command.arg("/EHsc").arg(out).arg(library);
        command.args(["kernel32.lib", "ntdll.lib", "userenv.lib", "ws2_32.lib", "dbghelp.lib"]);
    } else {
        command.arg("-o").arg(&exe);
        target().link(&mut command, &library, program.link == Link::Shared);
    }
    run(&mut command).map(|_| exe)
}

/// Runs a command to completion; returns its output, or why it failed.
pub fn run(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|e| format!("{}: {e}", command.get_program().display()))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    if output.status.success() {
        return Ok(text(&output.stdout).replace("\r\n", "\n"));
    }
    Err(format!(
        "{}\n{}{}{}",
        command.get_program().display(),
        text(&output.stdout),
        text(&output.stderr),
        output.status
    ))
}
