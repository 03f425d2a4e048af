//! stub
pub mod merge; pub mod pixels;
use crate::{Allocator, Error, ScissorRect, UpdateRule};
pub struct Buffer { w: u32, h: u32 }
impl Buffer {
    pub fn new(w: u32, h: u32, _: UpdateRule, _: Allocator) -> Result<Self, Error> { Ok(Self { w, h }) }
    pub fn width(&self) -> u32 { self.w }
    pub fn height(&self) -> u32 { self.h }
    pub fn clear(&mut self) {}
    pub fn bin_size(&self, bins_w: u32, bins_h: u32) -> Result<(u32, u32), Error> {
        if bins_w == 0 || bins_h == 0 { return Err(Error::InvalidSize); }
        let s = (self.w / bins_w / 32 * 32, self.h / bins_h / 8 * 8);
        if s.0 == 0 || s.1 == 0 { Err(Error::InvalidSize) } else { Ok(s) }
    }
    pub fn scissor_tiles(&self, _: Option<ScissorRect>) -> Result<[u32; 4], Error> { Ok([0; 4]) }
}
