//! What is visible and hidden in a view, by a full-resolution z-buffer that shares no code with the library.

use crate::subject::{Rectangle, Subject, View};
use demo::camera::in_view;
use demo::raster::{ZBuffer, each_pixel};
use demo::scene::Object;
use tools::rectangle::hides;

/// Tolerance of depths before something counts as nearer.
const ROUNDING: f32 = 1.0 + 1e-5;
/// Pixels by which triangles are grown to allow for rounding: half a step of the vertex grid.
const GROWN: f64 = 1.0 / 512.0;

/// The ground truth for a view at a resolution.
pub struct Visibility {
    /// The depth of the occluders at every pixel.
    pub exact: ZBuffer,
    /// For each object: whether it has pixels in view, all of them behind an occluder.
    pub hidden_objects: Vec<bool>,
    /// For each object: whether a pixel of it is visible regardless of rounding.
    pub showing_objects: Vec<bool>,
    /// For each box: whether the exact z-buffer hides its rectangle.
    pub hidden_boxes: Vec<bool>,
    /// For each box: whether it may be culled, with the benefit of rounding.
    pub may_hide_boxes: Vec<bool>,
}

/// The two nearest depths of every pixel that belong to different objects.
struct TwoNearest {
    nearest: Vec<(f32, u32)>,
    second: Vec<f32>,
}

impl TwoNearest {
    fn take(&mut self, pixel: usize, depth: f32, id: u32) {
        let (nearest, second) = (&mut self.nearest[pixel], &mut self.second[pixel]);
        if nearest.1 == id {
            nearest.0 = nearest.0.max(depth);
        } else if depth > nearest.0 {
            *second = nearest.0;
            *nearest = (depth, id);
        } else {
            *second = second.max(depth);
        }
    }

    /// The nearest depth of all objects except one.
    fn of_others(&self, pixel: usize, id: u32) -> f32 {
        if self.nearest[pixel].1 == id { self.second[pixel] } else { self.nearest[pixel].0 }
    }
}

impl Visibility {
    pub fn new(subject: &Subject, view: &View, boxes: &[Rectangle], (width, height): (u32, u32)) -> Self {
        let size = (width as usize, height as usize);
        let pixels = size.0 * size.1;
        let View { clip, near } = view;
        let mut exact = ZBuffer::new(size.0, size.1);
        let mut grown = ZBuffer::new(size.0, size.1);
        let mut two = TwoNearest { nearest: vec![(0.0, u32::MAX); pixels], second: vec![0.0; pixels] };
        let objects: Vec<(usize, &Object)> =
            subject.objects.iter().enumerate().filter(|(_, o)| in_view(o.lo, o.hi, clip)).collect();
        for &(id, object) in objects.iter().filter(|(_, o)| o.occluder) {
            exact.draw(object, id as u32, clip, *near);
            each_pixel(object, size, GROWN, clip, *near, |pixel, _, depth| two.take(pixel, depth, id as u32));
        }
        for (pixel, depth) in grown.depth.iter_mut().enumerate() {
            *depth = two.nearest[pixel].0;
        }

        let mut hidden_objects = vec![false; subject.objects.len()];
        let mut showing_objects = hidden_objects.clone();
        for &(id, object) in &objects {
            let (mut touches, mut shows) = (false, false);
            each_pixel(object, size, 0.0, clip, *near, |pixel, _, depth| {
                touches = true;
                shows |= depth >= exact.depth[pixel];
                showing_objects[id] |= depth > two.of_others(pixel, id as u32) * ROUNDING;
            });
            hidden_objects[id] = touches && !shows;
        }
        let hidden = |buffer: &ZBuffer, factor, inset| {
            boxes.iter().map(|b| b.is_some_and(|b| hides(buffer, &b, *near, factor, inset))).collect()
        };
        Self {
            hidden_boxes: hidden(&exact, 1.0, 0.0),
            may_hide_boxes: hidden(&grown, ROUNDING, 1e-3),
            exact,
            hidden_objects,
            showing_objects,
        }
    }

    /// The exact z-buffer reduced to the least depth of each 8x4 pixels: the upper bound for culling with one depth per
    /// 8x4 pixels.
    pub fn blocks(&self) -> ZBuffer {
        let (width, height) = (self.exact.width.div_ceil(8), self.exact.height.div_ceil(4));
        let mut blocks = ZBuffer::new(width, height);
        blocks.depth.fill(f32::INFINITY);
        for (i, &depth) in self.exact.depth.iter().enumerate() {
            let (x, y) = (i % self.exact.width / 8, i / self.exact.width / 4);
            let block = &mut blocks.depth[y * width + x];
            *block = block.min(depth);
        }
        blocks
    }
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec3, vec3};

    use super::*;
    use demo::scene::Mesh;
    use tools::rectangle::rectangle;

    /// A wall, a block behind it, a block beside it, and a block in front, all of which occlude.
    #[test]
    fn what_is_behind_is_hidden_and_what_is_beside_shows() {
        let clip = glam::camera::rh::proj::directx::perspective_infinite_reverse(1.0, 16.0 / 9.0, 0.1);
        let object = |lo: Vec3, hi: Vec3| {
            let mut mesh = Mesh::default();
            mesh.cuboid(lo, hi, Vec3::ONE);
            Object::new(mesh, true, false).unwrap()
        };
        let objects = vec![
            object(vec3(-2.0, -2.0, -6.0), vec3(2.0, 2.0, -5.0)),
            object(vec3(-1.0, -1.0, -9.0), vec3(1.0, 1.0, -8.0)),
            object(vec3(3.0, -1.0, -9.0), vec3(4.0, 1.0, -8.0)),
            object(vec3(-0.1, -0.1, -3.0), vec3(0.1, 0.1, -2.0)),
            // Behind the eye.
            object(vec3(-1.0, -1.0, 5.0), vec3(1.0, 1.0, 6.0)),
        ];
        let view = View { clip, near: 0.1 };
        let boxes: Vec<Rectangle> =
            objects.iter().map(|o| rectangle(o.lo, o.hi, &view.clip, view.near)).chain([None]).collect();
        let subject = Subject { name: String::new(), objects, views: Vec::new() };
        let truth = Visibility::new(&subject, &view, &boxes, (320, 180));
        assert_eq!(truth.hidden_objects, [false, true, false, false, false]);
        assert_eq!(truth.showing_objects, [true, false, true, true, false]);
        assert_eq!(truth.hidden_boxes[..4], [false, true, false, false]);
        assert!(!truth.hidden_boxes[5] && !truth.may_hide_boxes[5]);
        let blocks = truth.blocks();
        assert_eq!((blocks.width, blocks.height), (40, 45));
        assert!(hides(&blocks, &boxes[1].unwrap(), 0.1, 1.0, 0.0));
        assert_ne!(Mat4::IDENTITY, view.clip);
    }
}
