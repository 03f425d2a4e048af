//! The resources of one screen: the image, the buffer that it is copied to, and the commands, recorded once.

use std::error::Error;
use std::rc::Rc;

use ash::vk;

use super::device::Gpu;
use super::memory::{Buffer, Image};
use super::pipeline::{FORMAT, Pipeline};
use crate::driver::{BATCH, WORDS};
use crate::view::View;

pub struct Target {
    gpu: Rc<Gpu>,
    /// Drawn into and read by the commands.
    image: Image,
    vertices: Buffer,
    pixels: Buffer,
    framebuffer: vk::Framebuffer,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    /// Whether the fence has yet to be waited for.
    under_way: bool,
}

impl Target {
    pub fn new(gpu: &Rc<Gpu>, pipeline: &Pipeline, view: View) -> Result<Self, Box<dyn Error>> {
        let extent = vk::Extent2D { width: view.width as u32, height: view.height as u32 };
        let image = Image::new(gpu, FORMAT, extent)?;
        let vertices = Buffer::new(gpu, BATCH * 3 * 16, vk::BufferUsageFlags::VERTEX_BUFFER)?;
        let pixels = Buffer::new(gpu, view.pixels() * WORDS * 4, vk::BufferUsageFlags::TRANSFER_DST)?;
        let views = [image.view];
        let info = vk::FramebufferCreateInfo::default()
            .render_pass(pipeline.pass)
            .attachments(&views)
            .width(extent.width)
            .height(extent.height)
            .layers(1);
        // SAFETY: the device is alive, and every handle is one of its.
        unsafe {
            let device = &gpu.device;
            let framebuffer = device.create_framebuffer(&info, None)?;
            let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.family);
            let pool = device.create_command_pool(&info, None)?;
            let info = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = device.allocate_command_buffers(&info)?[0];
            let fence = device.create_fence(&vk::FenceCreateInfo::default(), None)?;
            let target = Self {
                gpu: Rc::clone(gpu),
                image,
                vertices,
                pixels,
                framebuffer,
                pool,
                commands,
                fence,
                under_way: false,
            };
            target.record(pipeline, view, extent)?;
            Ok(target)
        }
    }

    /// Records: clear, draw the batch, copy the image to the buffer.
    ///
    /// # Safety
    /// The commands are not being executed.
    unsafe fn record(&self, pipeline: &Pipeline, view: View, extent: vk::Extent2D) -> Result<(), vk::Result> {
        let (x, y) = view.corner();
        let side = view.side as f32;
        // A positive height: rows run down, as in Direct3D.
        let viewport =
            vk::Viewport { x: x as f32, y: y as f32, width: side, height: side, min_depth: 0.0, max_depth: 1.0 };
        let screen = vk::Rect2D { offset: vk::Offset2D::default(), extent };
        let empty = [vk::ClearValue { color: vk::ClearColorValue { uint32: [0; WORDS] } }];
        let pass = vk::RenderPassBeginInfo::default()
            .render_pass(pipeline.pass)
            .framebuffer(self.framebuffer)
            .render_area(screen)
            .clear_values(&empty);
        let whole = vk::BufferImageCopy::default()
            .image_subresource(vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: 0,
                base_array_layer: 0,
                layer_count: 1,
            })
            .image_extent(extent.into());
        let seen = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::HOST_READ);
        let (device, commands) = (&self.gpu.device, self.commands);
        // SAFETY: every handle is of this device and outlives the commands, which this structure owns.
        unsafe {
            device.begin_command_buffer(commands, &vk::CommandBufferBeginInfo::default())?;
            device.cmd_begin_render_pass(commands, &pass, vk::SubpassContents::INLINE);
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, pipeline.pipeline);
            device.cmd_set_viewport(commands, 0, &[viewport]);
            device.cmd_set_scissor(commands, 0, &[screen]);
            device.cmd_bind_vertex_buffers(commands, 0, &[self.vertices.buffer], &[0]);
            device.cmd_draw(commands, 3 * BATCH as u32, 1, 0, 0);
            device.cmd_end_render_pass(commands);
            device.cmd_copy_image_to_buffer(
                commands,
                self.image.image,
                vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
                self.pixels.buffer,
                &[whole],
            );
            let (from, to) = (vk::PipelineStageFlags::TRANSFER, vk::PipelineStageFlags::HOST);
            device.cmd_pipeline_barrier(commands, from, to, vk::DependencyFlags::empty(), &[seen], &[], &[]);
            device.end_command_buffer(commands)
        }
    }

    pub fn draw(&mut self, vertices: &[u8]) -> Result<(), vk::Result> {
        self.wait()?;
        let commands = [self.commands];
        let work = vk::SubmitInfo::default().command_buffers(&commands);
        // SAFETY: the previous submission is complete, so nobody reads the vertices; the handles are this structure's.
        unsafe {
            self.vertices.write(vertices);
            self.gpu.device.queue_submit(self.gpu.queue, &[work], self.fence)?;
        }
        self.under_way = true;
        Ok(())
    }

    pub fn read(&mut self) -> Result<&[u8], vk::Result> {
        self.wait()?;
        // SAFETY: the device has finished, and drawing again needs exclusive access to this structure.
        Ok(unsafe { self.pixels.bytes() })
    }

    fn wait(&mut self) -> Result<(), vk::Result> {
        if self.under_way {
            // SAFETY: the fence is this structure's and was submitted.
            unsafe {
                self.gpu.device.wait_for_fences(&[self.fence], true, u64::MAX)?;
                self.gpu.device.reset_fences(&[self.fence])?;
            }
            self.under_way = false;
        }
        Ok(())
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        // SAFETY: the device was waited for, so none of this is in use.
        unsafe {
            // A lost device uses nothing, either.
            let _ = self.gpu.device.device_wait_idle();
            self.gpu.device.destroy_fence(self.fence, None);
            self.gpu.device.destroy_command_pool(self.pool, None);
            self.gpu.device.destroy_framebuffer(self.framebuffer, None);
        }
    }
}
