//! Pictures: pixels, text, lines, PNG files.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use glam::{Vec2, Vec3};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use crate::Result;

const TEXT: RasterHeight = RasterHeight::Size20;

/// Red, green and blue from 0 to 1 in sRGB, row by row.
pub struct Image {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Vec3>,
}

impl Image {
    pub fn new(width: usize, height: usize, colour: Vec3) -> Self {
        Self { width, height, pixels: vec![colour; width * height] }
    }

    /// At half the size; each pixel is the mean of four.
    pub fn halved(&self) -> Self {
        let mut half = Self::new(self.width / 2, self.height / 2, Vec3::ZERO);
        for (i, pixel) in half.pixels.iter_mut().enumerate() {
            let at = (i / half.width * 2) * self.width + i % half.width * 2;
            let four = [at, at + 1, at + self.width, at + self.width + 1];
            *pixel = four.iter().map(|&p| self.pixels[p]).sum::<Vec3>() / 4.0;
        }
        half
    }

    /// Copies `other` to a position; pixels outside this image are dropped.
    pub fn paste(&mut self, other: &Image, x: usize, y: usize) {
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            let columns = other.width.min(self.width.saturating_sub(x));
            let (to, from) = ((y + row) * self.width + x, row * other.width);
            self.pixels[to..to + columns].copy_from_slice(&other.pixels[from..from + columns]);
        }
    }

    pub fn blend(&mut self, x: i32, y: i32, colour: Vec3, alpha: f32) {
        if (0..self.width as i32).contains(&x) && (0..self.height as i32).contains(&y) {
            let pixel = &mut self.pixels[y as usize * self.width + x as usize];
            *pixel = pixel.lerp(colour, alpha.clamp(0.0, 1.0));
        }
    }

    /// A line with round ends; a dot if both ends are the same point.
    pub fn line(&mut self, from: Vec2, to: Vec2, thickness: f32, colour: Vec3, alpha: f32) {
        let reach = Vec2::splat(thickness + 1.0);
        let size = Vec2::new(self.width as f32, self.height as f32);
        let lo = (from.min(to) - reach).clamp(Vec2::ZERO, size).to_array().map(|v| v as i32);
        let hi = (from.max(to) + reach).clamp(Vec2::ZERO, size).to_array().map(|v| v as i32);
        let along = to - from;
        for y in lo[1]..hi[1] {
            for x in lo[0]..hi[0] {
                let p = Vec2::new(x as f32, y as f32) + 0.5 - from;
                let t = (p.dot(along) / along.length_squared().max(1e-6)).clamp(0.0, 1.0);
                let distance = (p - along * t).length();
                self.blend(x, y, colour, alpha * (thickness / 2.0 + 0.5 - distance).clamp(0.0, 1.0));
            }
        }
    }

    /// Text on a dark strip; each run has its own colour.
    pub fn label(&mut self, x: i32, y: i32, runs: &[(&str, Vec3)]) {
        let advance = get_raster_width(FontWeight::Regular, TEXT) as i32;
        let letters: i32 = runs.iter().map(|(text, _)| text.chars().count() as i32).sum();
        for row in y - 4..y + TEXT.val() as i32 + 4 {
            for column in x - 8..x + letters * advance + 8 {
                self.blend(column, row, Vec3::new(0.04, 0.05, 0.06), 0.72);
            }
        }
        let mut x = x;
        for (text, colour) in runs {
            for letter in text.chars() {
                let raster = get_raster(letter, FontWeight::Bold, TEXT);
                for (row, line) in raster.iter().flat_map(|r| r.raster().iter().enumerate()) {
                    for (column, &alpha) in line.iter().enumerate() {
                        self.blend(x + column as i32, y + row as i32, *colour, f32::from(alpha) / 255.0);
                    }
                }
                x += advance;
            }
        }
    }

    pub fn save(&self, path: &Path) -> Result<()> {
        let file = File::create(path).map_err(|e| format!("cannot write {}: {e}", path.display()))?;
        self.write_png(BufWriter::new(file))
    }

    pub fn write_png(&self, out: impl Write) -> Result<()> {
        let mut encoder = png::Encoder::new(out, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::High);
        let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
        let bytes: Vec<u8> = self.pixels.iter().flat_map(|p| p.to_array().map(byte)).collect();
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        Ok(())
    }
}
