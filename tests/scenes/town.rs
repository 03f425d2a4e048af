//! The scenes that resemble real ones: a town of boxes, a terrain, a world of blocks.

use super::{Numbers, Scene, look, mixed};

const ASPECT: f32 = 16.0 / 9.0;

/// Streets of houses on a plain, seen from the street.
pub fn town() -> Scene {
    let mut scene = Scene::new("town", 0.1, Some(look([-3.0, 1.7, -4.0], [60.0, 6.0, 71.0], 1.6, ASPECT)));
    let mut n = Numbers(11);
    scene.add_box([-100.0, -1.0, -100.0], [400.0, 0.0, 400.0]);
    for i in 0..12 {
        for j in 0..12 {
            let (x, z) = (i as f32 * 24.0, j as f32 * 24.0);
            let height = n.within(5.0, 25.0);
            scene.add_box([x, 0.0, z], [x + n.within(9.0, 16.0), height, z + n.within(9.0, 16.0)]);
            for _ in 0..3 {
                let (a, b, s) = (x + n.within(-6.0, 20.0), z + n.within(-6.0, 20.0), n.within(0.3, 2.0));
                scene.add_box([a, 0.0, b], [a + s, s, b + s]);
            }
        }
    }
    scene
}

/// A height between 0 and 1 at the corners of a grid, smooth between them.
fn noise(x: f32, z: f32) -> f32 {
    let (i, j) = (x.floor(), z.floor());
    let corner = |di: f32, dj: f32| {
        let key = ((i + di) as i64 as u64).wrapping_mul(0x1_0000_01b3) ^ ((j + dj) as i64 as u64);
        (mixed(key) >> 40) as f32 / (1u64 << 24) as f32
    };
    let smooth = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (smooth(x - i), smooth(z - j));
    let near = corner(0.0, 0.0) * (1.0 - u) + corner(1.0, 0.0) * u;
    let far = corner(0.0, 1.0) * (1.0 - u) + corner(1.0, 1.0) * u;
    near * (1.0 - v) + far * v
}

/// A hilly height field in patches.
pub fn terrain() -> Scene {
    const PATCH: u32 = 16;
    let height = |x: f32, z: f32| 30.0 * noise(x * 0.02, z * 0.02) + 8.0 * noise(x * 0.09, z * 0.09);
    let eye = [20.0, height(20.0, 30.0) + 3.0, 30.0];
    let mut scene = Scene::new("terrain", 0.2, Some(look(eye, [150.0, 10.0, 140.0], 1.8, ASPECT)));
    for pi in 0..5 {
        for pj in 0..5 {
            let base = scene.vertices.len() as u32;
            for i in 0..=PATCH {
                for j in 0..=PATCH {
                    let (x, z) = ((pi * PATCH + i) as f32 * 3.0, (pj * PATCH + j) as f32 * 3.0);
                    scene.vertices.push([x, height(x, z), z, 1.0]);
                }
            }
            let mut object = Vec::new();
            for i in 0..PATCH {
                for j in 0..PATCH {
                    let a = base + i * (PATCH + 1) + j;
                    let (b, c, d) = (a + 1, a + PATCH + 2, a + PATCH + 1);
                    object.extend([a, b, c, a, c, d]);
                }
            }
            scene.objects.push(object);
        }
    }
    scene
}

/// Columns of unit cubes, visible faces only, in chunks of 8 by 8 columns.
pub fn blocks() -> Scene {
    const SIDE: i32 = 48;
    let level = |x: i32, z: i32| {
        let inside = (0..SIDE).contains(&x) && (0..SIDE).contains(&z);
        if inside { 4 + (14.0 * noise(x as f32 * 0.11, z as f32 * 0.11)) as i32 } else { 0 }
    };
    let eye = [5.5, level(5, 5) as f32 + 2.6, 5.5];
    let mut scene = Scene::new("blocks", 0.1, Some(look(eye, [40.0, 6.0, 36.0], 1.4, ASPECT)));
    for chunk in 0..(SIDE / 8) * (SIDE / 8) {
        let mut object = Vec::new();
        for cell in 0..64 {
            let (x, z) = (chunk % (SIDE / 8) * 8 + cell % 8, chunk / (SIDE / 8) * 8 + cell / 8);
            let mut quad = |corners: [[i32; 3]; 4]| {
                let base = scene.vertices.len() as u32;
                scene.vertices.extend(corners.map(|[x, y, z]| [x as f32, y as f32, z as f32, 1.0]));
                object.extend([0, 1, 2, 0, 2, 3].map(|i| base + i));
            };
            let top = level(x, z);
            quad([[x, top, z], [x, top, z + 1], [x + 1, top, z + 1], [x + 1, top, z]]);
            for y in 0..top {
                if y >= level(x - 1, z) {
                    quad([[x, y, z], [x, y, z + 1], [x, y + 1, z + 1], [x, y + 1, z]]);
                }
                if y >= level(x + 1, z) {
                    quad([[x + 1, y, z], [x + 1, y + 1, z], [x + 1, y + 1, z + 1], [x + 1, y, z + 1]]);
                }
                if y >= level(x, z - 1) {
                    quad([[x, y, z], [x, y + 1, z], [x + 1, y + 1, z], [x + 1, y, z]]);
                }
                if y >= level(x, z + 1) {
                    quad([[x, y, z + 1], [x + 1, y, z + 1], [x + 1, y + 1, z + 1], [x, y + 1, z + 1]]);
                }
            }
        }
        scene.objects.push(object);
    }
    scene
}
