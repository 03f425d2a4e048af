//! A second library, behind the functions of other.cpp in a shared object.

use std::error::Error;
use std::ffi::c_void;
use std::path::{Path, absolute};
use std::ptr::NonNull;

use glam::Mat4;
use libloading::Library;

use super::culler::{Culler, isa_name};
use super::mesh::Mesh;
use crate::Result;

type Object = NonNull<c_void>;

/// The functions as other.cpp declares them.
struct Functions {
    create: unsafe extern "C" fn(i32) -> Option<Object>,
    destroy: unsafe extern "C" fn(Object),
    instruction_set: unsafe extern "C" fn(Object) -> i32,
    set_resolution: unsafe extern "C" fn(Object, u32, u32),
    set_near: unsafe extern "C" fn(Object, f32),
    clear: unsafe extern "C" fn(Object),
    render: unsafe extern "C" fn(Object, *const f32, *const u32, i32, *const f32),
    hides: unsafe extern "C" fn(Object, f32, f32, f32, f32, f32) -> i32,
}

/// An object of the other library, which stays loaded as long as there is one.
pub struct Other {
    functions: Functions,
    object: Object,
    _library: Library,
}

impl Other {
    pub fn load(path: &Path, isa: i32) -> Result<Self> {
        // A bare file name would be searched for in the system's library folders.
        let path = absolute(path)?;
        // SAFETY: the user vouches that the file was built from other.cpp.
        let library =
            unsafe { Library::new(&path) }.map_err(|e| format!("cannot load {}: {}", path.display(), reason(&e)))?;
        // SAFETY: the same; each field has the type of the function of that name in other.cpp.
        let functions = unsafe {
            Functions {
                create: function(&library, "scaling_create")?,
                destroy: function(&library, "scaling_destroy")?,
                instruction_set: function(&library, "scaling_instruction_set")?,
                set_resolution: function(&library, "scaling_set_resolution")?,
                set_near: function(&library, "scaling_set_near")?,
                clear: function(&library, "scaling_clear")?,
                render: function(&library, "scaling_render")?,
                hides: function(&library, "scaling_hides")?,
            }
        };
        // SAFETY: any number may be passed.
        let object = unsafe { (functions.create)(isa) }
            .ok_or_else(|| format!("{}: the library makes no object for {}", path.display(), isa_name(isa)))?;
        Ok(Self { functions, object, _library: library })
    }
}

/// # Safety
/// The symbol is a function of type `F`, which is not called once the library is gone.
unsafe fn function<F: Copy>(library: &Library, name: &str) -> Result<F> {
    // SAFETY: the caller's contract.
    let symbol = unsafe { library.get::<F>(name) };
    Ok(*symbol.map_err(|e| format!("was it made of other.cpp? {}", reason(&e)))?)
}

/// The system's message; the error alone names only the call that failed.
fn reason(error: &libloading::Error) -> String {
    error.source().map_or_else(|| error.to_string(), |said| said.to_string())
}

impl Drop for Other {
    fn drop(&mut self) {
        // SAFETY: it came from `create`, and is not used afterwards; the library is unloaded after it.
        unsafe { (self.functions.destroy)(self.object) };
    }
}

impl Culler for Other {
    fn name(&self) -> String {
        // SAFETY: a live object.
        format!("other ({})", isa_name(unsafe { (self.functions.instruction_set)(self.object) }))
    }

    fn set_size(&mut self, width: u32, height: u32) -> Result<()> {
        // SAFETY: a live object that nobody else uses; the sizes are multiples of 8 and 4.
        unsafe { (self.functions.set_resolution)(self.object, width, height) };
        Ok(())
    }

    fn set_near(&mut self, near: f32) {
        // SAFETY: a live object that nobody else uses.
        unsafe { (self.functions.set_near)(self.object, near) };
    }

    fn clear(&mut self) {
        // SAFETY: a live object that nobody else uses, and it has a buffer.
        unsafe { (self.functions.clear)(self.object) };
    }

    fn draw(&mut self, mesh: &Mesh, model_to_clip: &Mat4) {
        let (vertices, indices) = (mesh.vertices().as_flattened().as_ptr(), mesh.indices().as_ptr());
        let matrix = model_to_clip.as_ref().as_ptr();
        // SAFETY: a live object that nobody else uses, and it has a buffer; a mesh's indices name its vertices, which
        // are laid out as other.cpp says; the matrix is 16 floats.
        unsafe { (self.functions.render)(self.object, vertices, indices, mesh.triangles() as i32, matrix) };
    }

    fn hides(&self, [x_min, y_min, x_max, y_max]: [f32; 4], w: f32) -> bool {
        // SAFETY: a live object with a buffer.
        unsafe { (self.functions.hides)(self.object, x_min, y_min, x_max, y_max, w) != 0 }
    }
}

// On other systems a shared object is linked with other arguments.
#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::super::culler::{PROBES, frame, hidden};
    use super::super::ours::Ours;
    use super::super::scene::{lumps, sheets};
    use super::*;
    use demo::native;
    use demo::options::Rule;

    #[test]
    fn our_own_class_behind_other_cpp_draws_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let file = native::build(&native::Program {
            source: &native::root().join("tools/src/scaling/other.cpp"),
            out: folder.path(),
            link: native::Link::Static,
            defines: &[],
            flags: &["-shared", "-fPIC", "-fvisibility=hidden", "-Wl,--exclude-libs,ALL", "-Werror"],
        })
        .unwrap_or_else(|e| panic!("{e}"));
        let mut ours = Ours::new(Rule::ThreeLayer, 3).unwrap();
        let mut other = Other::load(&file, 3).unwrap();
        assert_eq!(ours.name().replace("ours (three layers; ", "other ("), other.name());
        for (scene, all) in [(lumps(), false), (sheets(2, false), true)] {
            let [a, b] = [&mut ours as &mut dyn Culler, &mut other].map(|culler| {
                culler.set_size(320, 180).unwrap();
                culler.set_near(scene.near);
                frame(culler, &scene);
                hidden(culler)
            });
            assert_eq!((a, a == PROBES), (b, all));
        }
    }

    #[test]
    fn what_is_no_such_library_is_refused() {
        let error = Other::load(Path::new("/nowhere/other.so"), 3).err().unwrap().to_string();
        assert!(error.contains("No such file"), "{error}");
    }
}
