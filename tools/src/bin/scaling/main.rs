//! Measures how drawing time grows: with triangles, with pixels, and with sheets one behind another. Another library
//! with the same C++ class can be measured alongside; docs/benchmarking.md explains how.

mod args;

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

use tools::Result;
use tools::scaling::culler::Culler;
use tools::scaling::other::Other;
use tools::scaling::ours::Ours;
use tools::scaling::table::{self, Row};
use tools::scaling::{job, measure, plot};

use args::{Args, Isa};

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            let _ = writeln!(io::stderr(), "scaling: {e}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<()> {
    let isa = args.isa.unwrap_or(Isa::Avx512) as i32;
    let mut cullers: Vec<Box<dyn Culler>> = vec![Box::new(Ours::new(args.rule, isa)?)];
    if let Some(path) = &args.other {
        cullers.push(Box::new(Other::load(path, isa)?));
    }
    let libraries: Vec<String> = cullers.iter().map(|c| c.name()).collect();
    // Before minutes of measuring rather than after.
    fs::create_dir_all(&args.out).map_err(|e| format!("cannot make {}: {e}", args.out.display()))?;

    let jobs = job::jobs(args.most);
    let bar = ProgressBar::new(jobs.len() as u64).with_style(ProgressStyle::with_template(
        "{bar:40} {pos} of {len} points, {elapsed} of about {duration}: {msg}",
    )?);
    say(&bar, &table::heading(&libraries));
    let mut rows = Vec::new();
    for job in jobs {
        bar.set_message(job.study.name());
        let scene = job.scene();
        let samples = measure::measure(&mut cullers, &scene, job.size, args.seconds)?;
        rows.push(Row { job, triangles: scene.triangles(), samples });
        say(&bar, &table::line(&rows[rows.len() - 1]));
        bar.inc(1);
    }
    bar.finish_and_clear();

    let csv = args.out.join("scaling.csv");
    let file = File::create(&csv).map_err(|e| format!("cannot write {}: {e}", csv.display()))?;
    table::write_csv(BufWriter::new(file), &libraries, &rows)?;
    plot::write(&args.out, &libraries, &rows)?;
    say(&bar, &format!("written to {}", args.out.display()));
    Ok(())
}

/// Prints a line above the progress bar. Errors are ignored: the files are written even if nobody reads the output.
fn say(bar: &ProgressBar, line: &str) {
    bar.suspend(|| {
        let _ = writeln!(io::stdout(), "{line}");
    });
}
