//! The library under measurement: the simplest instruction set and the best one together, which must agree to the bit.

use masked_occlusion_culling::{
    CullingResult, DrawOptions, Implementation, MaskedOcclusionCulling, UpdateRule, Vertices, YAxis,
};

use crate::oracle::Triangle;
use crate::support::{both_sides, mesh, name, object};

pub struct Subject {
    pub size: (usize, usize),
    pub axis: YAxis,
    objects: Vec<MaskedOcclusionCulling>,
    depth: Vec<f32>,
    other: Vec<f32>,
}

impl Subject {
    pub fn new(size: (usize, usize), axis: YAxis) -> Self {
        Self::of_rule(size, axis, UpdateRule::ThreeLayer)
    }

    pub fn of_rule(size: (usize, usize), axis: YAxis, rule: UpdateRule) -> Self {
        let all = Implementation::available();
        let mut sets = vec![all[0], all[all.len() - 1]];
        sets.dedup();
        let mut objects: Vec<_> = sets.into_iter().map(|set| object(set, rule, axis, size)).collect();
        objects.iter_mut().for_each(|moc| moc.set_near_clip_plane(0.0).unwrap());
        Self { size, axis, objects, depth: Vec::new(), other: Vec::new() }
    }

    pub fn y_up(&self) -> bool {
        self.axis == YAxis::Up
    }

    pub fn set_near(&mut self, near: f32) {
        self.objects.iter_mut().for_each(|moc| moc.set_near_clip_plane(near).unwrap());
    }

    pub fn clear(&mut self) {
        self.objects.iter_mut().for_each(|moc| moc.clear_buffer());
    }

    /// Draws a mesh.
    pub fn render(&mut self, vertices: Vertices<'_>, indices: &[u32], options: &DrawOptions) {
        self.objects.iter_mut().for_each(|moc| {
            moc.render_triangles(vertices, indices, options).unwrap();
        });
    }

    /// Draws both sides of clip-space vertices.
    pub fn draw_mesh(&mut self, vertices: &[[f32; 4]], indices: &[u32]) {
        self.render(Vertices::clip_space(vertices), indices, &both_sides());
    }

    /// Draws both sides of clip-space vertices, three per triangle.
    pub fn draw_clip(&mut self, vertices: &[[f32; 4]]) {
        let indices: Vec<u32> = (0..vertices.len() as u32).collect();
        self.draw_mesh(vertices, &indices);
    }

    /// Draws both sides of triangles on the grid, each w a power of two.
    pub fn draw(&mut self, triangles: &[Triangle]) {
        let (vertices, indices) = mesh(triangles, self.size, self.axis);
        self.draw_mesh(&vertices, &indices);
    }

    /// How many triangles have been dropped since the object was made.
    pub fn dropped(&self) -> i64 {
        self.objects[0].statistics().occluders.num_dropped_triangles
    }

    /// The common answer of all objects for both sides of clip-space vertices.
    pub fn test_mesh(&self, vertices: &[[f32; 4]], indices: &[u32]) -> CullingResult {
        let vertices = Vertices::clip_space(vertices);
        self.answer(|moc| moc.test_triangles(vertices, indices, &both_sides()).unwrap())
    }

    pub fn test_clip(&self, vertices: &[[f32; 4]]) -> CullingResult {
        let indices: Vec<u32> = (0..vertices.len() as u32).collect();
        self.test_mesh(vertices, &indices)
    }

    /// The common answer of all objects for one pixel at a depth.
    pub fn test_pixel(&self, column: usize, row: usize, w: f32) -> CullingResult {
        let at = |n: usize, size: usize| (2.0 * (n as f64 + 0.5) / size as f64 - 1.0) as f32;
        let (x, row) = (at(column, self.size.0), at(row, self.size.1));
        let y = if self.y_up() { row } else { -row };
        self.answer(|moc| moc.test_rect(x, y, x, y, w))
    }

    fn answer(&self, ask: impl Fn(&MaskedOcclusionCulling) -> CullingResult) -> CullingResult {
        let first = ask(&self.objects[0]);
        for moc in &self.objects[1..] {
            assert_eq!(ask(moc), first, "{} answers otherwise than {}", name(moc), name(&self.objects[0]));
        }
        first
    }

    /// The depth of every pixel, identical in all objects.
    pub fn depth(&mut self) -> &[f32] {
        crate::support::read(&self.objects[0], &mut self.depth);
        for moc in &self.objects[1..] {
            crate::support::read(moc, &mut self.other);
            let differs = |(a, b): (&f32, &f32)| a.to_bits() != b.to_bits();
            if let Some(i) = self.depth.iter().zip(&self.other).position(differs) {
                let (x, y) = (i % self.size.0, i / self.size.0);
                panic!("{}: ({x}, {y}) is not what {} has", name(moc), name(&self.objects[0]));
            }
        }
        &self.depth
    }
}
