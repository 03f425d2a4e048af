//! A million triangles in one plane, or in planes that differ by a few units in the last place: terrain, decals, walls
//! that touch, the same building drawn twice.

use masked_occlusion_culling::{CullingResult, YAxis};

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::snap::snapped;
use crate::oracle::{Oracle, Triangle, UNIT, Vertex};
use crate::support::wall;

pub const CASES: &[&Case] = &[&ONE_PLANE, &SHEETS, &BESIDE];

static ONE_PLANE: Case = Case::new("a million triangles in one slanted plane", one_plane);
static SHEETS: Case = Case::new("100 sheets of 10,000 triangles, a unit in the last place apart", sheets);

static BESIDE: Case = Case::new("queries that touch a wall, all but parallel to it", beside_a_wall);

/// A grid of vertices over the whole screen, two triangles per cell.
struct Grid {
    size: (usize, usize),
    vertices: Vec<[f32; 4]>,
    snapped: Vec<Vertex>,
    indices: Vec<u32>,
}

impl Grid {
    /// `w` gives a vertex's w from its position on the screen, 0 to 1 across and down.
    fn new(size: (usize, usize), cells: (usize, usize), w: impl Fn(f64, f64) -> f32) -> Self {
        let mut grid = Self { size, vertices: Vec::new(), snapped: Vec::new(), indices: Vec::new() };
        let at = |k: usize, cells: usize, size: usize| (k * size * UNIT as usize / cells) as f64 / UNIT as f64;
        for row in 0..=cells.1 {
            for column in 0..=cells.0 {
                let x = at(column, cells.0, size.0) / size.0 as f64;
                let y = at(row, cells.1, size.1) / size.1 as f64;
                let w = w(x, y);
                let clip = |part: f64| ((2.0 * part - 1.0) * f64::from(w)) as f32;
                let vertex = [clip(x), -clip(y), 0.0, w];
                grid.snapped.push(snapped(vertex, size, false).expect("a vertex on the grid"));
                grid.vertices.push(vertex);
            }
        }
        for row in 0..cells.1 {
            for column in 0..cells.0 {
                let first = (row * (cells.0 + 1) + column) as u32;
                let below = first + cells.0 as u32 + 1;
                // The diagonals alternate, so that no two neighbours have the plane of the same three corners.
                let halves = if (row + column) % 2 == 0 {
                    [first, first + 1, below + 1, first, below + 1, below]
                } else {
                    [first, first + 1, below, first + 1, below + 1, below]
                };
                grid.indices.extend(halves);
            }
        }
        grid
    }

    fn triangles(&self) -> impl Iterator<Item = Triangle> + Clone {
        self.indices.chunks_exact(3).map(|t| [0, 1, 2].map(|k| self.snapped[t[k] as usize]))
    }

    /// A quad over the whole screen at the grid's depths, times a factor in w.
    fn whole(&self, factor: f32) -> [[f32; 4]; 6] {
        let last = self.vertices.len() - 1;
        let columns = self.vertices.iter().position(|v| v[0] == v[3]).expect("a right border");
        [0, columns, last, 0, last, last - columns].map(|i| self.vertices[i].map(|c| c * factor))
    }
}

/// w of a slanted plane: 1/w is linear on the screen.
fn slanted(x: f64, y: f64) -> f32 {
    (1.0 / (0.01 + 0.05 * x + 0.02 * y)) as f32
}

fn one_plane() -> Measured {
    let grid = Grid::new((1024, 512), (1000, 500), slanted);
    let mut subject = Subject::new(grid.size, YAxis::Down);
    let mut oracle = Oracle::new(grid.size.0, grid.size.1);
    grid.triangles().for_each(|t| oracle.draw(&t));
    subject.draw_mesh(&grid.vertices, &grid.indices);
    let mut measured = Measured::default();
    measured.coverage(grid.triangles(), subject.depth(), &oracle);
    measured.depths(subject.depth(), &oracle);
    // All of it is visible: depth equal to the buffer's counts as visible.
    measured.shown(subject.test_mesh(&grid.vertices, &grid.indices));
    for some in grid.indices.chunks(30_000) {
        measured.shown(subject.test_mesh(&grid.vertices, some));
    }
    measured.shown(subject.test_clip(&grid.whole(1.0)));
    // At the same slant, farther surfaces are hidden once they are behind by twice the change of the plane within a
    // block of 8x4 pixels, which is a twentieth at its far end.
    assert_eq!(subject.test_clip(&grid.whole(1.12)), CullingResult::Occluded);
    measured
}

fn sheets() -> Measured {
    let (size, cells) = ((256, 128), (100, 50));
    let mut random = fastrand::Rng::with_seed(3);
    let mut sheets: Vec<u32> = (0..100).collect();
    random.shuffle(&mut sheets);
    let mut subject = Subject::new(size, YAxis::Up);
    let mut oracle = Oracle::new(size.0, size.1);
    let mut measured = Measured::default();
    // Earlier contents would hide a pixel that a sheet misses.
    let mut alone = Subject::new(size, YAxis::Up);
    for (k, sheet) in sheets.into_iter().enumerate() {
        let mut grid = Grid::new(size, cells, |x, y| f32::from_bits(slanted(x, y).to_bits() + sheet));
        // Rows run up here, so the grid's y is used as is.
        grid.vertices.iter_mut().for_each(|v| v[1] = -v[1]);
        // A sheet's triangles, in a different order for each sheet.
        let mut order: Vec<&[u32]> = grid.indices.chunks_exact(3).collect();
        random.shuffle(&mut order);
        grid.indices = order.concat();
        subject.draw_mesh(&grid.vertices, &grid.indices);
        grid.triangles().for_each(|t| oracle.draw(&t));
        alone.clear();
        alone.draw_mesh(&grid.vertices, &grid.indices);
        // All sheets have the same outline, so together they cover what a single one covers.
        measured.coverage(grid.triangles(), alone.depth(), &oracle);
        if k % 10 == 9 {
            measured.depths(subject.depth(), &oracle);
            // The part of this sheet that is visible is the part that is as near as everything drawn.
            let shows = grid.triangles().zip(grid.indices.chunks_exact(3)).filter(|(t, _)| oracle.shows(t));
            shows.step_by(50).for_each(|(_, t)| measured.shown(subject.test_mesh(&grid.vertices, t)));
        }
    }
    measured
}

/// Large triangles that slant by some units in the last place, each in front of a wall as near as its nearest pixel, or
/// one step of f32 farther: they are visible there by one ulp at most, and half a pixel of their plane is far less.
fn beside_a_wall() -> Measured {
    let size = (256, 128);
    let mut subject = Subject::new(size, YAxis::Down);
    let mut oracle = Oracle::new(size.0, size.1);
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(4);
    for k in 0..1200 {
        let lean = [1, 4, 20, 200][k % 4];
        let base = (1.0 + random.f32()).to_bits();
        let corners = [(); 3].map(|()| {
            let (x, y) = (random.i32(-40..=300) as f32 / 128.0 - 1.0, random.i32(-40..=170) as f32 / 64.0 - 1.0);
            let w = f32::from_bits(base + random.u32(0..=lean));
            [x * w, y * w, 0.0, w]
        });
        let t = corners.map(|v| snapped(v, size, false).expect("a vertex on the grid"));
        oracle.clear();
        oracle.draw(&t);
        let nearest = oracle.depth.iter().fold(-1.0, |m: f64, d| m.max(*d));
        if nearest < 0.0 {
            continue;
        }
        let mut w = (1.0 / nearest) as f32;
        while 1.0 / f64::from(w) > nearest {
            w = w.next_up();
        }
        subject.clear();
        subject.draw_clip(&wall(w));
        measured.triangles += 1;
        measured.depth(subject.depth()[0], 1.0 / f64::from(w));
        measured.shown(subject.test_clip(&corners));
    }
    measured
}

/// Half a pixel per triangle, all in one plane except for the rounding of w.
#[test]
fn a_million_coplanar_triangles() {
    ONE_PLANE.measured().assert_exact().assert_behind(0.005, 0.0);
}

/// The same plane a hundred times, each one unit in the last place of w behind another, unsorted.
#[test]
fn a_million_nearly_coplanar_triangles() {
    SHEETS.measured().assert_exact().assert_behind(0.02, 0.012);
}

/// A decal on a wall: which of the two is nearer depends on how each was rounded, and both must err on the safe side.
#[test]
fn queries_that_touch_a_wall() {
    let m = BESIDE.measured();
    m.assert_safe();
    assert!(m.asked > 900, "{m:?}");
}
