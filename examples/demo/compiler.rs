//! Is there a C++ compiler?

use std::path::Path;
use std::process::{Command, Stdio};

use crate::Result;

/// Says in one line when the compiler that would be used cannot be started.
pub fn find(folder: &Path) -> Result<()> {
    let target = env!("MOC_TARGET");
    let tool = cc::Build::new()
        .cpp(true)
        .target(target)
        .host(target)
        .opt_level(2)
        .out_dir(folder)
        .cargo_metadata(false)
        .cargo_warnings(false)
        .try_get_compiler();
    // Without a tool there is no name but the one that was asked for.
    let name = match &tool {
        Ok(tool) => tool.path().to_owned(),
        Err(_) => std::env::var_os("CXX").unwrap_or_else(|| "c++".into()).into(),
    };
    let starts = |tool: cc::Tool| {
        let mut command = Command::new(tool.path());
        command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok()
    };
    if tool.is_ok_and(starts) {
        return Ok(());
    }
    Err(format!("no C++ compiler: {} was not found (set CXX)", name.display()).into())
}
