//! Speed against error: measures settings of the library on generated scenes and given files, and writes one HTML page.

mod args;
mod baseline;
mod blocks;
mod file_cameras;
mod frame;
mod hall;
mod hiz;
mod leaks;
mod machine;
mod merging;
mod page;
mod passes;
mod plots;
mod scatter;
mod setting;
mod sizes;
mod subject;
mod survey;
mod tables;
mod visibility;

use std::fs::{self, File};
use std::io::{self, Write};
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

use demo::image::Image;
use demo::options;
use tools::Result;
use tools::scaling::{self, culler::Culler};

use args::Args;
use scatter::Baseline;
use setting::{Extent, ORDERS, Order, RULES, SCREEN, Setting};
use subject::Subject;
use survey::Survey;

/// The contents of the page.
struct Findings {
    surveys: Vec<Survey>,
    /// One for each of them.
    baselines: Vec<Vec<Baseline>>,
    /// The command line after the program's name.
    arguments: String,
    settings: usize,
    repeats: u32,
    leaks: Vec<(Image, String)>,
    scaling: Vec<String>,
    passes: Vec<(String, Vec<passes::Row>)>,
    sizes: Vec<sizes::Row>,
    /// The screen that they are drawn on.
    sizes_on: (u32, u32),
    libraries: Vec<String>,
    merging: Vec<merging::Row>,
}

/// Medians of fewer repeats vary too much from run to run for a comparison of settings.
const ENOUGH: u32 = 5;

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            let _ = writeln!(io::stderr(), "report: {e}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<()> {
    let extent = match (args.short, args.every) {
        (true, _) => Extent::Short,
        (_, true) => Extent::Every,
        _ => Extent::Usual,
    };
    if let Some(folder) = args.out.parent() {
        fs::create_dir_all(folder).map_err(|e| format!("cannot create {}: {e}", folder.display()))?;
    }
    let mut subjects = if args.only_files { Vec::new() } else { Subject::generated() };
    for file in &args.files {
        subjects.push(Subject::load(file)?);
    }
    let best = setting::best_isa() as i32;
    let mut cullers: Vec<Box<dyn Culler>> = vec![Box::new(scaling::ours::Ours::new(options::Rule::ThreeLayer, best)?)];
    if let Some(path) = &args.other {
        cullers.push(Box::new(scaling::other::Other::load(path, best)?));
    }
    cullers.push(Box::new(baseline::HizCuller::new()));
    // Before minutes of measuring rather than after.
    let complain = |e| format!("cannot write {}: {e}", args.out.display());
    let mut page = File::create(&args.out).map_err(complain)?;
    let found = measure_all(args, extent, &subjects, cullers)?;
    page.write_all(page::write(&found)?.as_bytes()).map_err(complain)?;
    say(&found.summary());
    say(&format!("\nwritten to {}", args.out.display()));
    match (found.falsely(), found.other_bits()) {
        (0, 0) => Ok(()),
        (falsely, bits) => Err(format!("{falsely} falsely culled, {bits} buffers with differing bits").into()),
    }
}

fn measure_all(
    args: &Args,
    extent: Extent,
    subjects: &[Subject],
    mut cullers: Vec<Box<dyn Culler>>,
) -> Result<Findings> {
    let settings = setting::settings(extent);
    let repeats = args.repeats;
    let is_short = extent == Extent::Short;
    let (most, limit) = if is_short { (3_000, 0.001) } else { (1_000_000, 1.0) };
    let limit = Duration::from_secs_f64(limit);
    let jobs = scaling::job::jobs(most);
    let views: usize = subjects.iter().map(|s| s.views.len()).sum();
    let steps =
        views * (settings.len() + ORDERS.len()) + 2 * subjects.len() + jobs.len() + sizes::rows() + merging::rows();
    let style = "{bar:40} {pos} of {len} steps, {elapsed} of about {duration}: {msg}";
    let bar = ProgressBar::new(steps as u64).with_style(ProgressStyle::with_template(style)?);

    let mut found = Findings {
        surveys: Vec::new(),
        baselines: Vec::new(),
        arguments: args.shown(),
        settings: settings.len(),
        repeats,
        leaks: Vec::new(),
        scaling: Vec::new(),
        passes: Vec::new(),
        sizes: Vec::new(),
        sizes_on: if is_short { (640, 360) } else { SCREEN },
        libraries: Vec::new(),
        merging: Vec::new(),
    };
    for subject in subjects {
        bar.set_message(subject.name.clone());
        found.surveys.push(survey::survey(subject, &settings, repeats, || bar.inc(1))?);
        found.baselines.push(baseline::survey(subject, repeats, || bar.inc(1))?);
        found.leaks.extend(leak_pictures(subject)?);
        bar.inc(1);
        found.passes.push((subject.name.clone(), passes::study(subject, repeats)?));
        bar.inc(1);
    }

    bar.set_message("cost");
    found.libraries = cullers.iter().map(|c| c.name()).collect();
    let mut rows = Vec::new();
    for job in jobs {
        let scene = job.scene();
        let samples = scaling::measure::measure(&mut cullers, &scene, job.size, limit)?;
        rows.push(scaling::table::Row { job, triangles: scene.triangles(), samples });
        bar.inc(1);
    }
    found.scaling = scaling_plots(&found.libraries, &rows)?;
    bar.set_message("sizes of triangles");
    found.sizes = sizes::study(&mut cullers, found.sizes_on, limit, || bar.inc(1))?;
    bar.set_message("merging");
    found.merging = merging::study(if is_short { 1 } else { 3 * repeats }, || bar.inc(1))?;
    bar.finish_and_clear();
    Ok(found)
}

/// The first view, drawn with each rule, and with the quick rule into two buffers.
fn leak_pictures(subject: &Subject) -> Result<Vec<(Image, String)>> {
    let view = &subject.views[0];
    let occluders = frame::occluders(subject, view, Order::Near);
    let truth = visibility::Visibility::new(subject, view, &[], SCREEN);
    let ways = RULES.map(|rule| (rule, 1)).into_iter().chain([(options::Rule::Quick, 2)]);
    let mut depth = vec![0.0; (SCREEN.0 * SCREEN.1) as usize];
    let mut pictures = Vec::new();
    for (rule, buffers) in ways {
        let (size, isa) = (SCREEN, setting::best_isa());
        let setting = Setting { rule, size, order: Order::Near, buffers, isa, threads: 1 };
        let mut frames = frame::Frames::new(&setting, &occluders, view.near)?;
        frames.draw()?;
        frames.result().compute_pixel_depth_buffer(&mut depth, false)?;
        let share = leaks::leaking(&depth, &truth.exact, view.near).percent();
        let merged = if buffers > 1 { ", two buffers merged" } else { "" };
        let caption = format!("{}, {}{merged}: {share:.2}% of the covered pixels leak", subject.name, rule.name());
        pictures.push((leaks::picture(&depth, &truth.exact, view.near), caption));
    }
    Ok(pictures)
}

/// The plots that `scaling` writes.
fn scaling_plots(libraries: &[String], rows: &[scaling::table::Row]) -> Result<Vec<String>> {
    let folder = tempfile::tempdir()?;
    scaling::plot::write(folder.path(), libraries, rows)?;
    let mut plots = Vec::new();
    for name in ["triangles.svg", "pixels.svg", "depth.svg"] {
        let file = folder.path().join(name);
        if file.exists() {
            plots.push(fs::read_to_string(file)?);
        }
    }
    Ok(plots)
}

impl Findings {
    fn falsely(&self) -> usize {
        let of_surveys = self.surveys.iter().flat_map(|s| &s.points).map(|p| p.falsely);
        of_surveys.chain(self.merging.iter().map(|m| m.measured.falsely)).sum()
    }

    fn same_bits(&self) -> usize {
        self.surveys.iter().map(|s| s.same_bits + s.other_bits).sum()
    }

    fn other_bits(&self) -> usize {
        self.surveys.iter().map(|s| s.other_bits).sum()
    }

    /// The warning about too few repeats.
    fn caution(&self) -> Option<String> {
        let times = if self.repeats == 1 { "once".into() } else { format!("{} times", self.repeats) };
        (self.repeats < ENOUGH).then(|| {
            format!("Each frame was timed only {times}: times and ratios of times are mostly noise (see --repeats).")
        })
    }

    /// The closing message.
    fn summary(&self) -> String {
        let mut text: Vec<String> = self.caution().into_iter().collect();
        text.extend([
            "Percentage of hidden objects / boxes culled, and time relative to the quick rule:".into(),
            tables::rules(&self.surveys).text(),
        ]);
        for table in tables::effects(&self.surveys) {
            text.push(String::new());
            text.push(table.text());
        }
        for (name, rows) in &self.passes {
            text.push(format!("\nPasses, {name}:"));
            text.push(tables::passes(rows).text());
        }
        text.push("\nCost by the size of triangles:".into());
        text.push(tables::sizes(&self.sizes, &self.libraries).text());
        text.push("\nMerging:".into());
        text.push(tables::merging(&self.merging).text());
        let (falsely, same, other) = (self.falsely(), self.same_bits(), self.other_bits());
        text.push(format!("\nfalsely culled: {falsely}; buffers compared: {same}, different: {other}"));
        text.join("\n")
    }
}

/// Prints. Errors are ignored: the page is written even if nobody reads the output.
fn say(text: &str) {
    let _ = writeln!(io::stdout(), "{text}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_repeats_are_called_noise() {
        let found = |repeats| Findings {
            surveys: Vec::new(),
            baselines: Vec::new(),
            arguments: String::new(),
            settings: 0,
            repeats,
            leaks: Vec::new(),
            scaling: Vec::new(),
            passes: Vec::new(),
            sizes: Vec::new(),
            sizes_on: SCREEN,
            libraries: Vec::new(),
            merging: Vec::new(),
        };
        assert!(found(1).summary().contains("only once: times and ratios"));
        assert!(!found(ENOUGH).summary().contains("noise"));
    }
}
