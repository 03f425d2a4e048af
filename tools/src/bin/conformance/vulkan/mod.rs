//! Vulkan: a viewport of positive height, where clip space and rows run down as in Direct3D.

mod device;
mod memory;
mod pipeline;
mod target;

use std::error::Error;
use std::rc::Rc;

use masked_occlusion_culling::YAxis;

use crate::driver::{Driver, Vertices};
use crate::view::View;
use device::Gpu;
use pipeline::Pipeline;
use target::Target;

/// Dropped in the order of the fields: objects created from the device first.
pub struct Vulkan {
    target: Option<Target>,
    pipeline: Pipeline,
    gpu: Rc<Gpu>,
}

impl Vulkan {
    pub fn open(part: Option<&str>) -> Result<Self, Box<dyn Error>> {
        let gpu = Rc::new(Gpu::open(part)?);
        let pipeline = Pipeline::new(&gpu.device)?;
        Ok(Self { target: None, pipeline, gpu })
    }
}

impl Driver for Vulkan {
    fn name(&self) -> &str {
        &self.gpu.name
    }

    fn api(&self) -> (&'static str, YAxis) {
        ("Vulkan", YAxis::Down)
    }

    fn subpixel_bits(&self) -> u32 {
        self.gpu.limits.sub_pixel_precision_bits
    }

    fn most_side(&self) -> u32 {
        let limits = &self.gpu.limits;
        // The viewport extends beyond the screen by half its side.
        let beyond = limits.viewport_bounds_range[1].min(-limits.viewport_bounds_range[0]) as u32;
        let [width, height] = limits.max_viewport_dimensions;
        width.min(height).min(beyond).min(limits.max_framebuffer_width).min(limits.max_framebuffer_height)
    }

    fn set_view(&mut self, view: View) -> Result<(), Box<dyn Error>> {
        self.target = None;
        self.target = Some(Target::new(&self.gpu, &self.pipeline, view)?);
        Ok(())
    }

    fn draw(&mut self, vertices: &Vertices) -> Result<(), Box<dyn Error>> {
        let bytes: Vec<u8> = vertices.as_flattened().iter().flat_map(|v| v.to_ne_bytes()).collect();
        self.target.as_mut().ok_or("no screen was set")?.draw(&bytes)?;
        Ok(())
    }

    fn read(&mut self) -> Result<&[u8], Box<dyn Error>> {
        Ok(self.target.as_mut().ok_or("no screen was set")?.read()?)
    }
}
