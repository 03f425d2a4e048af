//! The cost of merging relative to drawing, as in table 1 of the 2018 article on merging, for the generated landscape.

use crate::setting::RULES;
use demo::options::Rule;
use tools::Result;
use tools::merging::landscape::Landscape;
use tools::merging::measure::{Measured, measure};
use tools::merging::truth::Truth;

/// The sizes in the article.
const SIZES: [(u32, u32); 3] = [(640, 400), (1280, 800), (1920, 1080)];
const BOXES: u32 = 8_000;

pub struct Row {
    pub size: (u32, u32),
    pub rule: Rule,
    /// Number of hidden boxes.
    pub hidden: usize,
    pub measured: Measured,
}

impl Row {
    /// The time of the merge as a percentage of the time of drawing both buffers.
    pub fn share(&self) -> f64 {
        100.0 * self.measured.merge / (self.measured.terrain + self.measured.foreground)
    }
}

pub const fn rows() -> usize {
    SIZES.len() * RULES.len()
}

pub fn study(repeats: u32, mut tick: impl FnMut()) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for size in SIZES {
        let landscape = Landscape::generate(size.0 as f32 / size.1 as f32, BOXES);
        let truth = Truth::new(&landscape, size.0, size.1);
        for rule in RULES {
            let measured = measure(&landscape, &truth, size, rule.into(), repeats)?;
            rows.push(Row { size, rule, hidden: truth.hidden, measured });
            tick();
        }
    }
    Ok(rows)
}
