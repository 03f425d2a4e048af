//! A plain z-buffer for drawing the pictures and checking the results. It shares no code with the library.

use glam::camera::rh::view::look_to_mat4;
use glam::{DVec4, Mat4, Vec3};

use crate::scene::Object;

/// The id of pixels that no triangle covers.
pub const NOTHING: u32 = u32::MAX;

/// For each pixel the nearest depth (clip-space z/w, larger is nearer) and the object and triangle it belongs to.
pub struct ZBuffer {
    pub width: usize,
    pub height: usize,
    pub depth: Vec<f32>,
    /// Object and triangle.
    pub owner: Vec<(u32, u32)>,
    /// The factor by which a triangle must be nearer than the stored depth.
    pub margin: f32,
    /// Number of pixels by which triangles are grown.
    pub grow: f64,
}

impl ZBuffer {
    pub fn new(width: usize, height: usize) -> Self {
        let pixels = width * height;
        Self {
            width,
            height,
            depth: vec![0.0; pixels],
            owner: vec![(NOTHING, NOTHING); pixels],
            margin: 1.0,
            grow: 0.0,
        }
    }

    /// Draws an object with the given `id`. Clips at w = `near`.
    pub fn draw(&mut self, object: &Object, id: u32, clip_from_world: &Mat4, near: f32) {
        let Self { width, height, depth: nearest, owner, margin, grow } = self;
        each_pixel(object, (*width, *height), *grow, clip_from_world, near, |pixel, triangle, depth| {
            if depth > nearest[pixel] * *margin {
                nearest[pixel] = depth;
                owner[pixel] = (id, triangle);
            }
        });
    }
}

/// Calls `touch` with pixel, triangle and depth (clip-space z/w) for every pixel of every triangle of an object. The
/// triangles are grown by `grow` pixels and clipped at w = `near`.
pub fn each_pixel(
    object: &Object,
    size: (usize, usize),
    grow: f64,
    clip_from_world: &Mat4,
    near: f32,
    mut touch: impl FnMut(usize, u32, f32),
) {
    let clip: Vec<DVec4> =
        object.mesh.positions.iter().map(|p| (*clip_from_world * p.extend(1.0)).as_dvec4()).collect();
    for (t, triangle) in object.mesh.triangles.iter().enumerate() {
        let corners = triangle.map(|i| clip[i as usize]);
        let beyond = |out: fn(&DVec4) -> bool| corners.iter().all(out);
        if beyond(|c| c.x < -c.w) || beyond(|c| c.x > c.w) || beyond(|c| c.y < -c.w) || beyond(|c| c.y > c.w) {
            continue;
        }
        let (polygon, n) = clip_near(&corners, f64::from(near));
        for i in 2..n {
            let corners = [polygon[0], polygon[i - 1], polygon[i]];
            each_pixel_of_triangle(corners, size, grow, object.two_sided, |pixel, depth| touch(pixel, t as u32, depth));
        }
    }
}

fn each_pixel_of_triangle(
    clip: [DVec4; 3],
    size: (usize, usize),
    grow: f64,
    two_sided: bool,
    mut touch: impl FnMut(usize, f32),
) {
    let (width, height) = (size.0 as f64, size.1 as f64);
    // Vertices are snapped to a grid of 1/256 pixel, as in the library.
    let snap = |v: f64| (v * 256.0).round() / 256.0;
    let mut p =
        clip.map(|c| (snap((c.x / c.w * 0.5 + 0.5) * width), snap((0.5 - c.y / c.w * 0.5) * height), c.z / c.w));
    let area = |p: &[(f64, f64, f64); 3]| (p[1].0 - p[0].0) * (p[2].1 - p[0].1) - (p[2].0 - p[0].0) * (p[1].1 - p[0].1);
    // y points down, so front faces have negative area.
    match area(&p) {
        a if a < 0.0 => p.swap(1, 2),
        a if a > 0.0 && two_sided => {}
        _ => return,
    }
    let double_area = area(&p);

    let rows = |v: f64, max: f64| v.clamp(0.0, max) as usize;
    let (top, bottom) = (p[0].1.min(p[1].1).min(p[2].1), p[0].1.max(p[1].1).max(p[2].1));
    let (left, right) = (p[0].0.min(p[1].0).min(p[2].0), p[0].0.max(p[1].0).max(p[2].0));
    // a x + b y + c >= 0 on the inner side of each edge, at pixel centres.
    let edges = [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
        let (a, b) = (p[i].1 - p[j].1, p[j].0 - p[i].0);
        (a, b, -(a * p[i].0 + b * p[i].1) + grow * a.hypot(b))
    });
    let depth_x = ((p[1].2 - p[0].2) * (p[2].1 - p[0].1) - (p[2].2 - p[0].2) * (p[1].1 - p[0].1)) / double_area;
    let depth_y = ((p[2].2 - p[0].2) * (p[1].0 - p[0].0) - (p[1].2 - p[0].2) * (p[2].0 - p[0].0)) / double_area;

    for row in rows(top - 1.0, height)..rows(bottom + 1.0, height) {
        let y = row as f64 + 0.5;
        let (mut from, mut to) = (left - 1.0, right + 1.0);
        for (a, b, c) in edges {
            let rest = b * y + c;
            if a > 0.0 {
                from = from.max(-rest / a);
            } else if a < 0.0 {
                to = to.min(-rest / a);
            } else if rest < 0.0 {
                to = f64::NEG_INFINITY;
            }
        }
        let (from, to) = (rows((from - 0.5).ceil(), width), rows((to - 0.5).floor() + 1.0, width));
        for column in from..to {
            let x = column as f64 + 0.5;
            let depth = (p[0].2 + depth_x * (x - p[0].0) + depth_y * (y - p[0].1)) as f32;
            touch(row * size.0 + column, depth);
        }
    }
}

/// The part of a triangle with w >= near: a polygon of up to four corners.
fn clip_near(corners: &[DVec4; 3], near: f64) -> ([DVec4; 4], usize) {
    let (mut polygon, mut n) = ([DVec4::ZERO; 4], 0);
    let mut push = |corner| {
        polygon[n] = corner;
        n += 1;
    };
    for i in 0..3 {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        if a.w >= near {
            push(a);
        }
        if (a.w >= near) != (b.w >= near) {
            push(a.lerp(b, (near - a.w) / (b.w - a.w)));
        }
    }
    (polygon, n)
}

/// The number of objects in `hidden` that have a pixel in front of all the others.
///
/// Both sides of the comparison get the benefit of rounding: triangles are grown by half a step of the vertex grid, and
/// a pixel counts only if it is nearer by more than the rounding error of a float.
pub fn falsely_hidden(objects: &[Object], hidden: &[bool], size: (usize, usize), clip: &Mat4, near: f32) -> usize {
    let mut buffer = ZBuffer { grow: 1.0 / 512.0, ..ZBuffer::new(size.0, size.1) };
    for wanted in [false, true] {
        buffer.margin = if wanted { 1.0 + 1e-5 } else { 1.0 };
        for (id, object) in objects.iter().enumerate().filter(|(id, _)| hidden[*id] == wanted) {
            buffer.draw(object, id as u32, clip, near);
        }
    }
    let mut seen: Vec<u32> = buffer.owner.iter().map(|o| o.0).filter(|&o| o != NOTHING && hidden[o as usize]).collect();
    seen.sort_unstable();
    seen.dedup();
    seen.len()
}

/// An orthographic view along `direction` that contains all of `points` in `width` by `height` pixels; `up` is up in
/// the picture. Depth is 1 nearest and 0 farthest.
pub fn orthographic(points: &[Vec3], direction: Vec3, up: Vec3, width: f32, height: f32) -> Mat4 {
    let view = look_to_mat4(Vec3::ZERO, direction, up);
    let (lo, hi) = crate::scene::bounds(points.iter().map(|p| view.transform_point3(*p)));
    let (centre, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0 * 1.04 + 1e-6);
    let scale = (half.x / width).max(half.y / height);
    let size = Vec3::new(scale * width, scale * height, half.z).recip();
    Mat4::from_scale(Vec3::new(size.x, size.y, size.z * 0.5))
        * Mat4::from_translation(Vec3::new(-centre.x, -centre.y, half.z - centre.z))
        * view
}

#[cfg(test)]
mod tests {
    use glam::camera::rh::proj::directx::perspective_infinite_reverse;

    use super::*;
    use crate::scene::Mesh;

    fn square(z: f32, half: f32) -> Object {
        let mut mesh = Mesh::default();
        let at = |x: f32, y: f32| Vec3::new(x, y, z);
        mesh.polygon(&[at(-half, -half), at(half, -half), at(half, half), at(-half, half)], Vec3::ONE);
        Object::new(mesh, true, false).unwrap()
    }

    fn camera() -> Mat4 {
        perspective_infinite_reverse(1.0, 1.0, 0.1)
    }

    #[test]
    fn a_hidden_square_that_shows_is_found() {
        let objects = [square(-5.0, 1.0), square(-8.0, 1.0), square(-8.0, 2.0)];
        let check = |hidden: [bool; 3]| falsely_hidden(&objects, &hidden, (64, 64), &camera(), 0.1);
        assert_eq!(check([false, true, false]), 0);
        assert_eq!(check([false, true, true]), 1);
        assert_eq!(check([true, true, true]), 2);
    }

    #[test]
    fn depth_is_that_of_the_plane_and_backs_are_not_drawn() {
        let mut buffer = ZBuffer::new(33, 33);
        let mut object = square(-5.0, 1.0);
        buffer.draw(&object, 3, &camera(), 0.1);
        let middle = 16 * 33 + 16;
        assert_eq!(buffer.owner[middle].0, 3);
        assert!((buffer.depth[middle] - 0.1 / 5.0).abs() < 1e-6);
        assert_eq!(buffer.owner[0], (NOTHING, NOTHING));

        object.mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let mut buffer = ZBuffer::new(33, 33);
        buffer.draw(&object, 3, &camera(), 0.1);
        assert_eq!(buffer.owner[middle].0, NOTHING);
    }

    #[test]
    fn what_crosses_the_near_plane_is_cut_there() {
        let mut mesh = Mesh::default();
        let at = |x: f32, z: f32| Vec3::new(x, -1.0, z);
        mesh.polygon(&[at(-50.0, 20.0), at(50.0, 20.0), at(50.0, -20.0), at(-50.0, -20.0)], Vec3::ONE);
        let mut buffer = ZBuffer::new(32, 32);
        buffer.draw(&Object::new(mesh, true, false).unwrap(), 0, &camera(), 0.1);
        assert_eq!(buffer.owner[31 * 32 + 16].0, 0);
        assert_eq!(buffer.owner[8 * 32 + 16].0, NOTHING);
        assert!(buffer.depth.iter().all(|d| (0.0..=1.0).contains(d)));
    }

    #[test]
    fn an_orthographic_view_holds_all_points() {
        let points = [Vec3::ZERO, Vec3::new(10.0, 2.0, -3.0), Vec3::new(-4.0, 7.0, 30.0)];
        let m = orthographic(&points, Vec3::new(0.3, -0.8, -0.4), Vec3::Y, 400.0, 300.0);
        for p in points.map(|p| m * p.extend(1.0)) {
            assert!(p.w == 1.0 && p.x.abs() <= 1.0 && p.y.abs() <= 1.0 && (0.0..=1.0).contains(&p.z), "{p}");
        }
    }
}
