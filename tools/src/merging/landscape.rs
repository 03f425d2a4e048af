//! The generated scene: hills up to the horizon, towers in front of them, small boxes everywhere.

use fastrand::Rng;
use glam::camera::rh::{proj::directx::perspective_infinite_reverse, view::look_to_mat4};
use glam::{Mat4, Vec3, vec3};

use crate::rectangle::rectangle;
use demo::camera::box_corners;
use demo::scene::{Mesh, Object, Scene};

pub const NEAR: f32 = 0.1;
/// Half the height of the view at distance 1.
const HALF_HEIGHT: f32 = 0.5;
/// Number of terrain pieces in each direction, and of quads per piece in each direction.
const PIECES: u32 = 8;
const QUADS: u32 = 16;
/// The terrain begins this far behind the eye...
const BEHIND: f32 = 20.0;
/// ... extends this far to both sides, in metres, and has this length and width.
const LENGTH: f32 = 640.0;
const TOWERS: u32 = 500;

/// Objects are in drawing order: nearest first.
pub struct Landscape {
    pub terrain: Vec<Object>,
    pub foreground: Vec<Object>,
    /// For each object of both, in the order of their nearest points: whether it is terrain, and its index.
    pub interleaved: Vec<(bool, usize)>,
    /// The rectangles of the boxes in normalised device coordinates, and their minimum w.
    pub boxes: Vec<[f32; 5]>,
    pub clip_from_world: Mat4,
}

/// The height of the ground.
fn ground(x: f32, z: f32) -> f32 {
    let hills = 16.0 * (x / 47.0 + 0.6).sin() * (z / 61.0 + 0.4).cos() + 7.0 * (x / 19.0 + z / 33.0).sin();
    hills + 1.2 * (x / 4.1).sin() * (z / 5.3).cos() + 0.4 * (x / 1.7 + z / 2.3).sin()
}

impl Landscape {
    /// The landscape in a view that is `aspect` times as wide as high.
    pub fn generate(aspect: f32, boxes: u32) -> Self {
        let eye = vec3(0.0, ground(0.0, 0.0) + 9.0, 0.0);
        let clip_from_world = perspective_infinite_reverse(2.0 * HALF_HEIGHT.atan(), aspect, NEAR)
            * look_to_mat4(eye, vec3(0.0, -0.06, -1.0).normalize(), Vec3::Y);
        let mut terrain = Scene::default();
        for piece in 0..PIECES * PIECES {
            terrain.add(sheet(piece % PIECES, piece / PIECES), true, false);
        }

        let mut rng = Rng::with_seed(18);
        let mut between = |low: f32, high: f32| low + (high - low) * rng.f32();
        let mut standing = |distance: [f32; 2], width: [f32; 2], height: [f32; 2]| {
            let z = -between(distance[0], distance[1]);
            let x = between(-1.0, 1.0) * -z * HALF_HEIGHT * aspect;
            let half = vec3(between(width[0], width[1]), 0.0, between(width[0], width[1])) / 2.0;
            let foot = vec3(x, ground(x, z), z);
            (foot - half - Vec3::Y, foot + half + Vec3::Y * between(height[0], height[1]))
        };
        let mut foreground = Scene::default();
        for tower in 0..TOWERS {
            let (low, high) = standing([20.0, 220.0], [1.0, 7.0], [2.0, 14.0]);
            let mut mesh = Mesh::default();
            if tower % 2 == 0 {
                mesh.cuboid(low, high, Vec3::ONE);
            } else {
                let (middle, size) = ((low + high) / 2.0, high - low);
                let radius = size.x.min(size.z) / 2.0;
                mesh.cone(middle.with_y(low.y), size.y, radius, 0.8 * radius, 24, Vec3::ONE);
            }
            foreground.add(mesh, true, false);
        }
        let boxes = (0..boxes).filter_map(|_| {
            let (low, high) = standing([25.0, 600.0], [0.5, 4.0], [0.5, 4.0]);
            rectangle(low, high, &clip_from_world, NEAR).filter(is_on_screen)
        });

        let mut landscape = Self {
            boxes: boxes.collect(),
            terrain: terrain.objects,
            foreground: foreground.objects,
            interleaved: Vec::new(),
            clip_from_world,
        };
        let nearest = |o: &Object| box_corners(o.lo, o.hi).map(|p| (clip_from_world * p.extend(1.0)).w);
        let nearest = |o: &Object| nearest(o).into_iter().fold(f32::INFINITY, f32::min);
        let mut order = Vec::new();
        for (is_terrain, objects) in [(true, &mut landscape.terrain), (false, &mut landscape.foreground)] {
            objects.sort_by(|a, b| nearest(a).total_cmp(&nearest(b)));
            order.extend(objects.iter().enumerate().map(|(i, o)| (nearest(o), (is_terrain, i))));
        }
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        landscape.interleaved = order.into_iter().map(|o| o.1).collect();
        landscape
    }

    pub fn summary(&self) -> String {
        let triangles = |objects: &[Object]| objects.iter().map(|o| o.mesh.triangles.len()).sum::<usize>();
        format!(
            "terrain: {} pieces of {} triangles in all; foreground: {} towers of {} in all; {} boxes on the screen\n",
            self.terrain.len(),
            triangles(&self.terrain),
            self.foreground.len(),
            triangles(&self.foreground),
            self.boxes.len(),
        )
    }
}

/// A piece of the ground; its quads come row by row, the nearest row first.
fn sheet(column: u32, row: u32) -> Mesh {
    let step = LENGTH / (PIECES * QUADS) as f32;
    let mut mesh = Mesh::default();
    for j in 0..=QUADS {
        for i in 0..=QUADS {
            let x = (column * QUADS + i) as f32 * step - LENGTH / 2.0;
            let z = BEHIND - (row * QUADS + j) as f32 * step;
            mesh.positions.push(vec3(x, ground(x, z), z));
        }
    }
    for j in 0..QUADS {
        for i in 0..QUADS {
            let near = j * (QUADS + 1) + i;
            let far = near + QUADS + 1;
            mesh.triangles.extend([[near, near + 1, far + 1], [near, far + 1, far]]);
        }
    }
    mesh
}

fn is_on_screen(&[x_min, y_min, x_max, y_max, _]: &[f32; 5]) -> bool {
    x_min >= -1.0 && y_min >= -1.0 && x_max <= 1.0 && y_max <= 1.0
}
