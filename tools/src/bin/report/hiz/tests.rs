//! Comparison with a plain z-buffer in doubles that neither clips nor projects: for each pixel it solves for the
//! visible point of the triangle's plane.

use fastrand::Rng;
use glam::{DMat3, DVec3, Mat4, Vec4};
use masked_occlusion_culling::{BackfaceWinding, Implementation};

use super::Hiz;

const LEVELS: [Implementation; 3] = [Implementation::Scalar, Implementation::Avx2, Implementation::Avx512];

/// How far a vertex may have moved through snapping and float rounding, in pixels.
const SHIFT: f64 = 0.01;

/// The minimum and maximum allowed depth of each pixel.
struct Plain {
    size: [u32; 2],
    near: f64,
    bounds: Vec<[f64; 2]>,
}

impl Plain {
    fn new(size: [u32; 2], near: f32) -> Self {
        Self { size, near: f64::from(near), bounds: vec![[0.0; 2]; (size[0] * size[1]) as usize] }
    }

    /// Draws a triangle, both sides of it.
    fn draw(&mut self, corners: [[f32; 4]; 3]) {
        let [a, b, c] = corners.map(|[x, y, _, w]| DVec3::new(x.into(), y.into(), w.into()));
        let inverse = DMat3::from_cols(a, b, c).inverse();
        if !inverse.is_finite() {
            return;
        }
        let size = self.size.map(f64::from);
        // Weights over w are linear on the screen, and their sum is 1/w.
        let rows = [inverse.row(0), inverse.row(1), inverse.row(2)];
        let per_shift = |row: DVec3| SHIFT * (row.x.abs() * 2.0 / size[0] + row.y.abs() * 2.0 / size[1]);
        let plane = rows[0] + rows[1] + rows[2];
        for (i, [least, most]) in self.bounds.iter_mut().enumerate() {
            let (x, y) = (i as u32 % self.size[0], i as u32 / self.size[0]);
            let ndc = |v: u32, size: f64| (f64::from(v) + 0.5) / size * 2.0 - 1.0;
            let at = DVec3::new(ndc(x, size[0]), -ndc(y, size[1]), 1.0);
            let depth = plane.dot(at);
            let slack = per_shift(plane) + 1e-4 * depth.abs();
            if rows.iter().all(|row| row.dot(at) >= per_shift(*row)) && depth + slack < 1.0 / self.near {
                *least = least.max(depth - slack);
            }
            if rows.iter().all(|row| row.dot(at) >= -per_shift(*row)) && depth - slack <= 1.0 / self.near {
                *most = most.max(depth + slack);
            }
        }
    }

    fn compare(&self, hiz: &Hiz) {
        for (i, &[least, most]) in self.bounds.iter().enumerate() {
            let (x, y) = (i as u32 % self.size[0], i as u32 / self.size[0]);
            let depth = f64::from(hiz.depth(x, y));
            assert!(least <= depth && depth <= most, "{:?} ({x}, {y}): {least} <= {depth} <= {most}", hiz.level());
        }
    }
}

fn draw(hiz: &mut Hiz, vertices: &[[f32; 4]]) {
    let indices: Vec<u32> = (0..vertices.len() as u32).collect();
    hiz.set_clip_space(vertices);
    hiz.project(&indices);
    hiz.raster();
}

/// Triangles with corners up to `size` (in NDC) from a random point, near and far; some reach behind the eye or far off
/// screen.
fn triangles(random: &mut Rng, n: usize, size: f32) -> Vec<[f32; 4]> {
    let mut vertices = Vec::new();
    for _ in 0..n {
        let [x, y] = [0, 1].map(|_| random.f32() * 2.4 - 1.2);
        let wild = random.u32(0..8) == 0;
        for _ in 0..3 {
            let reach = if wild { 30.0 } else { size };
            let w = if wild { random.f32() * 6.0 - 2.0 } else { 1.0 + random.f32() * 20.0 };
            let [x, y] = [x, y].map(|v| (v + (random.f32() * 2.0 - 1.0) * reach) * w.abs());
            vertices.push([x, y, f32::NAN, w]);
        }
    }
    vertices
}

#[test]
fn depths_are_those_of_a_plain_z_buffer() {
    let mut random = Rng::with_seed(1);
    for (size, reach) in [([61, 37], 0.3), ([128, 72], 0.05), ([200, 120], 1.0), ([200, 40], 2.0), ([1, 1], 1.0)] {
        for n in [1, 3, 17, 60] {
            let vertices = triangles(&mut random, n, reach);
            let mut plain = Plain::new(size, 0.25);
            vertices.chunks_exact(3).for_each(|t| plain.draw([t[0], t[1], t[2]]));
            for level in LEVELS {
                let mut hiz = Hiz::with_level(size[0], size[1], level);
                hiz.winding = BackfaceWinding::None;
                hiz.set_near(0.25);
                draw(&mut hiz, &vertices);
                plain.compare(&hiz);
            }
        }
    }
}

#[test]
fn a_matrix_takes_positions_to_clip_space_and_faces_are_culled() {
    let mut random = Rng::with_seed(2);
    let matrix = Mat4::from_cols(
        Vec4::new(0.9, 0.1, 0.0, 0.0),
        Vec4::new(-0.2, 1.6, 0.0, 0.1),
        Vec4::new(0.0, 0.3, 0.0, -1.0),
        Vec4::new(0.3, 0.2, 0.1, 0.5),
    );
    let positions: Vec<[f32; 4]> = (0..90)
        .map(|_| [random.f32() * 4.0 - 2.0, random.f32() * 4.0 - 2.0, -1.0 - random.f32() * 5.0, f32::NAN])
        .collect();
    let clip: Vec<[f32; 4]> =
        positions.iter().map(|p| (matrix * Vec4::new(p[0], p[1], p[2], 1.0)).to_array()).collect();
    let indices: Vec<u32> = (0..120).map(|_| random.u32(0..90)).collect();
    for winding in [BackfaceWinding::None, BackfaceWinding::Clockwise, BackfaceWinding::CounterClockwise] {
        let mut plain = Plain::new([100, 80], 0.01);
        for t in indices.chunks_exact(3) {
            let t = [0, 1, 2].map(|k| clip[t[k] as usize]);
            let [a, b, c] = t.map(|v| DVec3::new(v[0].into(), v[1].into(), v[3].into()));
            // In front of the eye the determinant has the sign of the area, counter-clockwise with y up.
            let counter_clockwise = DMat3::from_cols(a, b, c).determinant() > 0.0;
            match winding {
                BackfaceWinding::Clockwise if !counter_clockwise => {}
                BackfaceWinding::CounterClockwise if counter_clockwise => {}
                _ => plain.draw(t),
            }
        }
        for level in LEVELS {
            let mut hiz = Hiz::with_level(100, 80, level);
            hiz.winding = winding;
            hiz.set_near(0.01);
            hiz.transform(&positions, &matrix);
            for part in indices.chunks(63) {
                hiz.project(part);
            }
            hiz.raster();
            plain.compare(&hiz);
        }
    }
}

/// A jittered grid of squares, each split in two triangles, that covers more than the screen.
fn sheet(random: &mut Rng, n: u32, reach: f32) -> (Vec<[f32; 4]>, Vec<u32>) {
    let mut vertices = Vec::new();
    for i in 0..(n + 1) * (n + 1) {
        let [x, y] = [i % (n + 1), i / (n + 1)]
            .map(|v| ((v as f32 + (random.f32() - 0.5) * 0.8) / n as f32 * 2.0 - 1.0) * reach);
        let w = 1.0 + random.f32();
        vertices.push([x * w, y * w, 0.0, w]);
    }
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let square = |x, y| [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y), at(x + 1, y + 1), at(x, y + 1)];
    (vertices, (0..n * n).flat_map(|i| square(i % n, i / n)).collect())
}

#[test]
fn meshes_have_no_cracks() {
    let mut random = Rng::with_seed(3);
    // The last ones extend beyond the guard band, and are clipped there.
    for (n, reach) in [(3, 4.0), (12, 1.3), (60, 1.2), (4, 60.0), (5, 90.0)] {
        for level in LEVELS {
            let (vertices, indices) = sheet(&mut random, n, reach);
            let mut hiz = Hiz::with_level(150, 130, level);
            hiz.winding = BackfaceWinding::None;
            hiz.set_clip_space(&vertices);
            hiz.project(&indices);
            hiz.raster();
            let holes = (0..150 * 130).filter(|i| hiz.depth(i % 150, i / 150) == 0.0).count();
            assert_eq!(holes, 0, "{level:?}, {n} squares to {reach}");
        }
    }
}

#[test]
fn tiles_hold_the_farthest_depth_and_hide_what_is_behind() {
    let mut random = Rng::with_seed(4);
    for size in [[61, 37], [160, 96], [9, 300]] {
        for level in LEVELS {
            let mut hiz = Hiz::with_level(size[0], size[1], level);
            hiz.winding = BackfaceWinding::None;
            hiz.set_near(0.1);
            let (vertices, indices) = sheet(&mut random, 3, 3.0);
            hiz.set_clip_space(&vertices);
            hiz.project(&indices[..indices.len() - 15]);
            hiz.raster();
            draw(&mut hiz, &triangles(&mut random, 40, 0.5));
            hiz.generate();

            let (columns, rows) = hiz.farthest();
            for (y, row) in rows.enumerate() {
                assert_eq!(row.len(), columns);
                for (x, &farthest) in row.iter().enumerate() {
                    let pixels = (0..64).map(|i| [x as u32 * 8 + i % 8, y as u32 * 8 + i / 8]);
                    let on_screen = pixels.filter(|p| p[0] < size[0] && p[1] < size[1]);
                    let least = on_screen.fold(f32::MAX, |least, [x, y]| least.min(hiz.depth(x, y)));
                    assert_eq!(farthest, least, "{level:?} ({x}, {y})");
                }
            }

            let mut hidden = 0;
            for _ in 0..3000 {
                let pair = |random: &mut Rng| {
                    let (a, reach) = (random.f32() * 2.2 - 1.1, 0.6 * random.f32());
                    (a, a + reach * random.f32())
                };
                let ((x0, x1), (y0, y1)) = (pair(&mut random), pair(&mut random));
                let w = 0.2 + random.f32() * 12.0;
                if !hiz.test_rect(x0, y0, x1, y1, w) {
                    continue;
                }
                // No pixel that it overlaps is as far away.
                for i in 0..size[0] * size[1] {
                    let (x, y) = (i % size[0], i / size[0]);
                    let edge = |v: u32, size: u32| v as f32 / size as f32 * 2.0 - 1.0;
                    let across = edge(x, size[0]) < x1 - 1e-6 && edge(x + 1, size[0]) > x0 + 1e-6;
                    let down = -edge(y, size[1]) > y0 + 1e-6 && -edge(y + 1, size[1]) < y1 - 1e-6;
                    if across && down {
                        hidden += 1;
                        assert!(hiz.depth(x, y) > 1.0 / w, "{level:?} ({x}, {y})");
                    }
                }
            }
            assert!(hidden > 1000, "{level:?}: {hidden} pixels compared");
        }
    }
}

#[test]
fn a_wall_hides_what_is_behind_it_and_a_cleared_buffer_nothing() {
    for level in LEVELS {
        let mut hiz = Hiz::with_level(333, 77, level);
        let wall = [[-5.0, -5.0, 0.0, 5.0], [15.0, -5.0, 0.0, 5.0], [-5.0, 15.0, 0.0, 5.0]];
        draw(&mut hiz, &wall);
        hiz.generate();
        assert!(hiz.test_rect(-1.0, -1.0, 1.0, 1.0, 5.01));
        assert!(hiz.test_rect(0.9, -1.5, 1.5, -0.9, 5.01));
        assert!(!hiz.test_rect(-1.0, -1.0, 1.0, 1.0, 4.99));
        assert!(!hiz.test_rect(-1.0, -1.0, 1.0, 1.0, f32::NAN));
        assert!(!hiz.test_rect(f32::NAN, -1.0, 1.0, 1.0, 9.0));
        assert!(!hiz.test_rect(-1.0, -1.0, 1.0, 1.0, -1.0));
        hiz.clear();
        hiz.generate();
        assert!(!hiz.test_rect(0.1, 0.1, 0.2, 0.2, 1e30));
        // Nothing is drawn of its back face.
        draw(&mut hiz, &[wall[0], wall[2], wall[1]]);
        assert_eq!(hiz.waiting(), 0);
        assert!((0..333 * 77).all(|i| hiz.depth(i % 333, i / 333) == 0.0));
    }
}

#[test]
fn nothing_that_is_not_finite_or_not_in_front_is_drawn() {
    for level in LEVELS {
        let mut hiz = Hiz::with_level(64, 64, level);
        hiz.winding = BackfaceWinding::None;
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -5.0, 0.0] {
            draw(&mut hiz, &[[-1.0, -1.0, 0.0, bad], [3.0, -1.0, 0.0, bad], [-1.0, 3.0, 0.0, bad]]);
            draw(&mut hiz, &[[bad, -1.0, 0.0, f32::NAN], [3.0, -1.0, 0.0, 1.0], [-1.0, 3.0, 0.0, 1.0]]);
        }
        for i in 0..64 * 64 {
            let depth = hiz.depth(i % 64, i / 64);
            assert!(depth == 0.0, "{level:?}: {depth}");
        }
    }
}
