//! The small types of the interface, in the form of Rust and in that of C and C++ (`repr(C)`, with the same values as
//! Intel's class).

/// An instruction set that the kernel is compiled for. All of them give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(i32)]
#[non_exhaustive]
pub enum Implementation {
    /// Plain code without explicit vector instructions, for targets that have none; elsewhere only with the feature
    /// `scalar`.
    Scalar = -1,
    /// SSE2, the baseline of x86-64 and i686.
    Sse2 = 0,
    /// SSE4.1 (with SSSE3's byte shuffle).
    Sse41 = 1,
    /// AVX2.
    Avx2 = 2,
    /// AVX-512 F, BW, DQ and VL.
    Avx512 = 3,
    /// aarch64's Advanced SIMD.
    Neon = 16,
    /// WebAssembly's 128-bit SIMD, in modules compiled with it.
    Simd128 = 17,
}

/// How a triangle is recorded in a sub-tile. Every rule is conservative; they differ in how much information they keep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
#[non_exhaustive]
pub enum UpdateRule {
    /// One reference depth and two working layers (20 bytes per sub-tile): accurate in nearly every scene and order.
    #[default]
    ThreeLayer = 0,
    /// Hasselgren, Andersson, Akenine-Möller: "Masked Software Occlusion Culling", HPG 2016, section 3.2.
    Quick = 1,
    /// After Andersson, Hasselgren, Akenine-Möller: "Masked Depth Culling for Graphics Hardware", 2015.
    Accurate = 2,
    /// One reference depth and three working layers (28 bytes per sub-tile): the most accurate rule, and the slowest.
    /// It pays off for dense geometry that is drawn unsorted.
    FourLayer = 3,
}

impl UpdateRule {
    /// The rules that the library is compiled with.
    pub const fn available() -> &'static [UpdateRule] {
        &[
            Self::ThreeLayer,
            #[cfg(feature = "quick")]
            Self::Quick,
            #[cfg(feature = "accurate")]
            Self::Accurate,
            #[cfg(feature = "four-layer")]
            Self::FourLayer,
        ]
    }
}

/// The direction in which screen rows are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum YAxis {
    /// Row 0 is the top of the screen (Direct3D, Vulkan, Metal).
    #[default]
    Down = 0,
    /// Row 0 is the bottom of the screen (OpenGL).
    Up = 1,
}

/// Which triangles are back-facing and skipped, by their winding in normalised device coordinates (y up).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum BackfaceWinding {
    /// None: both sides are drawn.
    None = 0,
    /// Clockwise triangles are back-facing.
    #[default]
    Clockwise = 1,
    /// Counter-clockwise triangles are back-facing.
    CounterClockwise = 2,
}

impl BackfaceWinding {
    /// The winding for a number from C or a recording.
    pub(crate) fn from_number(n: i32) -> Option<Self> {
        [Self::None, Self::Clockwise, Self::CounterClockwise].into_iter().find(|&winding| winding as i32 == n)
    }
}

/// The result of a draw or a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(i32)]
pub enum CullingResult {
    /// It may be visible.
    Visible = 0,
    /// It is certainly hidden by what was drawn.
    Occluded = 1,
    /// It is outside the view, or back-facing.
    ViewCulled = 3,
}

impl CullingResult {
    /// The result for a number from C or a recording.
    pub(crate) fn from_number(n: i32) -> Option<Self> {
        [Self::Visible, Self::Occluded, Self::ViewCulled].into_iter().find(|&result| result as i32 == n)
    }
}

/// The frustum planes that a mesh may cross: a set of flags.
///
/// Only `NEAR` has an effect: without it the object's near plane is not applied (geometry behind the eye is always
/// clipped). Omitting a side plane does not promise that the mesh stays inside it: it is always safe, and never faster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClipPlanes(u8);

impl ClipPlanes {
    /// No plane.
    pub const NONE: Self = Self(0);
    /// The near plane.
    pub const NEAR: Self = Self(0x01);
    /// x = -w.
    pub const LEFT: Self = Self(0x02);
    /// x = w.
    pub const RIGHT: Self = Self(0x04);
    /// y = -w.
    pub const BOTTOM: Self = Self(0x08);
    /// y = w.
    pub const TOP: Self = Self(0x10);
    /// The four side planes.
    pub const SIDES: Self = Self(0x1e);
    /// All five.
    pub const ALL: Self = Self(0x1f);

    /// The set with these bits; `None` if a bit is not a plane.
    pub const fn from_bits(bits: u32) -> Option<Self> {
        if bits & !0x1f == 0 { Some(Self(bits as u8)) } else { None }
    }

    /// The bits of the set.
    pub const fn bits(self) -> u32 {
        self.0 as u32
    }

    /// Is every plane of `other` in the set?
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }
}

impl Default for ClipPlanes {
    fn default() -> Self {
        Self::ALL
    }
}

impl core::ops::BitOr for ClipPlanes {
    type Output = Self;
    fn bitor(self, rhs: Self) -> Self {
        Self(self.0 | rhs.0)
    }
}

/// A layout in the form used by C and the kernel, where the context determines which coordinate the last offset is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct VertexLayout {
    /// Bytes from one vertex to the next; not negative.
    pub stride: i32,
    /// Bytes from x to y.
    pub offset_y: i32,
    /// Bytes from x to w; with a matrix, to z.
    pub offset_zw: i32,
}

impl VertexLayout {
    /// Clip-space `x, y, z, w`, 16 bytes per vertex.
    pub const CLIP_SPACE: Self = Self::new(16, 4, 12);
    /// Model-space `x, y, z`, 12 bytes per vertex, to be used with a matrix.
    pub const POSITIONS: Self = Self::new(12, 4, 8);

    /// A layout from its stride and offsets in bytes.
    pub const fn new(stride: i32, offset_y: i32, offset_zw: i32) -> Self {
        Self { stride, offset_y, offset_zw }
    }
}

/// A rectangle of pixels: `min` inclusive, `max` exclusive. x is in multiples of 32, y of 8; a `max` may also be the
/// width or height of the buffer, as is or rounded up to whole tiles. Rows are counted in the object's y direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ScissorRect {
    /// First column.
    pub min_x: i32,
    /// First row.
    pub min_y: i32,
    /// Column after the last.
    pub max_x: i32,
    /// Row after the last.
    pub max_y: i32,
}

/// Statistics of all draws since the object was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct OccluderStatistics {
    /// Triangles submitted to `render_triangles` and `bin_triangles`, and those of drawn lists.
    pub num_processed_triangles: i64,
    /// Those that are front-facing and whose bounds contain a pixel centre on the screen: counted when they are binned,
    /// and again for each list that is drawn.
    pub num_rasterized_triangles: i64,
    /// 32x8 tiles in the bounds of such triangles.
    pub num_tiles_traversed: i64,
    /// Tiles in which a triangle changed, or could have changed, a sub-tile.
    pub num_tiles_updated: i64,
    /// Tiles in which a reference depth rose.
    pub num_tiles_merged: i64,
    /// Triangles dropped for a NaN, an infinite coordinate, or a distance beyond 2^40.
    pub num_dropped_triangles: i64,
}

/// Statistics of all queries since the object was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct OccludeeStatistics {
    /// Rectangles tested.
    pub num_processed_rectangles: i64,
    /// Triangles submitted to `test_triangles` (including those after the first visible one).
    pub num_processed_triangles: i64,
    /// Those of them that were compared with the buffer, up to the first that may be visible.
    pub num_rasterized_triangles: i64,
    /// Tiles whose sub-tiles were compared with a rectangle, and those in the bounds of such triangles.
    pub num_tiles_traversed: i64,
}

/// All counts of an object, if its settings enable statistics; otherwise only that of dropped triangles. The same on
/// every instruction set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct Statistics {
    /// Counts of draws.
    pub occluders: OccluderStatistics,
    /// Counts of queries.
    pub occludees: OccludeeStatistics,
}
