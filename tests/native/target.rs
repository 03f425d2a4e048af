//! The target for which C and C++ programs are compiled: the test's own, or another one whose libraries were built
//! before (`.ci/windows`). In the latter case the environment contains
//!   MOC_TEST_TARGET      its triple
//!   MOC_TEST_LIBRARIES   the folder of its libraries
//!   MOC_TEST_RUNNER      what runs its programs here

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// See [`target`].
pub struct Target {
    pub triple: String,
    /// For another target: where its libraries are, and what runs its programs.
    other: Option<(PathBuf, String)>,
}

/// The target of C and C++ programs.
pub fn target() -> &'static Target {
    static TARGET: OnceLock<Target> = OnceLock::new();
    TARGET.get_or_init(|| {
        let variable = |name| env::var(name).unwrap_or_else(|_| panic!("MOC_TEST_TARGET is set, and {name} is not"));
        match env::var("MOC_TEST_TARGET") {
            Err(_) => Target { triple: own_triple(), other: None },
            Ok(triple) => {
                let libraries = variable("MOC_TEST_LIBRARIES").into();
                Target { triple, other: Some((libraries, variable("MOC_TEST_RUNNER"))) }
            }
        }
    })
}

/// The triple of this program, as detailed as choosing a C compiler requires.
fn own_triple() -> String {
    let arch = if cfg!(target_arch = "x86") { "i686" } else { env::consts::ARCH };
    let suffix = match () {
        () if cfg!(target_env = "gnu") => "-gnu",
        () if cfg!(target_env = "musl") => "-musl",
        () if cfg!(target_env = "msvc") => "-msvc",
        () => "",
    };
    let abi = if cfg!(target_abi = "eabihf") { "eabihf" } else { "" };
    let (vendor, os) = match env::consts::OS {
        "windows" => ("pc", "windows"),
        "macos" => ("apple", "darwin"),
        os => ("unknown", os),
    };
    format!("{arch}-{vendor}-{os}{suffix}{abi}")
}

impl Target {
    pub fn is_windows(&self) -> bool {
        self.triple.contains("-windows-")
    }

    pub fn is_msvc(&self) -> bool {
        self.triple.ends_with("-msvc")
    }

    pub fn is_linux(&self) -> bool {
        self.triple.contains("-linux-")
    }

    /// Where the libraries of another target are.
    pub fn libraries(&self) -> Option<&Path> {
        self.other.as_ref().map(|(folder, _)| folder.as_path())
    }

    /// The compiler found by the `cc` crate; `out` is a scratch folder for it.
    pub fn compiler(&self, cpp: bool, out: &Path) -> cc::Build {
        let mut build = cc::Build::new();
        build.cpp(cpp).target(&self.triple).cargo_metadata(false).cargo_warnings(false).out_dir(out);
        build.host(&own_triple());
        build
    }

    /// Runs a program that was compiled for this target.
    pub fn command(&self, program: impl AsRef<Path>) -> Command {
        match &self.other {
            None => Command::new(program.as_ref()),
            Some((_, runner)) => {
                let mut command = Command::new(runner);
                command.arg(program.as_ref());
                command
            }
        }
    }

    pub fn executable_extension(&self) -> &'static str {
        if self.is_windows() { "exe" } else { "" }
    }

    /// Additional linker arguments for a program that uses `library`, for compilers with gcc-style options.
    pub fn link(&self, command: &mut Command, library: &Path, shared: bool) {
        command.arg("-pthread").arg(library);
        if self.is_windows() {
            // Windows does not have the compiler's runtime libraries, so they are linked statically.
            command.arg("-static");
        } else if shared {
            command.arg(format!("-Wl,-rpath,{}", library.parent().unwrap_or(Path::new(".")).display()));
        }
        if !shared {
            // The libraries listed by `rustc --print native-static-libs`.
            if self.is_windows() {
                command.args(["-lkernel32", "-lntdll", "-luserenv", "-lws2_32", "-ldbghelp"]);
            } else if self.is_linux() {
                command.args(["-lgcc_s", "-lutil", "-lrt", "-ldl"]);
            }
        }
        if !self.is_windows() {
            command.arg("-lm");
        }
    }
}
