//! Whether there is a working C++ compiler, and what is wrong if there is not.

use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

use crate::{Result, native};

/// A one-line error if the compiler that would be used does not work.
pub fn find(folder: &Path) -> Result<()> {
    let tool = native::target().compiler(true, folder).opt_level(2).try_get_compiler();
    // If no tool was found, the only known name is the requested one.
    let name = match &tool {
        Ok(tool) => tool.path().to_owned(),
        Err(_) => std::env::var_os("CXX").unwrap_or_else(|| "c++".into()).into(),
    };
    let reason = match tool {
        Ok(tool) => match version(&tool) {
            Ok(status) if status.success() || tool.is_like_msvc() => return Ok(()),
            Ok(_) => "does not work",
            Err(_) => "was not found",
        },
        Err(_) => "was not found",
    };
    Err(format!("no C++ compiler: {} {reason} (set CXX)", name.display()).into())
}

/// Asks for the version, which every compiler but Microsoft's knows.
fn version(tool: &cc::Tool) -> std::io::Result<ExitStatus> {
    let mut command = Command::new(tool.path());
    command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status()
}

/// The compiler's output without the first line, which has the command and the whole environment.
pub fn complaint(error: String) -> String {
    match error.split_once('\n') {
        Some((_, said)) => format!("the C++ compiler failed:\n{}", said.trim_end()),
        None => error,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_complaint_leaves_the_environment_out() {
        assert_eq!(
            complaint("env -i HOME=\"/me\" \"c++\"\nno such header\nstatus 1\n".into()),
            "the C++ compiler failed:\nno such header\nstatus 1"
        );
        assert_eq!(complaint("the library is missing".into()), "the library is missing");
    }
}
