//! Draws terrain and foreground into two buffers and merges them, compared with drawing everything into one buffer.
//!
//! After Davies and Strugar's article of 2018 on merging the buffers of masked occlusion culling: a piece of terrain
//! spans so wide a range of depth that it cannot be sorted among the objects in front of it, and the quick rule forgets
//! near surfaces if the two alternate in a sub-tile. So each is drawn into its own buffer, on its own thread, and one
//! buffer is merged into the other. In the article's table 1 the merge takes 0.9, 2.5 and 4.4 percent of the drawing
//! time, at the three sizes that are measured here.
//!
//! The scene is generated: a bumpy height field in pieces, and hundreds of towers near the eye. Boxes are scattered
//! over it and tested by their screen rectangles. A plain z-buffer with a depth for each pixel determines which of them
//! are hidden: the table gives the percentage of those that each way culls, and how many were culled although the
//! z-buffer shows them, which must be none. Drawing includes clearing the buffers; times are medians, with the two ways
//! measured alternately.

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};
use masked_occlusion_culling::UpdateRule;

use tools::merging::landscape::Landscape;
use tools::merging::measure;
use tools::merging::truth::Truth;

const RULES: [(&str, UpdateRule); 4] = [
    ("three-layer", UpdateRule::ThreeLayer),
    ("quick", UpdateRule::Quick),
    ("accurate", UpdateRule::Accurate),
    ("four-layer", UpdateRule::FourLayer),
];

/// Compares one buffer for everything with separate buffers for terrain and foreground that are merged.
#[derive(Parser)]
#[command(name = "merge")]
struct Args {
    /// Number of boxes that are scattered and tested
    #[arg(long, value_name = "N", default_value_t = 8000)]
    boxes: u32,

    /// Width and height of the buffers in pixels (default: the three of the article)
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<(u32, u32)>,

    /// Number of times each way is drawn
    #[arg(long, value_name = "N", default_value_t = 101, value_parser = clap::value_parser!(u32).range(1..))]
    repeats: u32,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args = Args::parse();
    let sizes = args.size.map_or(vec![(640, 400), (1280, 800), (1920, 1080)], |size| vec![size]);
    let bar = ProgressBar::new((sizes.len() * RULES.len()) as u64)
        .with_style(ProgressStyle::with_template("{bar:40} {pos} of {len} lines of the table, {elapsed}")?);
    let mut falsely = 0;
    for (i, &(width, height)) in sizes.iter().enumerate() {
        let landscape = Landscape::generate(width as f32 / height as f32, args.boxes);
        let truth = Truth::new(&landscape, width, height);
        if i == 0 {
            say(&bar, &landscape.summary());
            say(&bar, HEADING);
        }
        for (name, rule) in RULES {
            let m = measure::measure(&landscape, &truth, (width, height), rule, args.repeats)?;
            falsely += m.falsely;
            let size = format!("{width}x{height}");
            let share = |culled: usize| 100.0 * culled as f64 / truth.hidden.max(1) as f64;
            let sum = m.terrain + m.foreground;
            let line = format!(
                "{size:10} {name:11} {:>6} {:>6.1}% {:>6.1}% {:>7} {:>8.3} {:>8.3} {:>8.3} {:>8.3} {:>7.3} {:>6.1}% {:>7.2}x",
                truth.hidden,
                share(m.culled_one),
                share(m.culled_two),
                m.falsely,
                m.one * 1e3,
                m.terrain * 1e3,
                m.foreground * 1e3,
                m.both * 1e3,
                m.merge * 1e3,
                100.0 * m.merge / sum,
                m.one / (m.both + m.merge),
            );
            say(&bar, &line);
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    if falsely > 0 {
        return Err(format!("{falsely} boxes were culled although they are not hidden").into());
    }
    Ok(())
}

const HEADING: &str = concat!(
    "                              hidden boxes culled               milliseconds of                           merge of\n",
    "size       rule        hidden     one     two   false one buf.  terrain  foregr.  at once   merge drawing  speedup",
);

/// Prints a line above the progress bar, which is hidden if there is no terminal.
fn say(bar: &ProgressBar, line: &str) {
    bar.suspend(|| println!("{line}"));
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let part = |n: &str| n.parse::<u32>().ok().filter(|n| (1..=16_384).contains(n));
    let (width, height) = text.split_once(['x', 'X']).ok_or("a size such as 1920x1080 is expected")?;
    part(width).zip(part(height)).ok_or("each side has from 1 to 16384 pixels".into())
}
