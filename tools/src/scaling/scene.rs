//! The three generated scenes. All are seen from the origin along -z, or from above it, with an aspect ratio of 16:9.

use std::f32::consts::{PI, TAU};

use fastrand::Rng;
use glam::camera::rh::{proj::directx::perspective_infinite_reverse, view::look_to_mat4};
use glam::{Mat4, Vec3, vec3};

use super::mesh::Mesh;

const NEAR: f32 = 0.1;
const ASPECT: f32 = 16.0 / 9.0;
/// Half the height of the view at distance 1.
const HALF_HEIGHT: f32 = 0.5;

/// Meshes in drawing order, one call each.
pub struct Scene {
    pub meshes: Vec<Mesh>,
    pub clip_from_world: Mat4,
    pub near: f32,
}

impl Scene {
    fn new(meshes: Vec<Mesh>, eye: Vec3, direction: Vec3) -> Self {
        let projection = perspective_infinite_reverse(2.0 * HALF_HEIGHT.atan(), ASPECT, NEAR);
        let clip_from_world = projection * look_to_mat4(eye, direction.normalize(), Vec3::Y);
        Self { meshes, clip_from_world, near: NEAR }
    }

    pub fn triangles(&self) -> usize {
        self.meshes.iter().map(Mesh::triangles).sum()
    }
}

/// Hills up to the horizon, seen from above, in one mesh of exactly this many triangles (an even number), nearest
/// first. The sheet widens with the view, so that few triangles are off screen however many there are.
pub fn terrain(triangles: u32) -> Scene {
    let (columns, rows) = grid(triangles / 2);
    let mesh = Mesh::sheet(columns, rows, |across, up| {
        let distance = 20.0 + 460.0 * up;
        let x = (across - 0.5) * 2.2 * ASPECT * HALF_HEIGHT * (distance + 40.0);
        let height = 7.0 * (x / 19.0).sin() * (distance / 23.0).cos() + 1.5 * (x / 5.0 + distance / 7.0).sin();
        vec3(x, height, -distance)
    });
    Scene::new(vec![mesh], vec3(0.0, 60.0, 0.0), vec3(0.0, -0.6, -0.8))
}

/// Columns and rows of a sheet of this many quads, as close to square as possible.
fn grid(quads: u32) -> (u32, u32) {
    let rows = (1..=quads.isqrt()).rev().find(|rows| quads.is_multiple_of(*rows)).unwrap_or(1);
    (quads / rows, rows)
}

/// 500 lumps of 200 triangles each, anywhere in view, nearest first.
pub fn lumps() -> Scene {
    let mut rng = Rng::with_seed(5);
    let mut distances: Vec<f32> = (0..500).map(|_| 20.0 + 180.0 * rng.f32()).collect();
    distances.sort_by(f32::total_cmp);
    let mut within = |limit: f32| (2.0 * rng.f32() - 1.0) * limit;
    let lump = |distance: f32| {
        let half = HALF_HEIGHT * distance;
        let centre = vec3(within(half * ASPECT), within(half), -distance);
        let (radius, phase) = (3.5 + within(2.0), within(PI));
        Mesh::sheet(10, 10, |around, up| {
            let (sin, cos) = (TAU * around).sin_cos();
            // With a tiny opening at the poles: no triangle has two corners at one point.
            let (height, reach) = ((up - 0.5) * 0.98 * PI).sin_cos();
            // The first and the last column meet, because there are three whole periods of bumps around.
            let bump = 1.0 + 0.15 * (3.0 * TAU * around + phase).sin() * reach;
            centre + vec3(sin * reach, height, cos * reach) * radius * bump
        })
    };
    Scene::new(distances.into_iter().map(lump).collect(), Vec3::ZERO, Vec3::NEG_Z)
}

/// Bumpy sheets of 2,000 triangles, each of which fills the screen, one behind another; drawn nearest first or farthest
/// first.
pub fn sheets(count: u32, nearest_first: bool) -> Scene {
    let sheet = |i: u32| {
        let distance = 20.0 + 4.0 * i as f32;
        let phase = i as f32;
        Mesh::sheet(40, 25, |across, up| {
            // Half as large again as the view at the distance of the nearest bump, so that no edge is visible.
            let half = 1.2 * HALF_HEIGHT * distance;
            let bump = 1.5 * (11.0 * across + phase).sin() * (9.0 * up + 2.0 * phase).cos();
            vec3((2.0 * across - 1.0) * half * ASPECT, (2.0 * up - 1.0) * half, bump - distance)
        })
    };
    let mut meshes: Vec<Mesh> = (0..count).map(sheet).collect();
    if !nearest_first {
        meshes.reverse();
    }
    Scene::new(meshes, Vec3::ZERO, Vec3::NEG_Z)
}

/// Right-angled isosceles triangles with legs of this many pixels on a screen `height` high, at random positions and
/// rotations, farthest first, so that none is hidden when it is drawn. After section 4.3 of the HPG 2016 paper.
pub fn right_triangles(leg: f32, count: u32, height: u32) -> Scene {
    let mut rng = Rng::with_seed(7);
    let triangle = |i: u32| {
        let distance = 20.0 + 180.0 * (1.0 - i as f32 / count as f32);
        // The size of a pixel at that distance.
        let pixel = 2.0 * HALF_HEIGHT * distance / height as f32;
        let half = HALF_HEIGHT * distance;
        let middle = vec3((2.0 * rng.f32() - 1.0) * half * ASPECT, (2.0 * rng.f32() - 1.0) * half, -distance);
        let (sin, cos) = (TAU * rng.f32()).sin_cos();
        let (u, v) = (vec3(cos, sin, 0.0) * leg * pixel, vec3(-sin, cos, 0.0) * leg * pixel);
        let corner = middle - (u + v) / 3.0;
        [corner, corner + u, corner + v]
    };
    let triangles: Vec<[Vec3; 3]> = (0..count).map(triangle).collect();
    Scene::new(vec![Mesh::soup(&triangles)], Vec3::ZERO, Vec3::NEG_Z)
}

#[cfg(test)]
mod tests {
    use super::super::culler::{Culler, PROBES, frame, hidden};
    use super::super::job::TERRAINS;
    use super::super::ours::Ours;
    use super::*;
    use demo::options::Rule;

    #[test]
    fn scenes_have_the_wanted_triangles() {
        for &triangles in TERRAINS.iter().filter(|n| **n <= 300_000) {
            assert_eq!(terrain(triangles).triangles(), triangles as usize);
        }
        for &triangles in &TERRAINS {
            let (columns, rows) = grid(triangles / 2);
            assert_eq!(2 * columns * rows, triangles);
            assert!(columns <= 2 * rows, "{triangles}: {columns} by {rows}");
        }
        assert_eq!(lumps().triangles(), 100_000);
        assert_eq!(sheets(8, true).triangles(), 16_000);
        assert_eq!(right_triangles(10.0, 500, 1080).triangles(), 500);
    }

    /// Checks that the measured scenes are really drawn: how much of the screen each one hides.
    #[test]
    fn scenes_face_the_camera_and_fill_the_screen() {
        let mut ours = Ours::new(Rule::ThreeLayer, 3).unwrap();
        ours.set_size(640, 360).unwrap();
        let mut share = |scene: Scene| {
            ours.set_near(scene.near);
            frame(&mut ours, &scene);
            hidden(&ours) as f32 / PROBES as f32
        };
        assert_eq!(share(sheets(1, true)), 1.0);
        assert_eq!(share(sheets(3, false)), 1.0);
        assert_eq!(share(terrain(3_000)), 1.0);
        assert!(share(right_triangles(200.0, 500, 360)) > 0.9);
        let lumps = share(lumps());
        assert!((0.5..1.0).contains(&lumps), "{lumps}");
    }
}
