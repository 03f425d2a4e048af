//! The arguments that describe a mesh, converted from C's form to the kernel's.

use core::ffi::c_void;

use super::messages::doubt;
use super::pointers::{read, read_size, slice};
use super::refusal::{Because, Refusal};
use super::status::MOC_Status;
use super::types::{self, MOC_VertexLayout};
use crate::source::Mesh;
use crate::vertices::{VertexSource, vertex_count};
use crate::{DrawOptions, MaskedOcclusionCulling, VertexLayout};

/// The `vertex_count` of a MOC_Mesh whose number of vertices is unknown: its indices are trusted.
pub const MOC_UNCHECKED: u32 = 0xffff_ffff;

/// Triangles to be drawn, tested, binned or recorded. Zero the struct, then set `size` and the fields that the mesh
/// needs.
///
/// Every vertex below `vertex_count` must be readable: its x, y and w (or z), and for vertices of 12 or 16 bytes with y
/// at 4 and w (or z) at 8 or 12, also everything in between. With MOC_UNCHECKED this applies to every vertex from the
/// lowest to the highest index, whether or not an index refers to it.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_Mesh {
    /// sizeof(MOC_Mesh).
    pub size: u32,
    /// Size of an index in bytes: 4, or 0, which also means 4.
    pub index_size: u32,
    /// The x of the first vertex, at any address. Null is allowed when there are no triangles.
    pub vertices: *const f32,
    /// The indices, `uint32_t`, three per triangle. Null is allowed when there are no triangles.
    pub indices: *const c_void,
    /// Number of vertices: a mesh with an index that is not below it is refused. MOC_UNCHECKED: indices are trusted.
    pub vertex_count: u32,
    /// Number of triangles, 0 to INT32_MAX.
    pub triangle_count: u32,
    /// 16 floats, as in MOC_RenderTriangles. Null: the vertices are in clip space.
    pub model_to_clip: *const f32,
    /// Where the coordinates are. Null: packed x, y, z with a matrix (unlike in MOC_RenderTriangles), packed x, y, z, w
    /// without one. The last offset is that of z with a matrix, of w without one. Offsets may be negative.
    pub layout: *const MOC_VertexLayout,
    /// A MOC_BackfaceWinding, of the triangle as seen on the screen. Zero is MOC_BACKFACE_NONE: both sides are drawn.
    pub winding: i32,
    /// MOC_ClipPlanes. MOC_CLIP_PLANE_ALL is always correct; zero is MOC_CLIP_PLANE_NONE.
    pub clip_planes: i32,
}

/// A caller's description of a mesh.
pub(super) trait Describe {
    /// # Safety
    /// Each pointer is null or can be read to the extent that the description states.
    unsafe fn describe(&self) -> Result<Description, Refusal>;

    /// Checks everything that can be checked.
    ///
    /// # Safety
    /// Each pointer is null or can be read: all of the indices, the matrix for 16 floats, and the vertices up to their
    /// stated number or, without one, from the lowest to the highest index.
    #[inline(always)]
    unsafe fn check<'a>(&self, moc: &MaskedOcclusionCulling) -> Result<CheckedMesh<'a>, Refusal> {
        // SAFETY: the caller's contract.
        unsafe { self.describe()?.check(moc) }
    }
}

/// How many vertices can be read.
enum Extent {
    /// All that the indices refer to.
    Trusted,
    /// As many as fit in this number of floats from the first x.
    Floats(usize),
    /// This number.
    Vertices(usize),
}

/// A mesh from either of the two C forms.
pub(super) struct Description {
    vertices: *const f32,
    extent: Extent,
    triangles: *const u32,
    indices: usize,
    model_to_clip: *const f32,
    winding: i32,
    clip_planes: i32,
    layout: VertexLayout,
    /// The names of the arguments, for messages.
    names: &'static Names,
}

struct Names {
    no_triangles: &'static str,
    misaligned: &'static str,
    too_many: &'static str,
    out_of_range: &'static str,
}

/// The arguments of a draw, a query or a binning call, passed one by one.
pub(super) struct MeshArguments {
    pub vertices: *const f32,
    /// Number of floats from `vertices` on, if the caller stated it.
    pub vertex_floats: Option<usize>,
    pub triangles: *const u32,
    pub n_triangles: i32,
    pub model_to_clip: *const f32,
    pub winding: i32,
    pub clip_planes: i32,
    pub layout: *const MOC_VertexLayout,
}

impl Describe for MeshArguments {
    // Inlined: a description that goes through memory is measurable in small calls.
    #[inline(always)]
    unsafe fn describe(&self) -> Result<Description, Refusal> {
        const COUNT: Refusal = Refusal::new(
            MOC_Status::MOC_STATUS_INVALID_SIZE,
            "n_triangles is negative, or larger than memory can hold",
        );
        const NAMES: Names = Names {
            no_triangles: "triangles is null",
            misaligned: "triangles is not aligned to 4 bytes",
            too_many: "n_triangles is larger than memory can hold",
            out_of_range: "triangles has an index whose vertex is not within vertex_floats",
        };
        let count = usize::try_from(self.n_triangles).map_err(|_| COUNT)?;
        Ok(Description {
            vertices: self.vertices,
            extent: self.vertex_floats.map_or(Extent::Trusted, Extent::Floats),
            triangles: self.triangles,
            indices: count.checked_mul(3).ok_or(COUNT)?,
            model_to_clip: self.model_to_clip,
            winding: self.winding,
            clip_planes: self.clip_planes,
            // SAFETY: the caller's contract.
            layout: unsafe { read(self.layout) }.map_or(VertexLayout::CLIP_SPACE, VertexLayout::from),
            names: &NAMES,
        })
    }
}

impl Describe for *const MOC_Mesh {
    #[inline(always)]
    unsafe fn describe(&self) -> Result<Description, Refusal> {
        const NAMES: Names = Names {
            no_triangles: "indices is null",
            misaligned: "indices is not aligned to 4 bytes",
            too_many: "triangle_count is larger than memory can hold",
            out_of_range: "an index is not below vertex_count",
        };
        const NULL: Refusal = Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "the mesh is null");
        const SIZE: Refusal = Refusal::new(MOC_Status::MOC_STATUS_INVALID_SIZE, "size is less than sizeof(MOC_Mesh)");
        const COUNT: Refusal = Refusal::new(
            MOC_Status::MOC_STATUS_INVALID_SIZE,
            "triangle_count is above 2147483647, or larger than memory can hold",
        );
        const INDEX: Refusal = Refusal::new(MOC_Status::MOC_STATUS_INVALID_ENUM, "index_size is neither 4 nor 0");
        // SAFETY: the caller's contract. The size is the first field, and nothing beyond it is read.
        if unsafe { read_size(*self) }.ok_or(NULL)? < size_of::<MOC_Mesh>() {
            return Err(SIZE);
        }
        // SAFETY: not null, and large enough according to its `size`; the caller's contract.
        let mesh = unsafe { read(*self) }.ok_or(NULL)?;
        if !matches!(mesh.index_size, 0 | 4) {
            return Err(INDEX);
        }
        let count = usize::try_from(mesh.triangle_count as i32).map_err(|_| COUNT)?;
        let packed = if mesh.model_to_clip.is_null() { VertexLayout::CLIP_SPACE } else { VertexLayout::POSITIONS };
        Ok(Description {
            vertices: mesh.vertices,
            extent: match mesh.vertex_count {
                MOC_UNCHECKED => Extent::Trusted,
                count => Extent::Vertices(count as usize),
            },
            triangles: mesh.indices.cast(),
            indices: count.checked_mul(3).ok_or(COUNT)?,
            model_to_clip: mesh.model_to_clip,
            winding: mesh.winding,
            clip_planes: mesh.clip_planes,
            // SAFETY: the caller's contract.
            layout: unsafe { read(mesh.layout) }.map_or(packed, VertexLayout::from),
            names: &NAMES,
        })
    }
}

impl Description {
    /// # Safety
    /// As [`Describe::check`].
    #[inline(always)]
    unsafe fn check<'a>(self, moc: &MaskedOcclusionCulling) -> Result<CheckedMesh<'a>, Refusal> {
        const STRIDE: Refusal =
            Refusal::new(MOC_Status::MOC_STATUS_INVALID_LAYOUT, "the stride of the vertex layout is negative");
        let Self { layout, names, .. } = self;
        if self.indices > 0 && self.vertices.is_null() {
            return Err(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "vertices is null"));
        }
        if layout.stride < 0 {
            return Err(STRIDE);
        }
        // SAFETY: the caller's contract.
        let matrix = unsafe { read(self.model_to_clip.cast::<[f32; 16]>()) };
        let options =
            DrawOptions { winding: types::winding(self.winding)?, clip_planes: types::clip_planes(self.clip_planes)? };
        // SAFETY: the caller's contract.
        let triangles = unsafe { slice(self.triangles, self.indices) }
            .because(MOC_Status::MOC_STATUS_NULL_POINTER, names.no_triangles)
            .because(MOC_Status::MOC_STATUS_INVALID_LAYOUT, names.misaligned)
            .because(MOC_Status::MOC_STATUS_INVALID_SIZE, names.too_many)?;
        let vertices = match self.extent {
            Extent::Trusted => None,
            Extent::Vertices(count) => Some(count),
            Extent::Floats(floats) => Some(
                vertex_count(floats.saturating_mul(size_of::<f32>()), layout)
                    .because(MOC_Status::MOC_STATUS_INVALID_LAYOUT, "an offset of the vertex layout is negative")?,
            ),
        };
        if let Some(vertices) = vertices {
            moc.check_indices(triangles, vertices)
                .because(MOC_Status::MOC_STATUS_INDEX_OUT_OF_RANGE, names.out_of_range)?;
        }
        doubt(|| {
            (matrix.is_some() && layout == VertexLayout::CLIP_SPACE).then_some(
                "a matrix with the layout (16, 4, 12), whose last offset then names z: x, y, z, w packed is (16, 4, 8)",
            )
        });
        let vertices = VertexSource { base: self.vertices.cast(), layout };
        Ok(CheckedMesh { vertices, triangles, matrix, options })
    }
}

/// A mesh that has passed every check that can be made.
pub(super) struct CheckedMesh<'a> {
    vertices: VertexSource,
    triangles: &'a [u32],
    matrix: Option<[f32; 16]>,
    options: DrawOptions,
}

impl CheckedMesh<'_> {
    #[inline(always)]
    pub fn mesh(&self) -> Mesh<'_> {
        let Self { vertices, triangles, matrix, options } = self;
        // SAFETY: by the contract of `Describe::check`, the vertices from the lowest to the highest index can be read.
        unsafe { Mesh::new(*vertices, matrix.as_ref(), triangles, options) }
    }
}
