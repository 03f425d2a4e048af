//! A hierarchical z-buffer with a depth for each pixel, for comparison with the masked buffer.
//!
//! As in Hasselgren, Andersson, Akenine-Möller: "Masked Software Occlusion Culling" (HPG 2016), section 4.1: occluders
//! are drawn into a full-resolution buffer, the buffer is reduced to the farthest depth of each 8x8 pixels, and
//! rectangles are tested against those. It is written to be as fast as such a rasteriser can reasonably be. Each method
//! is one pass of that paper's table 1:
//!
//! ```text
//! clear       Clear  every depth to 0, infinitely far
//! transform   Geom   vertices to clip space
//! project     Proj   vertices to the screen, once each; triangles culled, the rest put into a list
//! raster      Rast   setup, edge functions, depth test and update for all of the list
//! generate    Gen    the reduction
//! test_rect   Test   a rectangle in normalised device coordinates
//! ```
//!
//! Depth is 1/w as in the library. Vertices are snapped to 1/256 pixel (coarser beyond some 2,300x2,300 pixels), edge
//! functions are exact, with the top-left rule, and depth is evaluated at pixel centres in floats. Each tile of 8x8
//! pixels is contiguous in memory: rows of blocks were slower for triangles of 2 pixels on AVX2, and equal within the
//! noise elsewhere. It uses AVX-512, AVX2 with fused multiply-add, or whatever the compiler makes of arrays of eight.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod clip;
mod cull;
mod lanes;
mod list;
mod portable;
mod query;
mod raster;
mod reduce;
mod screen;
mod setup;
#[cfg(test)]
mod tests;
mod transform;
mod vertices;

use glam::Mat4;
use masked_occlusion_culling::{BackfaceWinding, Implementation};

use lanes::{MOST, Words};
use list::TriangleList;
use reduce::TILE;
use screen::Screen;

/// A hierarchical z-buffer, and the data that its passes hand to each other.
pub struct Hiz {
    level: Implementation,
    /// Which triangles are back-facing.
    pub winding: BackfaceWinding,
    screen: Screen,
    /// Tiles of 8x8 pixels one after another, so that small triangles touch few pages; they start at `start`, on a
    /// cache line.
    depth: Vec<f32>,
    start: usize,
    /// The farthest depth of each tile, with room for a vector after each row.
    farthest: Vec<f32>,
    clip: Vec<[f32; 4]>,
    projected: Vec<Words>,
    /// Whether `projected` holds the vertices of `clip`.
    is_projected: bool,
    list: TriangleList,
}

impl Hiz {
    /// A cleared buffer on the best instruction set of the processor.
    pub fn new(width: u32, height: u32) -> Self {
        Self::with_level(width, height, Implementation::Avx512)
    }

    /// A cleared buffer on `level`, or on the next lower one available: AVX-512, AVX2 or scalar.
    pub fn with_level(width: u32, height: u32, level: Implementation) -> Self {
        let level = lanes::usable(level);
        let [columns, rows] = [width, height].map(|size| (size as usize).div_ceil(TILE));
        let depth = vec![0.0; columns * rows * TILE * TILE + MOST];
        let mut new = Self {
            level,
            winding: BackfaceWinding::default(),
            screen: Screen::new(width, height),
            start: depth.as_ptr().align_offset(64),
            depth,
            farthest: vec![0.0; (columns + MOST) * rows],
            clip: Vec::new(),
            projected: Vec::new(),
            is_projected: false,
            list: TriangleList::default(),
        };
        new.clear();
        new
    }

    /// The instruction set in use.
    pub fn level(&self) -> Implementation {
        self.level
    }

    /// Sets the near plane, in w: nearer geometry is clipped. Initially 0.
    pub fn set_near(&mut self, near: f32) {
        self.screen.near = near;
        self.is_projected = false;
    }

    fn tiles(&self) -> [usize; 2] {
        self.screen.size.map(|size| (size as usize).div_ceil(TILE))
    }

    /// Floats from one row of tiles to the next.
    fn stride(&self) -> usize {
        self.tiles()[0] * TILE * TILE
    }

    fn depth_range(&self) -> std::ops::Range<usize> {
        let [columns, rows] = self.tiles();
        self.start..self.start + columns * rows * TILE * TILE
    }

    /// Clear: nothing was drawn.
    pub fn clear(&mut self) {
        let range = self.depth_range();
        self.depth[range].fill(0.0);
        // Pixels of the last tiles beyond the screen must not be the farthest in their tiles.
        let [width, height] = self.screen.size.map(|size| size as usize);
        for y in 0..height.next_multiple_of(TILE) {
            for x in if y < height { width } else { 0 }..width.next_multiple_of(TILE) {
                let place = self.place(x, y);
                self.depth[place] = f32::INFINITY;
            }
        }
    }

    /// Index of a pixel's depth.
    fn place(&self, x: usize, y: usize) -> usize {
        self.start + y / TILE * self.stride() + (x / TILE * TILE + y % TILE) * TILE + x % TILE
    }

    /// Geom: positions (x, y, z, anything) to clip space. 16 bytes per vertex are the fastest to read, and the size of
    /// `glam::Vec3A`.
    pub fn transform(&mut self, positions: &[[f32; 4]], matrix: &Mat4) {
        self.is_projected = false;
        // SAFETY: the level is usable.
        unsafe { lanes::run(self.level, transform::Transform { positions, matrix, out: &mut self.clip }) };
    }

    /// Geom, for vertices (x, y, anything, w) already in clip space.
    #[cfg(test)]
    pub fn set_clip_space(&mut self, vertices: &[[f32; 4]]) {
        self.is_projected = false;
        self.clip.clear();
        self.clip.extend_from_slice(vertices);
    }

    /// Proj: appends triangles of the most recently transformed vertices, three indices each, to the list for `raster`.
    /// The first call after a transformation projects the vertices.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn project(&mut self, indices: &[u32]) {
        let Self { level, winding, screen, ref clip, ref mut projected, ref mut list, .. } = *self;
        if !self.is_projected {
            // SAFETY: the level is usable.
            unsafe { lanes::run(level, vertices::Project { screen, clip, out: projected }) };
            self.is_projected = true;
        }
        // SAFETY: the level is usable.
        unsafe { lanes::run(level, cull::Cull { screen, winding, clip, projected, indices, list }) };
    }

    /// Number of triangles in the list for `raster`.
    #[cfg(test)]
    pub fn waiting(&self) -> usize {
        self.list.len()
    }

    /// Rast: draws the list.
    pub fn raster(&mut self) {
        let (screen, range, stride) = (self.screen, self.depth_range(), self.stride());
        let pass = raster::Raster { screen, list: &self.list, depth: &mut self.depth[range], stride };
        // SAFETY: the level is usable.
        unsafe { lanes::run(self.level, pass) };
        self.list.clear();
    }

    /// Gen: the farthest depth of each tile, for `test_rect`.
    pub fn generate(&mut self) {
        let (tiles, range) = (self.tiles(), self.depth_range());
        let row = tiles[0] + MOST;
        let pass = reduce::Reduce { depth: &self.depth[range], tiles, farthest: &mut self.farthest, row };
        // SAFETY: the level is usable.
        unsafe { lanes::run(self.level, pass) };
    }

    /// Test: whether a rectangle at `w_min` is hidden according to `generate`, or off screen.
    pub fn test_rect(&self, x_min: f32, y_min: f32, x_max: f32, y_max: f32, w_min: f32) -> bool {
        // NaN fails every comparison.
        if !(x_min <= x_max && y_min <= y_max && w_min > 0.0) {
            return false;
        }
        if x_max <= -1.0 || x_min >= 1.0 || y_max <= -1.0 || y_min >= 1.0 {
            return true;
        }
        let [width, height] = self.screen.size;
        let (left, right) = query::tiles(x_min, x_max, width as u32);
        let (top, bottom) = query::tiles(-y_max, -y_min, height as u32);
        let row = self.tiles()[0] + MOST;
        let (first, last) = ([left, top], [right, bottom]);
        // SAFETY: the level is usable.
        unsafe {
            lanes::run(self.level, query::Query { farthest: &self.farthest, row, first, last, depth: 1.0 / w_min })
        }
    }

    /// The depth of a pixel, rows counted from the top; 0 where nothing was drawn.
    #[cfg(test)]
    pub fn depth(&self, x: u32, y: u32) -> f32 {
        let [width, height] = self.screen.size.map(|size| size as u32);
        assert!(x < width && y < height, "no pixel ({x}, {y})");
        self.depth[self.place(x as usize, y as usize)]
    }

    /// The farthest depth of each tile of 8x8 pixels as found by `generate`: the number of tiles across, and the depths
    /// row by row.
    #[cfg(test)]
    pub fn farthest(&self) -> (usize, impl Iterator<Item = &[f32]>) {
        let [columns, rows] = self.tiles();
        (columns, self.farthest.chunks_exact(columns + MOST).take(rows).map(move |row| &row[..columns]))
    }
}
