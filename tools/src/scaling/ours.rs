//! This library, through its C functions, which the C++ class calls: so both libraries trust their indices. The Rust
//! interface checks each one first.

use std::ptr::{null, null_mut};

use glam::Mat4;
use masked_occlusion_culling::MaskedOcclusionCulling;
use masked_occlusion_culling::capi::*;

use super::culler::{Culler, isa_name};
use super::mesh::Mesh;
use crate::Result;
use demo::options::Rule;

const OK: MOC_Status = MOC_Status::MOC_STATUS_OK;

/// An object from MOC_Create.
pub struct Ours {
    moc: *mut MaskedOcclusionCulling,
    rule: Rule,
}

impl Ours {
    pub fn new(rule: Rule, isa: i32) -> Result<Self> {
        let settings = MOC_Settings {
            size: size_of::<MOC_Settings>() as u32,
            implementation: isa,
            update_rule: rule as i32,
            y_axis: 0,
            statistics: 0,
            alloc: None,
            free: None,
            call_alloc: None,
        };
        let mut moc = null_mut();
        // SAFETY: both are there to be read and written, and there are no callbacks.
        match unsafe { MOC_Create(&settings, &mut moc) } {
            OK => Ok(Self { moc, rule }),
            status => Err(format!("this library cannot be used: {status:?}").into()),
        }
    }
}

impl Drop for Ours {
    fn drop(&mut self) {
        // SAFETY: it came from MOC_Create, and is not used afterwards.
        unsafe { MOC_Destroy(self.moc) };
    }
}

impl Culler for Ours {
    fn name(&self) -> String {
        let mut isa = 0;
        // SAFETY: a live object, and a place for the answer.
        unsafe { MOC_GetImplementation(self.moc, &mut isa) };
        format!("ours ({}; {})", self.rule.name(), isa_name(isa))
    }

    fn set_size(&mut self, width: u32, height: u32) -> Result<()> {
        // SAFETY: a live object that nobody else uses.
        match unsafe { MOC_SetResolution(self.moc, width, height) } {
            OK => Ok(()),
            status => Err(format!("no buffer of {width}x{height}: {status:?}").into()),
        }
    }

    fn set_near(&mut self, near: f32) {
        // SAFETY: a live object that nobody else uses.
        unsafe { MOC_SetNearClipPlane(self.moc, near) };
    }

    fn clear(&mut self) {
        // SAFETY: a live object that nobody else uses.
        unsafe { MOC_ClearBuffer(self.moc) };
    }

    fn draw(&mut self, mesh: &Mesh, model_to_clip: &Mat4) {
        // SAFETY: a live object that nobody else uses; a mesh's indices name its vertices, which are 16 bytes with the
        // third coordinate in the last four, as the layout that null stands for has them; the matrix is 16 floats.
        let status = unsafe {
            MOC_RenderTriangles(
                self.moc,
                mesh.vertices().as_flattened().as_ptr(),
                mesh.indices().as_ptr(),
                mesh.triangles() as i32,
                model_to_clip.as_ref().as_ptr(),
                MOC_BackfaceWinding::MOC_BACKFACE_CW as i32,
                MOC_ClipPlanes::MOC_CLIP_PLANE_ALL as i32,
                null(),
                null_mut(),
            )
        };
        assert_eq!(status, OK);
    }

    fn hides(&self, [x_min, y_min, x_max, y_max]: [f32; 4], w: f32) -> bool {
        let mut result = 0;
        // SAFETY: a live object, and a place for the answer.
        unsafe { MOC_TestRect(self.moc, x_min, y_min, x_max, y_max, w, &mut result) };
        result == MOC_CullingResult::MOC_OCCLUDED as i32
    }
}
