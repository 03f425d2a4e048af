//! Choosing a camera for a scene.

use glam::camera::rh::{proj::directx::perspective_infinite_reverse, view::look_to_mat4};
use glam::{Mat4, Vec3};

use crate::raster::{NOTHING, ZBuffer};
use crate::scene::Scene;

/// A perspective camera without a far plane.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    pub eye: Vec3,
    pub look: Vec3,
    pub up: Vec3,
    /// Vertical, in radians.
    pub fov: f32,
    pub near: f32,
    /// Width over height of the screen.
    pub aspect: f32,
}

impl Camera {
    /// Whether up differs from the view direction. False also if the two points are too far apart for a float.
    pub fn is_upright(&self) -> bool {
        (self.look - self.eye).normalize_or_zero().cross(self.up).length() >= 1e-3
    }

    /// World to clip space: w is the distance along the view direction, z is the near distance.
    pub fn clip_from_world(&self) -> Mat4 {
        let direction = (self.look - self.eye).normalize();
        perspective_infinite_reverse(self.fov, self.aspect, self.near) * look_to_mat4(self.eye, direction, self.up)
    }

    /// Any direction perpendicular to up.
    pub fn sideways(&self) -> Vec3 {
        self.up.any_orthonormal_vector()
    }

    /// Tries camera positions inside the scene and in front of it, and returns the best.
    pub fn choose(&mut self, scene: &Scene, look: Option<Vec3>) {
        if let Some(best) = self.ranked(scene, look).first() {
            (self.eye, self.look) = *best;
            return;
        }
        let (lo, hi) = scene.bounds();
        let local = self.sideways() * -1.1 + self.up * 0.4 + self.up.cross(self.sideways()) * 1.1;
        (self.eye, self.look) = ((lo + hi) / 2.0 + local * (hi - lo), (lo + hi) / 2.0);
    }

    /// Eye positions inside the scene and in front of it, each with its target, best first; positions from which
    /// nothing is visible are omitted.
    pub fn ranked(&self, scene: &Scene, look: Option<Vec3>) -> Vec<(Vec3, Vec3)> {
        let (lo, hi) = scene.bounds();
        let size = hi - lo;
        let (right, ahead) = (self.sideways(), self.up.cross(self.sideways()));
        // Coordinates along the scene's own right, up and ahead, from 0 to 1.
        let at = |x: f32, y: f32, z: f32| {
            let local = right * (x - 0.5) + self.up * (y - 0.5) + ahead * (z - 0.5);
            (lo + hi) / 2.0 + local * size
        };
        let mut places = Vec::new();
        for x in [0.1, 0.3, 0.5, 0.7, 0.9] {
            for z in [0.1, 0.3, 0.5, 0.7, 0.9] {
                for y in [0.2, 0.6] {
                    places.extend((0..8).map(|turn| {
                        let (sin, cos) = (turn as f32 * std::f32::consts::TAU / 8.0).sin_cos();
                        (at(x, y, z), at(x, y, z) + (right * cos + ahead * sin) * size.length())
                    }));
                }
            }
        }
        for (x, z) in [(-0.6, -0.6), (1.6, -0.6), (1.6, 1.6), (-0.6, 1.6)] {
            places.push((at(x, 0.9, z), (lo + hi) / 2.0));
        }
        let scored = places.into_iter().map(|(eye, ahead)| {
            let camera = Self { eye, look: look.unwrap_or(ahead), ..*self };
            (if camera.is_upright() { camera.score(scene) } else { 0.0 }, (eye, camera.look))
        });
        let mut scored: Vec<_> = scored.filter(|(score, _)| *score > 0.0).collect();
        // A stable sort: of equal ones the first wins.
        scored.sort_by(|a, b| b.0.total_cmp(&a.0));
        scored.into_iter().map(|(_, place)| place).collect()
    }

    /// Score of a view for culling: many objects in front and many behind them, few right before the camera, and few
    /// back faces.
    fn score(&self, scene: &Scene) -> f32 {
        let clip = self.clip_from_world();
        let mut buffer = ZBuffer::new(96, 54);
        let mut in_sight = 0.0;
        for (id, object) in scene.objects.iter().enumerate().filter(|(_, o)| in_view(o.lo, o.hi, &clip)) {
            buffer.draw(object, id as u32, &clip, self.near);
            in_sight += 1.0;
        }
        let size = (scene.bounds().1 - scene.bounds().0).length();
        let (mut seen, mut covered, mut close) = (vec![false; scene.objects.len()], 0.0, 0.0);
        for (&(object, triangle), &depth) in buffer.owner.iter().zip(&buffer.depth) {
            if object == NOTHING {
                continue;
            }
            covered += 1.0;
            seen[object as usize] = true;
            let [a, b, c] = scene.objects[object as usize].corners(triangle as usize);
            let back = (b - a).cross(c - a).dot(self.eye - a) < 0.0;
            close += f32::from(u8::from(back || self.near / depth < 0.03 * size));
        }
        let pixels = buffer.owner.len() as f32;
        let open = 1.0 - close / pixels;
        let seen = seen.iter().filter(|s| **s).count() as f32;
        (seen * (in_sight - seen + 1.0)).sqrt() * (covered / pixels).min(0.85) * open * open
    }
}

/// Whether a box may be in view. It is not if all its corners are outside the same plane.
pub fn in_view(lo: Vec3, hi: Vec3, clip: &Mat4) -> bool {
    let corners = box_corners(lo, hi).map(|p| *clip * p.extend(1.0));
    let outside = |side: fn(f32, f32, f32) -> bool| corners.iter().all(|c| side(c.x, c.y, c.w));
    !(outside(|x, _, w| x < -w)
        || outside(|x, _, w| x > w)
        || outside(|_, y, w| y < -w)
        || outside(|_, y, w| y > w)
        || outside(|_, _, w| w <= 0.0))
}

pub fn box_corners(lo: Vec3, hi: Vec3) -> [Vec3; 8] {
    std::array::from_fn(|i| Vec3::select(glam::BVec3::new(i & 1 == 0, i & 2 == 0, i & 4 == 0), lo, hi))
}
