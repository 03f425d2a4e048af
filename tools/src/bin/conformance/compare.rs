//! Compares one screen, triangle by triangle: the driver's coverage against the library's.

use std::error::Error;

use indicatif::ProgressBar;

use crate::driver::{BATCH, Driver, Vertices, WORDS};
use crate::kinds::{Kind, Triangles};
use crate::ours::Ours;
use crate::ties::ties;
use crate::view::View;
use tools::oracle::{Triangle, span};

/// The tally for one kind.
#[derive(Clone, Default)]
pub struct Tally {
    pub triangles: u64,
    /// Triangles of which the library covers at least one pixel.
    pub covering: u64,
    pub pixels: u64,
    /// Pixels that the library covers.
    pub covered: u64,
    /// Pixels whose centres are exactly on an edge, counted once per edge: those that the fill rule decides.
    pub ties: u64,
    /// Pixels that only one of the two covers, and triangles that have any.
    pub differences: u64,
    pub differing: u64,
    /// A description of the first of them.
    pub example: Option<String>,
}

/// Compares `count` triangles of the kinds in turn, and adds to the tally of each.
pub fn compare(
    driver: &mut dyn Driver,
    view: View,
    (kinds, seed, count): (&[Kind], u64, u64),
    tallies: &mut [Tally],
    bar: &ProgressBar,
) -> Result<(), Box<dyn Error>> {
    let mut source = Triangles::new(view, kinds, seed);
    let mut ours = Ours::new(view, driver.api().1)?;
    driver.set_view(view)?;
    let mut left = count;
    while left > 0 {
        let size = left.min(BATCH as u64);
        let batch: Vec<(usize, Triangle)> = (0..size).map(|_| source.make_next()).collect::<Result<_, _>>()?;
        let triangles: Vec<Triangle> = batch.iter().map(|b| b.1).collect();
        // Unused corners all stay at one point, and cover nothing.
        let mut vertices: Vertices = [[0.0, 0.0, 0.0, 1.0]; 3 * BATCH];
        for (to, v) in vertices.iter_mut().zip(triangles.iter().flatten()) {
            *to = view.driver_vertex(v);
        }
        driver.draw(&vertices)?;
        let covered = ours.draw(&triangles)?;
        let differing = differences(driver.read()?, &ours, view);
        for (i, (kind, t)) in batch.iter().enumerate() {
            let tally = &mut tallies[*kind];
            tally.triangles += 1;
            tally.pixels += view.pixels() as u64;
            tally.covering += u64::from(covered[i] > 0);
            tally.covered += covered[i];
            tally.ties += ties(t, view);
            if let Some(first) = differing[i].first {
                tally.differences += differing[i].pixels;
                tally.differing += 1;
                tally.example.get_or_insert_with(|| tell(t, view, first, differing[i].ours));
            }
        }
        left -= size;
        bar.inc(size);
    }
    Ok(())
}

/// The difference for one triangle.
#[derive(Clone, Copy, Default)]
struct Difference {
    pixels: u64,
    /// The first pixel that differs, and whether it is the library that covers it.
    first: Option<usize>,
    ours: bool,
}

/// Compares every pixel of a batch.
fn differences(theirs: &[u8], ours: &Ours, view: View) -> Vec<Difference> {
    let mut found = vec![Difference::default(); BATCH];
    let (pixels, _) = theirs.as_chunks::<{ 4 * WORDS }>();
    assert_eq!(pixels.len(), view.pixels(), "the driver gave another number of pixels");
    for (word, plane) in ours.planes().enumerate() {
        for (at, (pixel, &mine)) in pixels.iter().zip(plane).enumerate() {
            let (words, _) = pixel.as_chunks::<4>();
            let mut differing = u32::from_ne_bytes(words[word]) ^ mine;
            while differing != 0 {
                let bit = differing.trailing_zeros();
                differing &= differing - 1;
                let difference = &mut found[word * 32 + bit as usize];
                difference.pixels += 1;
                if difference.first.is_none() {
                    difference.first = Some(at);
                    difference.ours = mine >> bit & 1 == 1;
                }
            }
        }
    }
    found
}

fn tell(t: &Triangle, view: View, at: usize, ours: bool) -> String {
    let (column, row) = (at % view.width, at / view.width);
    let exactly = span(t, row, view.width).contains(&column);
    let covers = |yes: bool| if yes { "covers" } else { "does not cover" };
    let corners = t.map(|v| (v.x, v.y));
    format!(
        "{}x{}, corners in 1/256 pixel {corners:?}: the library {} column {column} of row {row}, the driver {} it; \
         by the top-left rule in integers it {}",
        view.width,
        view.height,
        covers(ours),
        covers(!ours),
        if exactly { "is covered" } else { "is not covered" },
    )
}
