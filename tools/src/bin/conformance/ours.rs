//! This library's side: each triangle is drawn alone into a cleared buffer; its coverage becomes one bit per pixel.

use masked_occlusion_culling::{
    BackfaceWinding, DrawOptions, Error, MaskedOcclusionCulling, Settings, Vertices, YAxis,
};

use crate::driver::{BATCH, WORDS};
use crate::view::View;
use tools::oracle::Triangle;

pub struct Ours {
    moc: MaskedOcclusionCulling,
    view: View,
    depth: Vec<f32>,
    /// The coverage of a batch: one plane of the screen for each 32 triangles, with one bit per triangle in each pixel.
    planes: Vec<u32>,
}

impl Ours {
    pub fn new(view: View, axis: YAxis) -> Result<Self, Error> {
        let settings = Settings::default().with_y_axis(axis);
        let moc = MaskedOcclusionCulling::new(view.width as u32, view.height as u32, settings)?;
        Ok(Self { moc, view, depth: vec![0.0; view.pixels()], planes: vec![0; WORDS * view.pixels()] })
    }

    /// Draws a batch, and returns the number of pixels that each triangle covers.
    pub fn draw(&mut self, triangles: &[Triangle]) -> Result<Vec<u64>, Error> {
        assert!(triangles.len() <= BATCH);
        self.planes.fill(0);
        triangles.iter().enumerate().map(|(i, t)| self.draw_one(i, t)).collect()
    }

    fn draw_one(&mut self, number: usize, t: &Triangle) -> Result<u64, Error> {
        let axis = self.moc.y_axis();
        let vertices = t.map(|v| self.view.our_vertex(&v, axis));
        let options = DrawOptions::default().with_winding(BackfaceWinding::None);
        self.moc.clear_buffer();
        self.moc.render_triangles(Vertices::clip_space(&vertices), &[0, 1, 2], &options)?;
        self.moc.compute_pixel_depth_buffer(&mut self.depth, false)?;
        let pixels = self.view.pixels();
        let mut covered = 0;
        let plane = &mut self.planes[number / 32 * pixels..][..pixels];
        for (bits, depth) in plane.iter_mut().zip(&self.depth) {
            let here = u32::from(*depth > 0.0);
            *bits |= here << (number % 32);
            covered += here;
        }
        Ok(u64::from(covered))
    }

    /// The bits of a pixel in one plane.
    pub fn planes(&self) -> impl Iterator<Item = &[u32]> {
        self.planes.chunks_exact(self.view.pixels())
    }
}
