//! The enumerations and structs of the C interface, and their conversions to the types of the Rust API.

use core::ffi::c_void;

use super::refusal::Refusal;
use super::status::MOC_Status;
use crate::{
    BackfaceWinding, ClipPlanes, CullingResult, Implementation, ScissorRect, Statistics, TriList, UpdateRule,
    VertexLayout, YAxis,
};

/// An instruction set that the library is compiled for. All of them give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MOC_Implementation {
    /// Plain code without explicit vector instructions, for targets that have none. Elsewhere it is left out, and the
    /// simplest instruction set takes its place.
    MOC_SCALAR = -1,
    /// SSE2, the baseline of x86-64 and i686.
    MOC_SSE2 = 0,
    /// SSE4.1 (with SSSE3's byte shuffle).
    MOC_SSE41 = 1,
    /// AVX2.
    MOC_AVX2 = 2,
    /// AVX-512 F, BW, DQ and VL.
    MOC_AVX512 = 3,
    /// aarch64's Advanced SIMD.
    MOC_NEON = 16,
    /// WebAssembly's 128-bit SIMD, in modules compiled with it.
    MOC_SIMD128 = 17,
}

/// How a triangle is recorded in a sub-tile. Every rule is conservative; they differ in how much information they keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MOC_UpdateRule {
    /// One reference depth and two working layers: accurate in nearly every scene and order. The default.
    MOC_UPDATE_RULE_THREE_LAYER = 0,
    /// Hasselgren, Andersson, Akenine-Moller: "Masked Software Occlusion Culling", 2016.
    MOC_UPDATE_RULE_QUICK = 1,
    /// After Andersson, Hasselgren, Akenine-Moller: "Masked Depth Culling for Graphics Hardware", 2015.
    MOC_UPDATE_RULE_ACCURATE = 2,
    /// One reference depth and three working layers: the most accurate rule, and the slowest. It pays off for dense
    /// geometry that is drawn unsorted.
    MOC_UPDATE_RULE_FOUR_LAYER = 3,
}

/// The direction in which screen rows are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MOC_YAxis {
    /// Row 0 is the top of the screen (Direct3D, Vulkan, Metal). The default.
    MOC_Y_AXIS_DOWN = 0,
    /// Row 0 is the bottom of the screen (OpenGL).
    MOC_Y_AXIS_UP = 1,
}

/// Which triangles are back-facing and skipped, by their winding in normalised device coordinates (y up).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MOC_BackfaceWinding {
    /// None: both sides are drawn.
    MOC_BACKFACE_NONE = 0,
    /// Clockwise triangles are back-facing.
    MOC_BACKFACE_CW = 1,
    /// Counter-clockwise triangles are back-facing.
    MOC_BACKFACE_CCW = 2,
}

/// The result of a draw or a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MOC_CullingResult {
    /// It may be visible.
    MOC_VISIBLE = 0,
    /// It is certainly hidden by what was drawn.
    MOC_OCCLUDED = 1,
    /// It is outside the view, or back-facing.
    MOC_VIEW_CULLED = 3,
}

/// The frustum planes that a mesh may cross: flags, to be combined with `|`.
///
/// Only MOC_CLIP_PLANE_NEAR has an effect: without it the object's near plane is not applied (geometry behind the eye
/// is always clipped). Omitting a side plane does not promise that the mesh stays inside it: it is always safe, and
/// never faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MOC_ClipPlanes {
    /// No plane.
    MOC_CLIP_PLANE_NONE = 0x00,
    /// The near plane of MOC_SetNearClipPlane.
    MOC_CLIP_PLANE_NEAR = 0x01,
    /// x = -w.
    MOC_CLIP_PLANE_LEFT = 0x02,
    /// x = w.
    MOC_CLIP_PLANE_RIGHT = 0x04,
    /// y = -w.
    MOC_CLIP_PLANE_BOTTOM = 0x08,
    /// y = w.
    MOC_CLIP_PLANE_TOP = 0x10,
    /// The four side planes.
    MOC_CLIP_PLANE_SIDES = 0x1e,
    /// All five.
    MOC_CLIP_PLANE_ALL = 0x1f,
}

/// Allocates `size` bytes aligned to `alignment` (a power of two; `size` is a multiple of it, as C11's aligned_alloc
/// requires). Returns null if there is no memory. Memory that is not aligned to `alignment` is freed and treated as an
/// allocation failure. Called from any thread that uses the object; must not throw, and must not use the object or the
/// pool that draws into it.
pub type MOC_AlignedAlloc = Option<unsafe extern "C" fn(alignment: usize, size: usize) -> *mut c_void>;

/// Frees memory allocated by the MOC_AlignedAlloc of the same object. Called from any thread; must not throw.
pub type MOC_AlignedFree = Option<unsafe extern "C" fn(ptr: *mut c_void)>;

/// Calls `alloc(alignment, size)` and returns its result, for languages whose allocators throw: no exception may
/// enter the library, so this function catches it and returns null. It is called wherever `alloc` would be.
pub type MOC_CallAlloc =
    Option<unsafe extern "C" fn(alloc: MOC_AlignedAlloc, alignment: usize, size: usize) -> *mut c_void>;

/// Settings of an object, fixed at creation. Set `size`, let MOC_DefaultSettings fill in the rest, then change what
/// should differ.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_Settings {
    /// sizeof(MOC_Settings).
    pub size: u32,
    /// A MOC_Implementation: the highest instruction set that may be used. Default MOC_AVX512. If it belongs to another
    /// architecture, it allows the best available.
    pub implementation: i32,
    /// A MOC_UpdateRule that the library was compiled with (by default all). Default MOC_UPDATE_RULE_THREE_LAYER.
    pub update_rule: i32,
    /// A MOC_YAxis. Default MOC_Y_AXIS_DOWN.
    pub y_axis: i32,
    /// 0 or 1. 1: draws and queries are counted for MOC_GetStatistics, which makes draws about a tenth slower. 0: only
    /// dropped triangles are counted (MOC_GetDroppedTriangles). Default 0.
    pub statistics: i32,
    /// Allocates the memory of the object and its buffer; recordings and pools use the system's allocator. Null,
    /// together with `free`: the system's allocator. Default null.
    pub alloc: MOC_AlignedAlloc,
    /// Frees the memory that `alloc` returned. Null if and only if `alloc` is.
    pub free: MOC_AlignedFree,
    /// Calls `alloc` for the library, for allocators that throw. Null: the library calls `alloc` directly. Ignored if
    /// `alloc` is null. Default null.
    pub call_alloc: MOC_CallAlloc,
}

/// Where x, y and w (with a matrix: x, y and z) of a vertex are stored, in bytes.
///
/// Packed x, y, z, w is (16, 4, 12) without a matrix and (16, 4, 8) with one; packed x, y, z with a matrix is (12, 4,
/// 8); a structure of arrays of n vertices is (4, 4 * n, 8 * n); positions inside a larger vertex are (sizeof(vertex),
/// 4, 8) with a matrix, and a pointer to the first x. No alignment is required. Offsets may be negative, except for the
/// functions whose names end in Checked.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_VertexLayout {
    /// Bytes from one vertex to the next; not negative.
    pub stride: i32,
    /// Bytes from x to y.
    pub offset_y: i32,
    /// Bytes from x to w; with a matrix, to z.
    pub offset_zw: i32,
}

/// A rectangle of pixels: `min` inclusive, `max` exclusive. x is in multiples of 32, y of 8; a `max` may also be the
/// width or height of the buffer, as is or rounded up to whole tiles. Rows are counted in the object's y direction.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_ScissorRect {
    /// First column.
    pub min_x: i32,
    /// First row.
    pub min_y: i32,
    /// Column after the last.
    pub max_x: i32,
    /// Row after the last.
    pub max_y: i32,
}

/// A list of projected triangles in memory that the caller owns. MOC_BinTriangles appends to it, and MOC_RenderTrilist
/// draws it.
#[derive(Debug)]
#[repr(C)]
pub struct MOC_TriList {
    /// Number of triangles for which `data` has room.
    pub capacity: u32,
    /// Number of triangles in the list. Set it to 0 to start over.
    pub count: u32,
    /// 9 floats per triangle, in a form meant only for MOC_RenderTrilist: x and y in 1/256 pixel, and 1/w, of the three
    /// corners.
    pub data: *mut f32,
}

/// Statistics of all draws since the object was created.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_OccluderStatistics {
    /// Triangles submitted to be drawn or binned, and those of drawn lists.
    pub num_processed_triangles: i64,
    /// Those that are front-facing and whose bounds contain a pixel centre on the screen: counted when they are binned,
    /// and again for each list that is drawn.
    pub num_rasterized_triangles: i64,
    /// 32x8 tiles in the bounds of such triangles when they are drawn; for a list, only tiles inside the rectangle.
    pub num_tiles_traversed: i64,
    /// Tiles in which a triangle changed, or could have changed, a sub-tile.
    pub num_tiles_updated: i64,
    /// Tiles in which a reference depth rose.
    pub num_tiles_merged: i64,
}

/// Statistics of all queries since the object was created.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_OccludeeStatistics {
    /// Rectangles tested.
    pub num_processed_rectangles: i64,
    /// Triangles submitted to be tested (including those after the first visible one).
    pub num_processed_triangles: i64,
    /// Those of them that were compared with the buffer, up to the first that may be visible.
    pub num_rasterized_triangles: i64,
    /// Tiles whose sub-tiles were compared with a rectangle, and those in the bounds of such triangles.
    pub num_tiles_traversed: i64,
}

/// All counts of an object, if its settings enable statistics; otherwise zeros. The same on every instruction set.
/// Dropped triangles are always counted, for MOC_GetDroppedTriangles.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_Statistics {
    /// sizeof(MOC_Statistics).
    pub size: u32,
    /// Always 0.
    pub reserved: u32,
    /// Counts of draws.
    pub occluders: MOC_OccluderStatistics,
    /// Counts of queries.
    pub occludees: MOC_OccludeeStatistics,
}

impl From<MOC_VertexLayout> for VertexLayout {
    fn from(l: MOC_VertexLayout) -> Self {
        Self::new(l.stride, l.offset_y, l.offset_zw)
    }
}

impl From<VertexLayout> for MOC_VertexLayout {
    fn from(l: VertexLayout) -> Self {
        Self { stride: l.stride, offset_y: l.offset_y, offset_zw: l.offset_zw }
    }
}

impl From<MOC_ScissorRect> for ScissorRect {
    fn from(r: MOC_ScissorRect) -> Self {
        Self { min_x: r.min_x, min_y: r.min_y, max_x: r.max_x, max_y: r.max_y }
    }
}

impl MOC_Statistics {
    pub(super) fn new(size: u32, s: Statistics) -> Self {
        Self {
            size,
            reserved: 0,
            occluders: MOC_OccluderStatistics {
                num_processed_triangles: s.occluders.num_processed_triangles,
                num_rasterized_triangles: s.occluders.num_rasterized_triangles,
                num_tiles_traversed: s.occluders.num_tiles_traversed,
                num_tiles_updated: s.occluders.num_tiles_updated,
                num_tiles_merged: s.occluders.num_tiles_merged,
            },
            occludees: MOC_OccludeeStatistics {
                num_processed_rectangles: s.occludees.num_processed_rectangles,
                num_processed_triangles: s.occludees.num_processed_triangles,
                num_rasterized_triangles: s.occludees.num_rasterized_triangles,
                num_tiles_traversed: s.occludees.num_tiles_traversed,
            },
        }
    }
}

// A pointer to a C list is cast to a pointer to a Rust list.
const _: () = {
    assert!(size_of::<MOC_TriList>() == size_of::<TriList<'_>>());
    assert!(align_of::<MOC_TriList>() == align_of::<TriList<'_>>());
    assert!(core::mem::offset_of!(MOC_TriList, capacity) == core::mem::offset_of!(TriList<'_>, capacity));
    assert!(core::mem::offset_of!(MOC_TriList, count) == core::mem::offset_of!(TriList<'_>, len));
    assert!(core::mem::offset_of!(MOC_TriList, data) == core::mem::offset_of!(TriList<'_>, data));
};

// C programs access these fields at fixed offsets.
const _: () = {
    assert!(size_of::<MOC_Statistics>() == 80);
    assert!(core::mem::offset_of!(MOC_Statistics, occluders) == 8);
    assert!(core::mem::offset_of!(MOC_Statistics, occludees) == 48);
    assert!(core::mem::offset_of!(MOC_OccluderStatistics, num_tiles_merged) == 32);
    assert!(core::mem::offset_of!(MOC_OccludeeStatistics, num_tiles_traversed) == 24);
};

// The C enumerators have the same values as the Rust ones.
const _: () = {
    assert!(MOC_Implementation::MOC_SCALAR as i32 == Implementation::Scalar as i32);
    assert!(MOC_Implementation::MOC_SSE2 as i32 == Implementation::Sse2 as i32);
    assert!(MOC_Implementation::MOC_SSE41 as i32 == Implementation::Sse41 as i32);
    assert!(MOC_Implementation::MOC_AVX2 as i32 == Implementation::Avx2 as i32);
    assert!(MOC_Implementation::MOC_AVX512 as i32 == Implementation::Avx512 as i32);
    assert!(MOC_Implementation::MOC_NEON as i32 == Implementation::Neon as i32);
    assert!(MOC_Implementation::MOC_SIMD128 as i32 == Implementation::Simd128 as i32);
    assert!(MOC_UpdateRule::MOC_UPDATE_RULE_THREE_LAYER as i32 == UpdateRule::ThreeLayer as i32);
    assert!(MOC_UpdateRule::MOC_UPDATE_RULE_QUICK as i32 == UpdateRule::Quick as i32);
    assert!(MOC_UpdateRule::MOC_UPDATE_RULE_ACCURATE as i32 == UpdateRule::Accurate as i32);
    assert!(MOC_UpdateRule::MOC_UPDATE_RULE_FOUR_LAYER as i32 == UpdateRule::FourLayer as i32);
    assert!(MOC_YAxis::MOC_Y_AXIS_DOWN as i32 == YAxis::Down as i32);
    assert!(MOC_YAxis::MOC_Y_AXIS_UP as i32 == YAxis::Up as i32);
    assert!(MOC_BackfaceWinding::MOC_BACKFACE_NONE as i32 == BackfaceWinding::None as i32);
    assert!(MOC_BackfaceWinding::MOC_BACKFACE_CW as i32 == BackfaceWinding::Clockwise as i32);
    assert!(MOC_BackfaceWinding::MOC_BACKFACE_CCW as i32 == BackfaceWinding::CounterClockwise as i32);
    assert!(MOC_CullingResult::MOC_VISIBLE as i32 == CullingResult::Visible as i32);
    assert!(MOC_CullingResult::MOC_OCCLUDED as i32 == CullingResult::Occluded as i32);
    assert!(MOC_CullingResult::MOC_VIEW_CULLED as i32 == CullingResult::ViewCulled as i32);
    assert!(MOC_ClipPlanes::MOC_CLIP_PLANE_NEAR as u32 == ClipPlanes::NEAR.bits());
    assert!(MOC_ClipPlanes::MOC_CLIP_PLANE_LEFT as u32 == ClipPlanes::LEFT.bits());
    assert!(MOC_ClipPlanes::MOC_CLIP_PLANE_RIGHT as u32 == ClipPlanes::RIGHT.bits());
    assert!(MOC_ClipPlanes::MOC_CLIP_PLANE_BOTTOM as u32 == ClipPlanes::BOTTOM.bits());
    assert!(MOC_ClipPlanes::MOC_CLIP_PLANE_TOP as u32 == ClipPlanes::TOP.bits());
    assert!(MOC_ClipPlanes::MOC_CLIP_PLANE_SIDES as u32 == ClipPlanes::SIDES.bits());
    assert!(MOC_ClipPlanes::MOC_CLIP_PLANE_ALL as u32 == ClipPlanes::ALL.bits());
};

pub(super) fn implementation(value: i32) -> Result<Implementation, Refusal> {
    Ok(match value {
        -1 => Implementation::Scalar,
        0 => Implementation::Sse2,
        1 => Implementation::Sse41,
        2 => Implementation::Avx2,
        3 => Implementation::Avx512,
        16 => Implementation::Neon,
        17 => Implementation::Simd128,
        _ => {
            return Err(Refusal::new(
                MOC_Status::MOC_STATUS_INVALID_ENUM,
                "implementation is not a MOC_Implementation",
            ));
        }
    })
}

pub(super) fn update_rule(value: i32) -> Result<UpdateRule, Refusal> {
    Ok(match value {
        0 => UpdateRule::ThreeLayer,
        1 => UpdateRule::Quick,
        2 => UpdateRule::Accurate,
        3 => UpdateRule::FourLayer,
        _ => return Err(Refusal::new(MOC_Status::MOC_STATUS_INVALID_ENUM, "update_rule is not a MOC_UpdateRule")),
    })
}

pub(super) fn y_axis(value: i32) -> Result<YAxis, Refusal> {
    Ok(match value {
        0 => YAxis::Down,
        1 => YAxis::Up,
        _ => return Err(Refusal::new(MOC_Status::MOC_STATUS_INVALID_ENUM, "y_axis is not a MOC_YAxis")),
    })
}

pub(super) fn winding(value: i32) -> Result<BackfaceWinding, Refusal> {
    const WHY: Refusal = Refusal::new(MOC_Status::MOC_STATUS_INVALID_ENUM, "winding is not a MOC_BackfaceWinding");
    BackfaceWinding::from_number(value).ok_or(WHY)
}

pub(super) fn culling_result(value: i32) -> Result<CullingResult, Refusal> {
    const WHY: Refusal = Refusal::new(
        MOC_Status::MOC_STATUS_INVALID_ENUM,
        "result is neither a MOC_CullingResult nor MOC_RESULT_UNKNOWN",
    );
    CullingResult::from_number(value).ok_or(WHY)
}

pub(super) fn clip_planes(value: i32) -> Result<ClipPlanes, Refusal> {
    const WHY: Refusal =
        Refusal::new(MOC_Status::MOC_STATUS_INVALID_ENUM, "clip_planes has a bit that is not in MOC_ClipPlanes");
    u32::try_from(value).ok().and_then(ClipPlanes::from_bits).ok_or(WHY)
}

/// 0 or 1; `why` names the argument if it is neither.
pub(super) fn flag(value: i32, why: &'static str) -> Result<bool, Refusal> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        _ => Err(Refusal::new(MOC_Status::MOC_STATUS_INVALID_ENUM, why)),
    }
}
