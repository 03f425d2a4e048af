//! A judge that is not of this project: the coverage of random and adversarial triangles against that of a graphics driver,
//! pixel by pixel, in the orientation of Direct3D and Vulkan and in that of OpenGL.
//!
//! `cargo run --release --example judge -- --count 1000000`
//!
//! The driver is any for Vulkan and for OpenGL by way of EGL; Mesa's lavapipe and llvmpipe draw on the processor. Each
//! triangle is drawn alone by both sides, and every pixel of the screen is compared. How snapping and clipping, in
//! which drivers may differ, are kept out of it is said in `view.rs`, how many triangles share a draw and stay
//! apart in `driver.rs`. `docs/judge.md` has what was found.
//!
//! The status is 1 when any pixel differs, and 2 when nothing could be compared.

mod args;
mod compare;
mod driver;
mod kinds;
mod opengl;
#[path = "../../tests/oracle/mod.rs"]
mod oracle;
mod ours;
mod ties;
#[path = "../../tests/support/triangles.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod triangles;
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
use oracle::UNIT;
use view::View;
use vulkan::Vulkan;

fn main() -> ExitCode {
    match judge(&Args::parse()) {
        Ok(0) => ExitCode::SUCCESS,
        Ok(differences) => {
            eprintln!("FAILED: {differences} pixels differ");
            ExitCode::from(1)
        }
        Err(why) => {
            eprintln!("nothing could be compared: {why}");
            ExitCode::from(2)
        }
    }
}

/// How many pixels differ.
fn judge(args: &Args) -> Result<u64, Box<dyn Error>> {
    let device = args.device.as_deref();
    let mut differences = 0;
    if args.api != Api::Opengl {
        differences += with(args, &mut Vulkan::open(device)?)?;
    }
    if args.api != Api::Vulkan {
        differences += with(args, &mut OpenGl::open(device)?)?;
    }
    Ok(differences)
}

/// Compares with one driver, and prints what was seen.
fn with(args: &Args, driver: &mut dyn Driver) -> Result<u64, Box<dyn Error>> {
    let (api, axis) = driver.api();
    println!("{api}, rows {axis:?}: {}", driver.name());
    let bits = driver.subpixel_bits();
    if i64::from(bits) < i64::from(UNIT.ilog2()) {
        return Err(format!("{bits} bits of subpixels do not hold the grid of 1/256").into());
    }
    let (kinds, sizes) = (args.kinds(), args.sizes());
    let bar = ProgressBar::new(sizes.iter().map(|s| s.1).sum()).with_style(ProgressStyle::with_template(
        "{bar:40} {human_pos} of {human_len} triangles, {elapsed}, {eta} left",
    )?);
    let mut tallies = vec![Tally::default(); kinds.len()];
    let start = Instant::now();
    for (i, (size, count)) in sizes.into_iter().enumerate() {
        let view = View::new(size, driver.most_side())?;
        // Other triangles on every screen.
        let seed = args.seed.wrapping_mul(1 << 8).wrapping_add(i as u64);
        compare(driver, view, (&kinds, seed, count), &mut tallies, &bar)?;
    }
    bar.finish_and_clear();
    let total = print(&kinds, &tallies);
    println!("{bits} bits of subpixels, seed {}, {:.0} s\n", args.seed, start.elapsed().as_secs_f64());
    Ok(total)
}

/// Prints the table, and says how many pixels differ.
fn print(kinds: &[Kind], tallies: &[Tally]) -> u64 {
    let heads = ["triangles", "pixels", "covered", "on an edge", "differences"];
    println!("| {:<15} | {} |", "kind", heads.map(|head| format!("{head:>13}")).join(" | "));
    println!("|{:-<17}|{}", "", "--------------:|".repeat(heads.len()));
    let line = |name: &str, t: &Tally| {
        let figures = [t.triangles, t.pixels, t.covered, t.ties, t.differences];
        println!("| {name:<15} | {} |", figures.map(|n| format!("{n:>13}")).join(" | "));
    };
    let mut all = Tally::default();
    for (kind, tally) in kinds.iter().zip(tallies) {
        line(&kind.name(), tally);
        all.triangles += tally.triangles;
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
