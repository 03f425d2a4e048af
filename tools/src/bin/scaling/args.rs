//! The command line.

use std::path::PathBuf;
use std::time::Duration;

use clap::Parser;

use demo::options::isa;
pub use demo::options::{Isa, Rule};

/// Measures how drawing time grows with triangles, pixels and depth, and plots it.
#[derive(Debug, Parser)]
#[command(name = "scaling")]
pub struct Args {
    /// A shared object built from scaling/other.cpp and another library, to be measured alternately with this one
    #[arg(long, value_name = "FILE")]
    pub other: Option<PathBuf>,

    /// Update rule of the buffer; the other library uses the rule that it was compiled with
    #[arg(long, value_enum, default_value_t = Rule::ThreeLayer)]
    pub rule: Rule,

    /// The highest instruction set that may be used (default: the best of the processor)
    #[arg(long, value_name = "ISA", value_parser = isa)]
    pub isa: Option<Isa>,

    /// Time limit for a point, all libraries and repeats together
    #[arg(long, value_name = "SECONDS", default_value = "2", value_parser = seconds, allow_negative_numbers = true)]
    pub seconds: Duration,

    /// Skips terrains of more triangles than this; ten million take 200 MB of memory
    #[arg(long, value_name = "TRIANGLES", default_value_t = 10_000_000)]
    pub most: u32,

    /// Folder for scaling.csv and the plots
    #[arg(long, value_name = "DIR", default_value = "docs/scaling")]
    pub out: PathBuf,
}

fn seconds(text: &str) -> Result<Duration, String> {
    let number = text.parse().ok().filter(|s: &f64| *s > 0.0 && *s <= 3600.0);
    number.map(Duration::from_secs_f64).ok_or("a number above 0 and up to 3600 is expected".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tools::scaling::culler::isa_name;

    #[test]
    fn values_are_read_and_checked() {
        let args = Args::try_parse_from(["scaling", "--rule", "quick", "--isa", "avx2", "--seconds", "0.5"]).unwrap();
        assert_eq!((args.rule, args.isa, args.seconds), (Rule::Quick, Some(Isa::Avx2), Duration::from_millis(500)));
        for bad in [["--seconds", "0"], ["--seconds", "nan"], ["--seconds", "-1"], ["--most", "many"], ["--isa", "mmx"]]
        {
            assert!(Args::try_parse_from(["scaling", bad[0], bad[1]]).is_err(), "{bad:?} is accepted");
        }
        assert_eq!(
            (isa_name(3), isa_name(-1), isa_name(9)),
            ("avx512".into(), "scalar".into(), "instruction set 9".into())
        );
    }
}
