//! Conformance of coverage: random and adversarial triangles are compared with a graphics driver, pixel by pixel, in
//! the orientation of Direct3D and Vulkan and in that of OpenGL.
//!
//! `cargo tool conformance -- --count 1000000`
//!
//! The driver is any for Vulkan, and for OpenGL through EGL; Mesa's lavapipe and llvmpipe draw on the CPU. Each
//! triangle is drawn alone by both sides, and every pixel of the screen is compared. `view.rs` explains how snapping
//! and clipping, in which drivers may differ, are excluded; `driver.rs` explains how triangles share a draw and stay
//! separate. `docs/conformance.md` has the results.
//!
//! The exit status is 1 if any pixel differs; otherwise 2 if a requested API could not be compared completely.

mod args;
mod compare;
mod driver;
mod kinds;
mod opengl;
mod ours;
mod ties;
mod verdict;
mod view;
mod vulkan;

use std::error::Error;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

use args::{Api, Args};
use compare::{Tally, compare};
use driver::Driver;
use kinds::Kind;
use opengl::OpenGl;
use tools::oracle::UNIT;
use verdict::{Outcome, verdict};
use view::View;
use vulkan::Vulkan;

fn main() -> ExitCode {
    let args = Args::parse();
    let device = args.device.as_deref();
    let mut outcomes = Vec::new();
    if args.api != Api::Opengl {
        outcomes.push(compare_api("Vulkan", &args, || Vulkan::open(device)));
    }
    if args.api != Api::Vulkan {
        outcomes.push(compare_api("OpenGL", &args, || OpenGl::open(device)));
    }
    let (lines, status) = verdict(&outcomes);
    for line in lines {
        eprintln!("{line}");
    }
    ExitCode::from(status)
}

/// Compares with one API's driver, if it can be opened, and prints the results.
fn compare_api<D: Driver>(api: &'static str, args: &Args, open: impl FnOnce() -> Result<D, Box<dyn Error>>) -> Outcome {
    let kinds = args.kinds();
    let mut tallies = vec![Tally::default(); kinds.len()];
    let failure = match open() {
        Ok(mut driver) => with(args, &mut driver, &kinds, &mut tallies).err().map(|why| why.to_string()),
        Err(why) => Some(format!("could not be opened: {why}")),
    };
    let triangles = tallies.iter().map(|t| t.triangles).sum();
    // The counts before a failure are included.
    let differences = if triangles > 0 { print(&kinds, &tallies) } else { 0 };
    println!();
    Outcome { api, triangles, differences, failure }
}

/// Compares with one driver.
fn with(args: &Args, driver: &mut dyn Driver, kinds: &[Kind], tallies: &mut [Tally]) -> Result<(), Box<dyn Error>> {
    let (api, axis) = driver.api();
    println!("{api}, rows {axis:?}: {}", driver.name());
    let bits = driver.subpixel_bits();
    if i64::from(bits) < i64::from(UNIT.ilog2()) {
        return Err(format!("{bits} subpixel bits cannot represent the grid of 1/256").into());
    }
    let sizes = args.sizes();
    let bar = ProgressBar::new(sizes.iter().map(|s| s.1).sum()).with_style(ProgressStyle::with_template(
        "{bar:40} {human_pos} of {human_len} triangles, {elapsed}, {eta} left",
    )?);
    let start = Instant::now();
    for (i, (size, count)) in sizes.into_iter().enumerate() {
        let view = View::new(size, driver.most_side())?;
        // Each screen gets different triangles.
        let seed = args.seed.wrapping_mul(1 << 8).wrapping_add(i as u64);
        compare(driver, view, (kinds, seed, count), tallies, &bar)?;
    }
    bar.finish_and_clear();
    println!("{bits} subpixel bits, seed {}, {:.0} s", args.seed, start.elapsed().as_secs_f64());
    Ok(())
}

/// Prints the table, and returns how many pixels differ.
fn print(kinds: &[Kind], tallies: &[Tally]) -> u64 {
    let heads = ["triangles", "covering any", "pixels", "covered", "on an edge", "differences"];
    println!("| {:<15} | {} |", "kind", heads.map(|head| format!("{head:>13}")).join(" | "));
    println!("|{:-<17}|{}", "", "--------------:|".repeat(heads.len()));
    let line = |name: &str, t: &Tally| {
        let figures = [t.triangles, t.covering, t.pixels, t.covered, t.ties, t.differences];
        println!("| {name:<15} | {} |", figures.map(|n| format!("{n:>13}")).join(" | "));
    };
    let mut all = Tally::default();
    for (kind, tally) in kinds.iter().zip(tallies) {
        line(&kind.name(), tally);
        all.triangles += tally.triangles;
        all.covering += tally.covering;
        all.pixels += tally.pixels;
        all.covered += tally.covered;
        all.ties += tally.ties;
        all.differences += tally.differences;
    }
    line("all", &all);
    for (kind, tally) in kinds.iter().zip(tallies) {
        if let Some(example) = &tally.example {
            println!("{}: {} triangles differ, the first: {example}", kind.name(), tally.differing);
        }
    }
    all.differences
}
