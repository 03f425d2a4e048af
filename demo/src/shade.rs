//! Shades the contents of a z-buffer: the sun with its shadows, the sky, a little haze.

use glam::{Mat4, Vec3};

use crate::image::Image;
use crate::raster::{NOTHING, ZBuffer, orthographic};
use crate::scene::Scene;

/// Pixels on each side of the shadow map.
const SHADOW_MAP: usize = 4096;

/// The light of a scene.
pub struct Light {
    up: Vec3,
    to_sun: Vec3,
    shadows: ZBuffer,
    shadow_from_world: Mat4,
    /// Offset from a surface for shadow tests.
    step: f32,
}

impl Light {
    pub fn new(scene: &Scene, up: Vec3, towards: Vec3) -> Self {
        // The sun is behind the viewer's shoulder.
        let ahead = towards.reject_from_normalized(up).try_normalize().unwrap_or(up.any_orthonormal_vector());
        let to_sun = (up * 1.15 - ahead * 0.55 + ahead.cross(up) * 0.75).normalize();
        let (lo, hi) = scene.bounds();
        let side = SHADOW_MAP as f32;
        let corners = crate::camera::box_corners(lo, hi);
        let shadow_from_world = orthographic(&corners, -to_sun, up, side, side);
        let mut shadows = ZBuffer::new(SHADOW_MAP, SHADOW_MAP);
        for (id, object) in scene.objects.iter().enumerate() {
            shadows.draw(object, id as u32, &shadow_from_world, 0.0);
        }
        Self { up, to_sun, shadows, shadow_from_world, step: (hi - lo).length() / side * 2.0 }
    }

    /// The fraction of sunlight that reaches a point, from 0 to 1.
    fn sun(&self, point: Vec3, normal: Vec3) -> f32 {
        let p = self.shadow_from_world.project_point3(point + normal * self.step);
        let side = SHADOW_MAP as f32;
        let (x, y) = ((p.x * 0.5 + 0.5) * side, (0.5 - p.y * 0.5) * side);
        let mut lit = 0.0;
        for (dx, dy) in [(-0.7, -0.3), (0.3, -0.7), (0.7, 0.3), (-0.3, 0.7)] {
            let at = |v: f32| (v.max(0.0) as usize).min(SHADOW_MAP - 1);
            let pixel = at(y + dy) * SHADOW_MAP + at(x + dx);
            lit += f32::from(u8::from(self.shadows.depth[pixel] <= p.z + 2e-4)) / 4.0;
        }
        lit
    }

    /// The light reflected by a surface of this colour.
    fn shade(&self, colour: Vec3, point: Vec3, normal: Vec3) -> Vec3 {
        let sky = Vec3::new(0.42, 0.50, 0.62).lerp(Vec3::new(0.24, 0.21, 0.19), 0.5 - 0.5 * normal.dot(self.up));
        let facing = normal.dot(self.to_sun).max(0.0);
        let sun = if facing > 0.0 { facing * self.sun(point, normal) } else { 0.0 };
        colour.powf(2.2) * (sky + Vec3::new(1.35, 1.22, 1.0) * sun)
    }

    /// The picture of the contents of `buffer`, seen with `clip_from_world`. `paint` maps an object's own colour to the
    /// one shown; `haze` is the distance at which half of the colour is lost, and the colour that it fades to.
    pub fn picture(
        &self,
        scene: &Scene,
        buffer: &ZBuffer,
        clip_from_world: &Mat4,
        paint: impl Fn(usize, Vec3) -> Vec3,
        background: impl Fn(f32) -> Vec3,
        haze: Option<(Vec3, f32)>,
    ) -> Image {
        let world_from_clip = clip_from_world.inverse();
        let mut image = Image::new(buffer.width, buffer.height, Vec3::ZERO);
        for (i, (&(object, triangle), &depth)) in buffer.owner.iter().zip(&buffer.depth).enumerate() {
            let x = ((i % buffer.width) as f32 + 0.5) / buffer.width as f32;
            let y = ((i / buffer.width) as f32 + 0.5) / buffer.height as f32;
            if object == NOTHING {
                image.pixels[i] = background(y);
                continue;
            }
            let unproject = |z| world_from_clip.project_point3(Vec3::new(x * 2.0 - 1.0, 1.0 - y * 2.0, z));
            let point = unproject(depth);
            let nearer = unproject(depth + (1.0 - depth) * 0.5);
            let owner = &scene.objects[object as usize];
            let [a, b, c] = owner.corners(triangle as usize);
            let normal = (b - a).cross(c - a).normalize_or(self.up);
            // Two-sided objects may show their back faces.
            let normal = if normal.dot(nearer - point) < 0.0 { -normal } else { normal };
            let colour = paint(object as usize, owner.mesh.colours[triangle as usize]);
            let mut light = self.shade(colour, point, normal);
            if let Some((eye, half)) = haze {
                let lost = 1.0 - (-(point - eye).length() / half * std::f32::consts::LN_2).exp();
                light = light.lerp(background(0.5).powf(2.2), lost);
            }
            image.pixels[i] = light.powf(1.0 / 2.2).min(Vec3::ONE);
        }
        image
    }
}
