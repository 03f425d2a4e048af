//! OpenGL: a framebuffer object under the default clip control, whose origin is at the lower left. Clip space has y up,
//! and row 0 of the pixels read back is the lowest.

mod context;

use std::error::Error;

use glow::HasContext;
use masked_occlusion_culling::YAxis;

use crate::driver::{BATCH, Driver, Vertices, WORDS};
use crate::view::View;
use context::Context;

const CORNER: &str = "#version 410 core
layout(location = 0) in vec4 position;
flat out uint triangle;
void main() {
    gl_Position = position;
    triangle = uint(gl_VertexID) / 3u;
}
";

const PIXEL: &str = "#version 410 core
flat in uint triangle;
layout(location = 0) out uvec4 bits;
void main() {
    bits = uvec4(equal(uvec4(0u, 1u, 2u, 3u), uvec4(triangle / 32u))) << (triangle % 32u);
}
";

pub struct OpenGl {
    context: Context,
    target: Option<glow::Renderbuffer>,
    pixels: Vec<u8>,
    size: (i32, i32),
}

impl OpenGl {
    pub fn open(part: Option<&str>) -> Result<Self, Box<dyn Error>> {
        let context = Context::open(part)?;
        let gl = &context.gl;
        // SAFETY: the context is current on this thread, and stays so.
        unsafe {
            let program = gl.create_program()?;
            for (stage, source) in [(glow::VERTEX_SHADER, CORNER), (glow::FRAGMENT_SHADER, PIXEL)] {
                let shader = gl.create_shader(stage)?;
                gl.shader_source(shader, source);
                gl.compile_shader(shader);
                if !gl.get_shader_compile_status(shader) {
                    return Err(gl.get_shader_info_log(shader).into());
                }
                gl.attach_shader(program, shader);
            }
            gl.link_program(program);
            if !gl.get_program_link_status(program) {
                return Err(gl.get_program_info_log(program).into());
            }
            gl.use_program(Some(program));
            gl.bind_vertex_array(Some(gl.create_vertex_array()?));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(gl.create_buffer()?));
            gl.enable_vertex_attrib_array(0);
            gl.buffer_data_size(glow::ARRAY_BUFFER, size_of::<Vertices>() as i32, glow::STREAM_DRAW);
            gl.vertex_attrib_pointer_f32(0, 4, glow::FLOAT, false, 16, 0);
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(gl.create_framebuffer()?));
            for off in [glow::CULL_FACE, glow::DEPTH_TEST, glow::BLEND, glow::DITHER] {
                gl.disable(off);
            }
            gl.enable(glow::SCISSOR_TEST);
            gl.enable(glow::COLOR_LOGIC_OP);
            (context.logic_op)(glow::XOR);
            gl.pixel_store_i32(glow::PACK_ALIGNMENT, 4);
        }
        let opened = Self { context, target: None, pixels: Vec::new(), size: (0, 0) };
        opened.check()?;
        Ok(opened)
    }

    fn check(&self) -> Result<(), String> {
        // SAFETY: the context is current.
        match unsafe { self.context.gl.get_error() } {
            glow::NO_ERROR => Ok(()),
            error => Err(format!("OpenGL error {error:#x}")),
        }
    }
}

impl Driver for OpenGl {
    fn name(&self) -> &str {
        &self.context.name
    }

    fn api(&self) -> (&'static str, YAxis) {
        ("OpenGL", YAxis::Up)
    }

    fn subpixel_bits(&self) -> u32 {
        // SAFETY: the context is current.
        unsafe { self.context.gl.get_parameter_i32(glow::SUBPIXEL_BITS) as u32 }
    }

    fn most_side(&self) -> u32 {
        let gl = &self.context.gl;
        let (mut dimensions, mut bounds) = ([0; 2], [0.0; 2]);
        // SAFETY: the context is current, and both have two values.
        let texture = unsafe {
            gl.get_parameter_i32_slice(glow::MAX_VIEWPORT_DIMS, &mut dimensions);
            gl.get_parameter_f32_slice(glow::VIEWPORT_BOUNDS_RANGE, &mut bounds);
            gl.get_parameter_i32(glow::MAX_RENDERBUFFER_SIZE)
        };
        let beyond = bounds[1].min(-bounds[0]) as i32;
        dimensions[0].min(dimensions[1]).min(beyond).min(texture).max(0) as u32
    }

    fn set_view(&mut self, view: View) -> Result<(), Box<dyn Error>> {
        let gl = &self.context.gl;
        let (width, height) = (view.width as i32, view.height as i32);
        let (x, y) = view.corner();
        // SAFETY: the context is current; only this structure's own objects are deleted.
        let status = unsafe {
            if let Some(old) = self.target.take() {
                gl.delete_renderbuffer(old);
            }
            let target = gl.create_renderbuffer()?;
            self.target = Some(target);
            gl.bind_renderbuffer(glow::RENDERBUFFER, Some(target));
            gl.renderbuffer_storage(glow::RENDERBUFFER, glow::RGBA32UI, width, height);
            let colour = glow::COLOR_ATTACHMENT0;
            gl.framebuffer_renderbuffer(glow::FRAMEBUFFER, colour, glow::RENDERBUFFER, Some(target));
            gl.viewport(x, y, view.side as i32, view.side as i32);
            gl.scissor(0, 0, width, height);
            gl.check_framebuffer_status(glow::FRAMEBUFFER)
        };
        if status != glow::FRAMEBUFFER_COMPLETE {
            return Err(format!("framebuffer status {status:#x}").into());
        }
        self.size = (width, height);
        self.pixels.resize(view.pixels() * WORDS * 4, 0);
        Ok(self.check()?)
    }

    fn draw(&mut self, vertices: &Vertices) -> Result<(), Box<dyn Error>> {
        let bytes: Vec<u8> = vertices.as_flattened().iter().flat_map(|v| v.to_ne_bytes()).collect();
        let gl = &self.context.gl;
        // SAFETY: the context is current, and the bound buffer holds as many vertices as are drawn.
        unsafe {
            gl.buffer_sub_data_u8_slice(glow::ARRAY_BUFFER, 0, &bytes);
            gl.clear_buffer_u32_slice(glow::COLOR, 0, &[0; WORDS]);
            gl.draw_arrays(glow::TRIANGLES, 0, 3 * BATCH as i32);
            gl.flush();
        }
        Ok(())
    }

    fn read(&mut self) -> Result<&[u8], Box<dyn Error>> {
        let into = glow::PixelPackData::Slice(Some(&mut self.pixels));
        let (format, words) = (glow::RGBA_INTEGER, glow::UNSIGNED_INT);
        // SAFETY: the context is current, and the pixels have room for the whole target.
        unsafe { self.context.gl.read_pixels(0, 0, self.size.0, self.size.1, format, words, into) };
        self.check()?;
        Ok(&self.pixels)
    }
}
