//! The measurements: the points of each study, in order.

use super::scene::{self, Scene};

pub const TERRAINS: [u32; 9] = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000];
const SIZES: [(u32, u32); 6] = [(640, 400), (1280, 720), (1920, 1080), (2560, 1440), (3840, 2160), (7680, 4320)];
const DEPTHS: [u32; 7] = [1, 2, 4, 8, 16, 32, 64];
const USUAL: (u32, u32) = (1920, 1080);

/// The quantity that time is plotted against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Study {
    Triangles,
    Pixels,
    FrontToBack,
    BackToFront,
}

impl Study {
    pub fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Pixels => "pixels",
            Self::FrontToBack => "depth, front to back",
            Self::BackToFront => "depth, back to front",
        }
    }
}

/// A point of a study.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    pub study: Study,
    /// Number of triangles, pixels, or sheets.
    pub amount: u32,
    pub size: (u32, u32),
}

impl Job {
    /// Generated when it is needed: a large scene takes hundreds of megabytes.
    pub fn scene(&self) -> Scene {
        match self.study {
            Study::Triangles => scene::terrain(self.amount),
            Study::Pixels => scene::lumps(),
            Study::FrontToBack => scene::sheets(self.amount, true),
            Study::BackToFront => scene::sheets(self.amount, false),
        }
    }
}

/// All points, except terrains of more than `most` triangles.
pub fn jobs(most: u32) -> Vec<Job> {
    let terrains = TERRAINS.into_iter().filter(|n| *n <= most);
    let mut jobs: Vec<Job> = terrains.map(|amount| Job { study: Study::Triangles, amount, size: USUAL }).collect();
    jobs.extend(SIZES.map(|size| Job { study: Study::Pixels, amount: size.0 * size.1, size }));
    for study in [Study::FrontToBack, Study::BackToFront] {
        jobs.extend(DEPTHS.map(|amount| Job { study, amount, size: USUAL }));
    }
    jobs
}
