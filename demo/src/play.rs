//! Plays a recording, compares the results with the recorded ones, and measures the time.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use masked_occlusion_culling::{CullingResult, MaskedOcclusionCulling, RecordedCall, Recording};

use crate::depth_picture::{depth_picture, reduced};
use crate::options::{Isa, Rule, settings};

/// Number of differing results that are listed.
const LISTED: usize = 10;

/// How a recording is played.
pub struct Options<'a> {
    pub file: &'a Path,
    pub rule: Rule,
    pub isa: Option<Isa>,
    pub repeats: u32,
    /// File for the picture of the depths.
    pub picture: PathBuf,
}

/// Plays the recording and prints the results. Fails if a result differs from the recorded one.
pub fn run(options: &Options<'_>) -> crate::Result<()> {
    let recording = Recording::load(options.file).map_err(|error| format!("{}: {error}", options.file.display()))?;
    let settings = settings(options.isa, options.rule);
    let mut moc = MaskedOcclusionCulling::new(recording.resolution.0, recording.resolution.1, settings)?;
    say(&format!("{}: {}", options.file.display(), Content::of(&recording)));

    let differ = check(&recording, &mut moc)?;
    let times = time(&recording, &mut moc, options.repeats)?;
    say(&format!("{times}, on {:?}", moc.implementation()));

    let (width, height) = recording.resolution;
    let mut depth = vec![0.0; width as usize * height as usize];
    moc.compute_pixel_depth_buffer(&mut depth, false)?;
    if let Some(folder) = options.picture.parent() {
        std::fs::create_dir_all(folder).map_err(|e| format!("cannot create {}: {e}", folder.display()))?;
    }
    depth_picture(&depth, recording.resolution, reduced(recording.resolution)).save(&options.picture)?;
    say(&format!("depths: {}", options.picture.display()));
    if differ > 0 {
        Err(format!("{differ} results differ from the recorded ones (was another update rule used? See --rule)").into())
    } else {
        Ok(())
    }
}

/// Compares the results; returns how many differ.
fn check(recording: &Recording, moc: &mut MaskedOcclusionCulling) -> crate::Result<usize> {
    let (mut number, mut known, mut differ) = (0, 0, 0);
    recording.play(moc, |call, answer| {
        if let (Some(recorded), Some(answer)) = (call.result(), answer) {
            known += 1;
            if recorded != answer {
                differ += 1;
                if differ <= LISTED {
                    say(&format!("  call {number}, {}: recorded {}, now {}", kind(call), name(recorded), name(answer)));
                }
            }
        }
        number += 1;
    })?;
    if differ > LISTED {
        say(&format!("  and {} more", differ - LISTED));
    }
    say(&format!("answers: {known} recorded, {differ} differ"));
    if number == 0 {
        say("the recording contains no calls");
    }
    Ok(differ)
}

fn time(recording: &Recording, moc: &mut MaskedOcclusionCulling, repeats: u32) -> crate::Result<Times> {
    let style = ProgressStyle::with_template("playing {bar:40} {pos} of {len}, {elapsed}")?;
    let bar = ProgressBar::new(repeats.into()).with_style(style);
    let mut times = Vec::new();
    for _ in 0..repeats {
        let begin = Instant::now();
        recording.play(moc, |_, _| {})?;
        times.push(begin.elapsed());
        bar.inc(1);
    }
    bar.finish_and_clear();
    times.sort_unstable();
    Ok(Times(times))
}

/// Times of playing the whole recording, sorted; at least one.
struct Times(Vec<Duration>);

impl core::fmt::Display for Times {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self(times) = self;
        let micros = |at: usize| times[at].as_secs_f64() * 1e6;
        let (median, last) = (micros(times.len() / 2), times.len() - 1);
        write!(f, "time: {median:.1} us in the median of {}, from {:.1} to {:.1}", times.len(), micros(0), micros(last))
    }
}

/// A description of the recording's contents.
#[derive(Default)]
struct Content {
    resolution: (u32, u32),
    near: f32,
    clears: usize,
    rectangles: usize,
    draws: usize,
    drawn: usize,
    queries: usize,
    queried: usize,
}

impl Content {
    fn of(recording: &Recording) -> Self {
        let (resolution, near) = (recording.resolution, recording.near_clip_plane);
        let mut content = Self { resolution, near, ..Self::default() };
        for call in &recording.calls {
            match call {
                RecordedCall::ClearBuffer => content.clears += 1,
                RecordedCall::TestRect(_) => content.rectangles += 1,
                RecordedCall::RenderTriangles(mesh) => {
                    content.draws += 1;
                    content.drawn += mesh.triangles.len() / 3;
                }
                RecordedCall::TestTriangles(mesh) => {
                    content.queries += 1;
                    content.queried += mesh.triangles.len() / 3;
                }
                _ => {}
            }
        }
        content
    }
}

impl core::fmt::Display for Content {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let &Self { resolution: (width, height), near, clears, rectangles, draws, drawn, queries, queried } = self;
        write!(f, "{width}x{height}, near plane {near}: clears {clears}, draws {draws} (triangles {drawn}), ")?;
        write!(f, "queries {queries} (triangles {queried}), rectangles {rectangles}")
    }
}

fn kind(call: &RecordedCall) -> &'static str {
    match call {
        RecordedCall::ClearBuffer => "a clear",
        RecordedCall::TestRect(_) => "a rectangle",
        RecordedCall::RenderTriangles(_) => "a draw",
        RecordedCall::TestTriangles(_) => "a query",
        _ => "another call",
    }
}

fn name(result: CullingResult) -> &'static str {
    match result {
        CullingResult::Visible => "visible",
        CullingResult::Occluded => "occluded",
        CullingResult::ViewCulled => "outside the view",
    }
}

fn say(line: &str) {
    let _ = writeln!(io::stdout(), "{line}");
}
