//! Meshes as a program may pass them: mostly valid, in every layout, sometimes with a wrong value in any argument.

use std::ptr::null;

use fastrand::Rng;
use masked_occlusion_culling::capi::MOC_VertexLayout;

use crate::episode::Memory;
use crate::family::Family;
use crate::hostile;

/// The arguments of a mesh call.
pub struct Mesh {
    pub vertices: *const f32,
    pub vertex_floats: usize,
    pub triangles: *const u32,
    pub n_triangles: i32,
    pub matrix: *const f32,
    pub winding: i32,
    pub clip_planes: i32,
    pub layout: *const MOC_VertexLayout,
    /// Whether it is passed to the entry point that takes the length of the vertices.
    pub checked: bool,
    /// Whether every vertex that it refers to can be read, even by an entry point that does not take the length.
    pub whole: bool,
    /// Whether it must be refused, if that is known.
    pub refused: Option<bool>,
    /// The generated corners, if known; printed when a check fails.
    pub corners: Vec<[[f32; 3]; 3]>,
}

impl std::fmt::Display for Mesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { n_triangles, winding, clip_planes, checked, .. } = self;
        write!(f, "{n_triangles} triangles, winding {winding}, clip planes {clip_planes:#x}, checked {checked}")?;
        // SAFETY: null or sixteen floats in guarded memory that outlives the call.
        if let Some(matrix) = unsafe { self.matrix.cast::<[f32; 16]>().as_ref() } {
            write!(f, "\nmatrix {matrix:?}")?;
        }
        for corners in self.corners.iter().take(8) {
            write!(f, "\n{corners:?}")?;
        }
        Ok(())
    }
}

/// A mesh for `family`, in guarded memory.
pub fn random(rng: &mut Rng, memory: &mut Memory, family: &Family) -> Mesh {
    let n = match rng.u8(..12) {
        0 => 0,
        1 => rng.usize(200..2000),
        _ => rng.usize(1..40),
    };
    let count = rng.usize(1..200);
    let (width, height) = family.size.unwrap_or((64, 64));
    let positions = hostile::vertices(rng, count, width, height, family.near);
    let any_layout = rng.u8(..8) == 0;
    let kept = hostile::kept_layout(rng, count);
    let (vertices, bytes) = place_vertices(rng, memory, &positions, kept);
    let layout = if any_layout { hostile::layout(rng) } else { kept };
    let default_layout = (layout.stride, layout.offset_y, layout.offset_zw) == (16, 4, 12);
    let layout_ptr =
        if default_layout && rng.bool() { null() } else { memory.layout.put(&[layout], rng.bool()).cast_const() };

    // Only the length protects against a layout or an index that leaves the array.
    let checked = any_layout || rng.bool();
    let readable = readable_vertices(bytes / 4 * 4, kept);
    let mut indices: Vec<u32> = (0..3 * n).map(|_| rng.u32(..count as u32)).collect();
    if checked && n > 0 && rng.u8(..6) == 0 {
        indices[rng.usize(..3 * n)] = [count as u32, u32::MAX, rng.u32(..), 0x8000_0000][rng.usize(..4)];
    }
    let n_triangles = match rng.u8(..30) {
        0 => [-1, i32::MIN, -1000][rng.usize(..3)],
        1 => rng.i32(0..=n as i32),
        _ => n as i32,
    };
    let used = &indices[..3 * n_triangles.max(0) as usize];
    let in_range = used.iter().all(|&i| (i as usize) < readable);

    let mut mesh = Mesh {
        vertices,
        vertex_floats: bytes / 4,
        triangles: memory.indices.put(&indices, rng.bool()),
        n_triangles,
        matrix: if rng.bool() { null() } else { memory.matrix.put(&hostile::matrix(rng), rng.bool()) },
        winding: hostile::enumeration(rng, &[0, 1, 2]),
        clip_planes: hostile::enumeration(rng, &[0, 1, 0x1e, 0x1f, 0x1f]),
        layout: layout_ptr,
        checked,
        whole: in_range && !any_layout,
        refused: None,
        corners: Vec::new(),
    };
    if in_range && !any_layout {
        let corner = |i: u32| positions[i as usize];
        mesh.corners = used.chunks_exact(3).map(|t| [corner(t[0]), corner(t[1]), corner(t[2])]).collect();
    }
    match rng.u8(..40) {
        0 => mesh.vertices = null(),
        1 => mesh.triangles = null(),
        _ => {}
    }
    let wrong = n_triangles < 0
        || n_triangles > 0 && (mesh.vertices.is_null() || mesh.triangles.is_null())
        || !(0..=2).contains(&mesh.winding)
        || !(0..=0x1f).contains(&mesh.clip_planes)
        || checked && !in_range
        || family.size.is_none();
    if !any_layout {
        mesh.refused = Some(wrong);
    }
    mesh
}

/// The positions in `layout`, with NaN in between; and their size in bytes.
fn place_vertices(
    rng: &mut Rng,
    memory: &mut Memory,
    positions: &[[f32; 3]],
    layout: MOC_VertexLayout,
) -> (*const f32, usize) {
    let (stride, y, zw) = (layout.stride as usize, layout.offset_y as usize, layout.offset_zw as usize);
    let mut bytes = vec![0xff; (positions.len() - 1) * stride + y.max(zw) + 4];
    for (i, position) in positions.iter().enumerate() {
        for (value, offset) in position.iter().zip([0, y, zw]) {
            let at = i * stride + offset;
            bytes[at..at + 4].copy_from_slice(&value.to_ne_bytes());
        }
    }
    (memory.vertices.put(&bytes, rng.bool()).cast_const().cast(), bytes.len())
}

/// Number of vertices of a valid layout that fit in `bytes`.
fn readable_vertices(bytes: usize, layout: MOC_VertexLayout) -> usize {
    let last = layout.offset_y.max(layout.offset_zw) as usize + 4;
    if bytes < last { 0 } else { 1 + (bytes - last) / layout.stride as usize }
}
