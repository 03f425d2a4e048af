//! Where the scene is seen from.

use glam::camera::rh::{proj::directx::perspective_infinite_reverse, view::look_to_mat4};
use glam::{Mat4, Vec3};

use crate::Result;
use crate::args::Args;
use crate::raster::{NOTHING, ZBuffer};
use crate::scene::Scene;

/// A camera that sees in perspective, without a far plane.
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
    /// The camera that the arguments ask for; what they leave open is chosen for the scene.
    pub fn new(args: &Args, scene: &Scene) -> Result<Self> {
        let (lo, hi) = scene.bounds();
        let mut camera = Self {
            eye: lo,
            look: (lo + hi) / 2.0,
            up: args.up,
            fov: args.fov.to_radians(),
            near: args.near.unwrap_or((hi - lo).length() * 2e-4),
            aspect: args.size.0 as f32 / args.size.1 as f32,
        };
        match (args.eye, args.look) {
            (Some(eye), look) => (camera.eye, camera.look) = (eye, look.unwrap_or(camera.look)),
            (None, _) if args.scene.is_none() => {
                let (eye, look) = crate::town::camera();
                (camera.eye, camera.look) = (eye, args.look.unwrap_or(look));
            }
            (None, _) => camera.choose(scene, args.look),
        }
        if camera.look == camera.eye {
            camera.look += camera.sideways();
        }
        if !camera.is_upright() {
            return Err(
                "the camera looks along --up: give another direction as --up, or another --eye or --look".into()
            );
        }
        Ok(camera)
    }

    /// Is up another direction than that of the view? Places too far apart for a float say no as well.
    fn is_upright(&self) -> bool {
        (self.look - self.eye).normalize_or_zero().cross(self.up).length() >= 1e-3
    }

    /// From the world to clip space: w is the distance along the view, z is the near distance.
    pub fn clip_from_world(&self) -> Mat4 {
        let direction = (self.look - self.eye).normalize();
        perspective_infinite_reverse(self.fov, self.aspect, self.near) * look_to_mat4(self.eye, direction, self.up)
    }

    /// Some direction at a right angle to up.
    fn sideways(&self) -> Vec3 {
        self.up.any_orthonormal_vector()
    }

    /// Tries places inside of the scene and in front of it, and takes the best.
    fn choose(&mut self, scene: &Scene, look: Option<Vec3>) {
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

        let mut best = 0.0;
        let mut chosen = (at(-0.6, 0.9, 1.6), (lo + hi) / 2.0);
        for (eye, ahead) in places {
            (self.eye, self.look) = (eye, look.unwrap_or(ahead));
            let score = if self.is_upright() { self.score(scene) } else { 0.0 };
            if score > best {
                (best, chosen) = (score, (self.eye, self.look));
            }
        }
        (self.eye, self.look) = chosen;
    }

    /// How much there is to see and to cull: many objects in front and many behind, few of them in the way, and
    /// few backs of triangles.
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

/// May a box be in view? It is not when all its corners lie beyond one side.
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

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn a_view_along_up_is_refused() {
        let mut scene = Scene::default();
        let mut mesh = Mesh::default();
        mesh.cuboid(Vec3::ZERO, Vec3::ONE, Vec3::ONE);
        scene.add(mesh, true, false);
        let camera = |eye, up| Camera::new(&Args::parse_from(["demo", "a.obj", "--eye", eye, "--up", up]), &scene);
        assert!(camera("0.5,9,0.5", "0,1,0").unwrap_err().to_string().contains("--up"));
        assert!(camera("0.5,9,0.5", "0,0,2").is_ok());
        assert!(camera("0.5,9,0.6", "0,1,0").is_ok());
        assert!(camera("3e38,3e38,3e38", "0,1,0").is_err());
    }
}
