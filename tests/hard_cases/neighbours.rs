//! Meshes in which some triangles are clipped and their neighbours are not. A clipped edge has a new corner; if its two
//! sides got different ones, the background would show through the crack.
//!
//! The mesh is a crumpled sphere around the eye: every ray meets it once, so without a near plane every pixel of the
//! screen must be covered by exactly one triangle, although most triangles cross the eye's plane or leave the guard
//! band.

use masked_occlusion_culling::YAxis;

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::homogeneous::Homogeneous;

pub const CASES: &[&Case] = &[&AROUND, &CUT];

static AROUND: Case = Case::new("mesh around the eye, clipped beside unclipped", || spheres(&[0.0, 1e-3, 0.02]));
static CUT: Case = Case::new("mesh around the eye, near plane through it", || spheres(&[0.5, 0.9, 1.3]));

const SIZE: (usize, usize) = (64, 32);
/// Cells along a cube's edge.
const CELLS: i32 = 8;
/// Pixels within this distance of the near plane's trace, in pixels, may be covered or not; elsewhere coverage is
/// certain.
const BORDER: f64 = 1.0 / 64.0;

/// Triangles of clip-space vertices (x, y, w), of a sphere around the eye with radii from 1 to 2.
fn sphere(random: &mut fastrand::Rng, stretch: f32) -> Vec<[[f32; 3]; 3]> {
    let mut radii = std::collections::BTreeMap::new();
    let mut vertex = |p: [i32; 3]| {
        let radius = *radii.entry(p).or_insert_with(|| 1.0 + random.f32());
        let [x, y, z] = p.map(|c| c as f32 / CELLS as f32);
        let length = (x * x + y * y + z * z).sqrt();
        let [x, y, z] = [x, y, z].map(|c| c / length * radius);
        // Turned by rational sines and cosines (3, 4, 5 and 5, 12, 13), so that no face looks along an axis.
        let (x, z) = (0.6 * x - 0.8 * z, 0.8 * x + 0.6 * z);
        let (y, z) = ((12.0 * y - 5.0 * z) / 13.0, (5.0 * y + 12.0 * z) / 13.0);
        // The wider the view, the more of the mesh is behind the guard band's planes only.
        [x / stretch, y * 2.0 / stretch, z]
    };
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [-CELLS, CELLS] {
            for i in (-CELLS..CELLS).step_by(2) {
                for j in (-CELLS..CELLS).step_by(2) {
                    let mut at = |i: i32, j: i32| {
                        let mut p = [side; 3];
                        (p[(axis + 1) % 3], p[(axis + 2) % 3]) = (i, j);
                        vertex(p)
                    };
                    let [a, b, c, d] = [at(i, j), at(i + 2, j), at(i + 2, j + 2), at(i, j + 2)];
                    triangles.extend([[a, b, c], [a, c, d]]);
                }
            }
        }
    }
    triangles
}

fn spheres(nears: &[f32]) -> Measured {
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(11);
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let tight = nears[0] == 0.0;
    for &near in nears {
        // From a wide view to a telephoto view, in which every triangle is larger than the guard band.
        for stretch in [4.0, 1.0, 0.05, 1e-4] {
            subject.set_near(near);
            let triangles = sphere(&mut random, stretch);
            let mut times = vec![0u8; SIZE.0 * SIZE.1];
            let mut certain = vec![false; SIZE.0 * SIZE.1];
            for v in &triangles {
                let t = v.map(|[x, y, w]| [x, y, 0.0, w]);
                let Some(exact) = Homogeneous::new(&v.map(|c| c.map(f64::from)), f64::from(near), SIZE, false) else {
                    continue;
                };
                subject.clear();
                subject.draw_clip(&t);
                let depth = subject.depth();
                let farthest = v.iter().fold(0.0_f32, |m, c| m.max(c[2]));
                measured.clipped(&exact, 1.0 / f64::from(farthest), depth, SIZE.0);
                times.iter_mut().zip(depth).for_each(|(n, d)| *n += u8::from(*d >= 0.0));
                for (i, certain) in certain.iter_mut().enumerate() {
                    let (column, row) = (i % SIZE.0, i / SIZE.0);
                    *certain |=
                        exact.beyond_near_by(column, row) > BORDER && exact.within_edges_by(column, row) > -BORDER;
                }
            }
            // Exactly once, however it was clipped.
            for (n, certain) in times.iter().zip(&certain) {
                let right = if *certain { *n == 1 } else { *n <= 1 };
                measured.cracks += u64::from(!right);
            }
            if tight {
                assert!(certain.iter().all(|c| *c), "the mesh has a hole");
            }
            // All of it in one call, then queried.
            subject.clear();
            let all: Vec<_> = triangles.iter().flatten().map(|&[x, y, w]| [x, y, 0.0, w]).collect();
            subject.draw_clip(&all);
            measured.shown(subject.test_clip(&all));
        }
    }
    measured
}

/// Edges that cross the eye's plane or the guard band, with one side clipped or both.
#[test]
fn neighbours_clipped_and_unclipped_leave_no_crack() {
    AROUND.measured().assert_clipped().assert_behind(0.04, 1e-4);
}

/// The near plane removes part of the mesh, and the rest has no cracks.
#[test]
fn the_near_plane_through_a_mesh_leaves_no_crack() {
    CUT.measured().assert_clipped().assert_behind(0.002, 0.0);
}
