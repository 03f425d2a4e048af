//! Plays a frame recorded by an engine (`RecorderStart`, a .mocrec file): compares the results with the recorded ones,
//! measures the time, and draws the depths.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;

use demo::options::{Isa, Rule, isa};
use demo::play;

/// Plays a recorded frame, checks its results, and measures the time.
#[derive(Debug, Parser)]
#[command(name = "replay")]
struct Args {
    /// A .mocrec file
    file: PathBuf,

    /// Number of times it is played for the measurement
    #[arg(long, value_name = "N", default_value_t = 101, value_parser = clap::value_parser!(u32).range(1..))]
    repeats: u32,

    /// Update rule of the buffer
    #[arg(long, value_enum, default_value_t = Rule::ThreeLayer)]
    rule: Rule,

    /// The highest instruction set that may be used (default: the best of the processor)
    #[arg(long, value_name = "ISA", value_parser = isa)]
    isa: Option<Isa>,

    /// File for the picture of the depths
    #[arg(long, value_name = "FILE", default_value = "target/replay/depth.png")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let args = Args::parse();
    let played = play::run(&play::Options {
        file: &args.file,
        rule: args.rule,
        isa: args.isa,
        repeats: args.repeats,
        picture: args.out,
    });
    match played {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("replay: {error}");
            ExitCode::FAILURE
        }
    }
}
