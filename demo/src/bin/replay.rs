//! Plays a frame that an engine recorded (`RecorderStart`, a .mocrec file): compares the answers with those recorded, takes
//! the time, and draws the depths.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;

use demo::options::{Isa, Rule, isa};
use demo::play;

/// Plays a recorded frame, checks its answers, and takes the time.
#[derive(Debug, Parser)]
#[command(name = "replay")]
struct Args {
    /// A .mocrec file
    file: PathBuf,

    /// How often it is played for the time
    #[arg(long, value_name = "N", default_value_t = 101, value_parser = clap::value_parser!(u32).range(1..))]
    repeats: u32,

    /// How the buffer takes in triangles
    #[arg(long, value_enum, default_value_t = Rule::ThreeLayer)]
    rule: Rule,

    /// The highest instruction set that may be used (default: the best that the processor has)
    #[arg(long, value_name = "ISA", value_parser = isa)]
    isa: Option<Isa>,

    /// Where the picture of the depths is written
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
