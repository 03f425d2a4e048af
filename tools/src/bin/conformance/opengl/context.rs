//! An OpenGL context on an EGL device, without a window or a surface.

use std::error::Error;
use std::ffi::c_void;

use khronos_egl as egl;

type Egl = egl::DynamicInstance<egl::EGL1_5>;

/// EGL_PLATFORM_DEVICE_EXT
const DEVICES: egl::Enum = 0x313F;
/// eglQueryDevicesEXT: capacity, array of devices, their number.
type QueryDevices = unsafe extern "system" fn(egl::Int, *mut *mut c_void, *mut egl::Int) -> egl::Boolean;

/// A context that is current on this thread.
pub struct Context {
    egl: Egl,
    display: egl::Display,
    context: egl::Context,
    pub gl: glow::Context,
    /// glLogicOp, which glow omits because OpenGL ES does not have it.
    pub logic_op: unsafe extern "system" fn(u32),
    pub name: String,
}

impl Context {
    /// The device whose renderer's name contains `part`; without `part`, a graphics card in preference to software.
    pub fn open(part: Option<&str>) -> Result<Self, Box<dyn Error>> {
        let mut seen = Vec::new();
        for index in 0.. {
            match Self::on_device(index) {
                Ok(None) => break,
                Ok(Some(context)) => seen.push((index, context.name.to_lowercase())),
                // Cards without a driver are listed as devices, too.
                Err(why) => seen.push((index, why.to_string())),
            }
        }
        let wanted = |name: &str| name.contains("opengl") && part.is_none_or(|p| name.contains(&p.to_lowercase()));
        let software = |name: &str| ["llvmpipe", "softpipe", "swrast"].iter().any(|s| name.contains(s));
        let best = seen.iter().filter(|(_, name)| wanted(name)).min_by_key(|(_, name)| software(name));
        let &(index, _) = best.ok_or_else(|| format!("no matching OpenGL device; available: {seen:?}"))?;
        Self::on_device(index)?.ok_or_else(|| "the device is gone".into())
    }

    /// A context on the device with that number, if it exists.
    fn on_device(index: usize) -> Result<Option<Self>, Box<dyn Error>> {
        // SAFETY: the system's libEGL is what its name says.
        let egl = unsafe { Egl::load_required()? };
        let query = egl.get_proc_address("eglQueryDevicesEXT").ok_or("EGL has no list of devices")?;
        // SAFETY: the extension gives the function this type.
        let query: QueryDevices = unsafe { std::mem::transmute(query) };
        let mut devices = [std::ptr::null_mut(); 64];
        let mut count = 0;
        // SAFETY: there is room for as many devices as stated.
        if unsafe { query(devices.len() as egl::Int, devices.as_mut_ptr(), &mut count) } != egl::TRUE {
            return Err("EGL does not list its devices".into());
        }
        if index >= count as usize {
            return Ok(None);
        }
        // SAFETY: the device is one that EGL has just named.
        let display = unsafe { egl.get_platform_display(DEVICES, devices[index], &[egl::ATTRIB_NONE])? };
        egl.initialize(display)?;
        egl.bind_api(egl::OPENGL_API)?;
        let config = egl
            .choose_first_config(display, &[egl::SURFACE_TYPE, 0, egl::RENDERABLE_TYPE, egl::OPENGL_BIT, egl::NONE])?
            .ok_or("no configuration for OpenGL")?;
        let version = [
            egl::CONTEXT_MAJOR_VERSION,
            4,
            egl::CONTEXT_MINOR_VERSION,
            1,
            egl::CONTEXT_OPENGL_PROFILE_MASK,
            egl::CONTEXT_OPENGL_CORE_PROFILE_BIT,
            egl::NONE,
        ];
        let context = egl.create_context(display, config, None, &version)?;
        egl.make_current(display, None, None, Some(context))?;
        let logic_op = egl.get_proc_address("glLogicOp").ok_or("OpenGL without glLogicOp")?;
        // SAFETY: OpenGL gives the function this type.
        let logic_op = unsafe { std::mem::transmute::<extern "system" fn(), unsafe extern "system" fn(u32)>(logic_op) };
        let address = |name: &str| egl.get_proc_address(name).map_or(std::ptr::null(), |f| f as *const c_void);
        // SAFETY: the context is current, and the functions are its.
        let gl = unsafe { glow::Context::from_loader_function(address) };
        let name = describe(&gl);
        Ok(Some(Self { egl, display, context, gl, logic_op, name }))
    }
}

fn describe(gl: &glow::Context) -> String {
    use glow::HasContext;
    // SAFETY: the context is current.
    unsafe { format!("{}, OpenGL {}", gl.get_parameter_string(glow::RENDERER), gl.get_parameter_string(glow::VERSION)) }
}

impl Drop for Context {
    fn drop(&mut self) {
        // Failures here cannot be handled. The display is not terminated, because other code of this process may share
        // it.
        let _ = self.egl.make_current(self.display, None, None, None);
        let _ = self.egl.destroy_context(self.display, self.context);
    }
}
