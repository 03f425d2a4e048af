//! A hierarchical z-buffer with a depth for each pixel: what the masked buffer is measured beside.
//!
//! As in Hasselgren, Andersson, Akenine-Möller: "Masked Software Occlusion Culling" (HPG 2016), section 4.1: occluders are
//! drawn into a buffer of full resolution, the buffer is reduced to the farthest depth of each 8x8 pixels, and rectangles
//! are tested against those. Written to be as fast as such a rasteriser can reasonably be made. A method is a pass
//! of that paper's table 1:
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
//! Depth is 1/w as in the library. Vertices are snapped to 1/256 pixel (coarser beyond some 2,500x2,500 pixels), edge
//! functions are exact, with the top-left rule, and depth is what a float gives at pixel centres, not farther than at
//! them. It uses AVX-512, AVX2 with fused multiply-add, or whatever the compiler makes of arrays of four.

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

use lanes::{Lanes, MOST, Pass, Words};
use list::TriangleList;
use reduce::TILE;
use screen::Screen;

/// A hierarchical z-buffer, and what its passes hand to each other.
pub struct Hiz {
    level: Implementation,
    /// Which triangles face away.
    pub winding: BackfaceWinding,
    screen: Screen,
    block: Block,
    /// Row after row of blocks; from `start` on, where a cache line begins.
    depth: Vec<f32>,
    start: usize,
    /// The farthest depth of each tile, and room for a vector behind each row.
    farthest: Vec<f32>,
    clip: Vec<[f32; 4]>,
    projected: Vec<Words>,
    /// Are `projected` the vertices of `clip`?
    is_projected: bool,
    list: TriangleList,
}

/// Pixels that lie side by side in memory: a vector's.
#[derive(Clone, Copy)]
struct Block {
    log_width: u32,
    log_height: u32,
}

struct BlockOfLanes;

impl Pass for BlockOfLanes {
    type Output = Block;
    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> Block {
        Block { log_width: L::LOG_WIDTH, log_height: L::LOG_HEIGHT }
    }
}

impl Hiz {
    /// A cleared buffer, on the best instruction set that the processor has.
    pub fn new(width: u32, height: u32) -> Self {
        Self::with_level(width, height, Implementation::Avx512)
    }

    /// A cleared buffer on `level`, or on the next lower that there is: AVX-512, AVX2 or scalar.
    pub fn with_level(width: u32, height: u32, level: Implementation) -> Self {
        let level = lanes::usable(level);
        // SAFETY: it is usable.
        let block = unsafe { lanes::run(level, BlockOfLanes) };
        let [columns, rows] = [width, height].map(|size| (size as usize).div_ceil(TILE));
        let depth = vec![0.0; columns * rows * TILE * TILE + MOST];
        Self {
            level,
            winding: BackfaceWinding::default(),
            screen: Screen::new(width, height),
            block,
            start: depth.as_ptr().align_offset(64),
            depth,
            farthest: vec![0.0; (columns + MOST) * rows],
            clip: Vec::new(),
            projected: Vec::new(),
            is_projected: false,
            list: TriangleList::default(),
        }
    }

    /// The instruction set that is used.
    pub fn level(&self) -> Implementation {
        self.level
    }

    /// What is nearer in w is cut off. 0 at first.
    pub fn set_near(&mut self, near: f32) {
        self.screen.near = near;
        self.is_projected = false;
    }

    fn tiles(&self) -> [usize; 2] {
        [self.screen.width, self.screen.height].map(|size| (size as usize).div_ceil(TILE))
    }

    /// Floats from one row of blocks to the next.
    fn stride(&self) -> usize {
        self.tiles()[0] * TILE << self.block.log_height
    }

    fn depth_range(&self) -> std::ops::Range<usize> {
        let [columns, rows] = self.tiles();
        self.start..self.start + columns * rows * TILE * TILE
    }

    /// Clear: nothing was drawn.
    pub fn clear(&mut self) {
        let range = self.depth_range();
        self.depth[range].fill(0.0);
    }

    /// Geom: positions (x, y, z, anything) to clip space. 16 bytes a vertex is the fastest to read, and what
    /// `glam::Vec3A` takes.
    pub fn transform(&mut self, positions: &[[f32; 4]], matrix: &Mat4) {
        self.is_projected = false;
        // SAFETY: the level is usable.
        unsafe { lanes::run(self.level, transform::Transform { positions, matrix, out: &mut self.clip }) };
    }

    /// Geom, for vertices (x, y, anything, w) that are in clip space already.
    pub fn set_clip_space(&mut self, vertices: &[[f32; 4]]) {
        self.is_projected = false;
        self.clip.clear();
        self.clip.extend_from_slice(vertices);
    }

    /// Proj: triangles of the vertices that were transformed last, three indices each, to the list that waits for `raster`.
    /// The first call after a transformation projects the vertices.
    ///
    /// # Panics
    /// Where there is no such vertex.
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

    /// How many triangles wait for `raster`.
    pub fn waiting(&self) -> usize {
        self.list.len()
    }

    /// Rast: draws what waits.
    pub fn raster(&mut self) {
        let (screen, range, stride) = (self.screen, self.depth_range(), self.stride());
        let pass = raster::Raster { screen, list: &self.list, depth: &mut self.depth[range], stride };
        // SAFETY: the level is usable.
        unsafe { lanes::run(self.level, pass) };
        self.list.clear();
    }

    /// Gen: the farthest depth of each tile, for `test_rect`.
    pub fn generate(&mut self) {
        let (tiles, range, stride) = (self.tiles(), self.depth_range(), self.stride());
        let row = tiles[0] + MOST;
        let pass = reduce::Reduce { depth: &self.depth[range], stride, tiles, farthest: &mut self.farthest, row };
        // SAFETY: the level is usable.
        unsafe { lanes::run(self.level, pass) };
    }

    /// Test: is a rectangle at `w_min` hidden by what `generate` found, or off the screen?
    pub fn test_rect(&self, x_min: f32, y_min: f32, x_max: f32, y_max: f32, w_min: f32) -> bool {
        // NaN fails every comparison.
        if !(x_min <= x_max && y_min <= y_max && w_min > 0.0) {
            return false;
        }
        if x_max <= -1.0 || x_min >= 1.0 || y_max <= -1.0 || y_min >= 1.0 {
            return true;
        }
        let (left, right) = query::tiles(x_min, x_max, self.screen.width);
        let (top, bottom) = query::tiles(-y_max, -y_min, self.screen.height);
        let row = self.tiles()[0] + MOST;
        let (first, last) = ([left, top], [right, bottom]);
        // SAFETY: the level is usable.
        unsafe {
            lanes::run(self.level, query::Query { farthest: &self.farthest, row, first, last, depth: 1.0 / w_min })
        }
    }

    /// The depth of a pixel, rows counted from the top; 0 where nothing was drawn.
    pub fn depth(&self, x: u32, y: u32) -> f32 {
        assert!(x < self.screen.width && y < self.screen.height, "no pixel ({x}, {y})");
        let Block { log_width, log_height } = self.block;
        let (inner_x, inner_y) = (x & ((1 << log_width) - 1), y & ((1 << log_height) - 1));
        let block = ((x >> log_width) << (log_width + log_height)) + (inner_y << log_width) + inner_x;
        self.depth[self.start + (y >> log_height) as usize * self.stride() + block as usize]
    }

    /// The farthest depth in each tile of 8x8 pixels, as `generate` found it: tiles across, and row after row.
    pub fn farthest(&self) -> (usize, impl Iterator<Item = &[f32]>) {
        let [columns, rows] = self.tiles();
        (columns, self.farthest.chunks_exact(columns + MOST).take(rows).map(move |row| &row[..columns]))
    }
}
