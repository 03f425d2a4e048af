//! Simple solids for the town, in metres, y up.

use std::f32::consts::TAU;

use glam::{Mat4, Vec2, Vec3, vec3};

use crate::scene::Mesh;

impl Mesh {
    /// A flat polygon with its corners counter-clockwise as seen from outside; it must be convex.
    pub fn polygon(&mut self, corners: &[Vec3], colour: Vec3) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(corners);
        for i in 1..corners.len() as u32 - 1 {
            self.triangles.push([first, first + i, first + i + 1]);
            self.colours.push(colour);
        }
    }

    /// A box between two corners.
    pub fn cuboid(&mut self, lo: Vec3, hi: Vec3, colour: Vec3) {
        self.tapered(lo, hi, Vec2::ZERO, colour);
    }

    /// A box whose top is inset by `inset` on each side, in x and z.
    pub fn tapered(&mut self, lo: Vec3, hi: Vec3, inset: Vec2, colour: Vec3) {
        let corner = |x: bool, y: bool, z: bool| {
            let inset = if y { inset } else { Vec2::ZERO };
            vec3(
                if x { hi.x - inset.x } else { lo.x + inset.x },
                if y { hi.y } else { lo.y },
                if z { hi.z - inset.y } else { lo.z + inset.y },
            )
        };
        let (o, i) = (false, true);
        let faces = [
            [(o, o, i), (i, o, i), (i, i, i), (o, i, i)],
            [(i, o, o), (o, o, o), (o, i, o), (i, i, o)],
            [(i, o, i), (i, o, o), (i, i, o), (i, i, i)],
            [(o, o, o), (o, o, i), (o, i, i), (o, i, o)],
            [(o, i, i), (i, i, i), (i, i, o), (o, i, o)],
            [(o, o, o), (i, o, o), (i, o, i), (o, o, i)],
        ];
        for face in faces {
            self.polygon(&face.map(|(x, y, z)| corner(x, y, z)), colour);
        }
    }

    /// A roof over a rectangle, with its ridge along x; `hip` shortens the ridge at both ends.
    pub fn roof(&mut self, lo: Vec3, hi: Vec3, hip: f32, roof: Vec3, gable: Vec3) {
        let middle = (lo.z + hi.z) / 2.0;
        let (left, right) = (vec3(lo.x + hip, hi.y, middle), vec3(hi.x - hip, hi.y, middle));
        let at = |x: f32, z: f32| vec3(x, lo.y, z);
        self.polygon(&[at(lo.x, hi.z), at(hi.x, hi.z), right, left], roof);
        self.polygon(&[at(hi.x, lo.z), at(lo.x, lo.z), left, right], roof);
        let ends = if hip > 0.0 { roof } else { gable };
        self.polygon(&[at(lo.x, lo.z), at(lo.x, hi.z), left], ends);
        self.polygon(&[at(hi.x, hi.z), at(hi.x, lo.z), right], ends);
        self.polygon(&[at(lo.x, lo.z), at(hi.x, lo.z), at(hi.x, hi.z), at(lo.x, hi.z)], gable);
    }

    /// An upright prism or, with a `top` radius of zero, a pyramid, around the y axis through `base`.
    pub fn cone(&mut self, base: Vec3, height: f32, radius: f32, top: f32, sides: usize, colour: Vec3) {
        let ring = |i: usize, y: f32, r: f32| {
            let (sin, cos) = (i as f32 * TAU / sides as f32).sin_cos();
            base + vec3(cos * r, y, -sin * r)
        };
        for i in 0..sides {
            let (a, b) = (ring(i, 0.0, radius), ring(i + 1, 0.0, radius));
            if top > 0.0 {
                self.polygon(&[a, b, ring(i + 1, height, top), ring(i, height, top)], colour);
            } else {
                self.polygon(&[a, b, base + Vec3::Y * height], colour);
            }
        }
        if top > 0.0 {
            let lid: Vec<Vec3> = (0..sides).map(|i| ring(i, height, top)).collect();
            self.polygon(&lid, colour);
        }
    }

    /// A ball of `8 * 4^n` triangles; `shape` scales the radius in each direction.
    pub fn ball(&mut self, centre: Vec3, radius: Vec3, levels: u32, colour: Vec3, shape: impl Fn(Vec3) -> f32) {
        let mut faces = Vec::new();
        for sign in 0..8 {
            let s = |bit: i32| if sign & bit == 0 { 1.0 } else { -1.0 };
            let (x, y, z) = (Vec3::X * s(1), Vec3::Y * s(2), Vec3::Z * s(4));
            faces.push(if s(1) * s(2) * s(4) > 0.0 { [x, y, z] } else { [x, z, y] });
        }
        for _ in 0..levels {
            faces = faces
                .into_iter()
                .flat_map(|[a, b, c]| {
                    let middle = |p: Vec3, q: Vec3| (p + q).normalize();
                    let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
                })
                .collect();
        }
        for face in faces {
            self.polygon(&face.map(|p| centre + p * radius * shape(p)), colour);
        }
    }

    /// The mesh, moved.
    pub fn placed(mut self, place: Mat4) -> Self {
        for p in &mut self.positions {
            *p = place.transform_point3(*p);
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six times the volume that the triangles enclose: positive when they face out.
    fn volume(mesh: &Mesh) -> f32 {
        let corners = |t: &[u32; 3]| t.map(|i| mesh.positions[i as usize]);
        mesh.triangles.iter().map(corners).map(|[a, b, c]| a.dot(b.cross(c))).sum()
    }

    #[test]
    fn solids_face_outwards() {
        let white = Vec3::ONE;
        let mut cuboid = Mesh::default();
        cuboid.cuboid(vec3(1.0, 2.0, 3.0), vec3(2.0, 4.0, 6.0), white);
        assert!((volume(&cuboid) - 36.0).abs() < 1e-3);

        for hip in [0.0, 1.0] {
            let mut roof = Mesh::default();
            roof.roof(vec3(-4.0, 5.0, -3.0), vec3(4.0, 8.0, 3.0), hip, white, white);
            assert!(volume(&roof) > 0.0);
        }

        let mut ball = Mesh::default();
        ball.ball(Vec3::ZERO, Vec3::ONE, 2, white, |_| 1.0);
        assert_eq!(ball.triangles.len(), 128);
        assert!(volume(&ball) > 22.0 && volume(&ball) < 8.0 * std::f32::consts::PI);

        let mut cone = Mesh::default();
        cone.cone(Vec3::ZERO, 2.0, 1.0, 1.0, 64, white);
        assert!((volume(&cone) / 6.0 - TAU).abs() < 0.05);
    }
}
