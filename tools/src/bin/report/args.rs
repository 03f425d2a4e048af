//! The command line.

use std::path::PathBuf;

use clap::Parser;

/// Measures speed against error for each setting, and writes one HTML page with plots, tables and pictures.
#[derive(Debug, Parser)]
#[command(name = "report")]
pub struct Args {
    /// Scenes to be measured after the generated ones: .obj, .gltf or .glb files; the cameras of glTF files are used
    pub files: Vec<PathBuf>,

    /// File for the page
    #[arg(long, value_name = "FILE", default_value = "target/report.html")]
    pub out: PathBuf,

    /// Number of times each frame is measured
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = clap::value_parser!(u32).range(1..=10_001))]
    pub repeats: u32,

    /// Every update rule with every resolution, order, number of buffers, instruction set and number of threads: hours
    #[arg(long)]
    pub every: bool,

    /// A few settings on small screens: takes seconds, to check that everything works
    #[arg(long, conflicts_with = "every")]
    pub short: bool,

    /// Omits the generated scenes from the measurement of settings
    #[arg(long, requires = "files")]
    pub only_files: bool,

    /// A shared object built from tools/src/scaling/other.cpp and another library, to be included in the plots of cost
    #[arg(long, value_name = "FILE")]
    pub other: Option<PathBuf>,
}

impl Args {
    /// The command line as shown on the page, after the program's name; only the file names of paths.
    pub fn shown(&self) -> String {
        let mut shown = String::new();
        let mut add = |is_set: bool, text: &str| {
            if is_set {
                shown += if shown.is_empty() { " -- " } else { " " };
                shown += text;
            }
        };
        add(self.short, "--short");
        add(self.every, "--every");
        add(true, &format!("--repeats {}", self.repeats));
        add(self.only_files, "--only-files");
        add(self.other.is_some(), "--other ...");
        for file in &self.files {
            add(true, &file.file_name().unwrap_or_default().to_string_lossy());
        }
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_go_together_is_refused() {
        assert!(Args::try_parse_from(["report", "--short", "a.obj", "b.glb", "--only-files"]).is_ok());
        for bad in [&["--every", "--short"][..], &["--only-files"], &["--repeats", "0"]] {
            assert!(Args::try_parse_from(["report"].iter().chain(bad)).is_err(), "{bad:?} is accepted");
        }
    }
}
