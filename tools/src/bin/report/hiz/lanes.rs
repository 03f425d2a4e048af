//! The vector operations that the passes need. An instruction set is a zero-sized token that only [`run`] creates,
//! after checking the processor, so that whoever has one may use its instructions.

use masked_occlusion_culling::Implementation;

use super::portable::Portable;
#[cfg(target_arch = "x86_64")]
use super::{avx2::Avx2, avx512::Avx512};

/// x, y, w and padding, or their projected form: four words per vertex.
pub type Words = [u32; 4];

/// The largest number of lanes of any instruction set.
pub const MOST: usize = 16;

/// 0, 1, 2, ... as lanes, and as indices of consecutive vertices.
pub static COUNT: [u32; MOST] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

pub trait Lanes: Copy {
    const N: usize;
    /// A vector of depths is a block of pixels 8 wide and this high, as a power of two.
    const LOG_HEIGHT: u32;
    /// Number of such blocks in a tile of 8x8 pixels.
    const ROWS: usize = 8 >> Self::LOG_HEIGHT;
    /// Floats, integers, and masks for either.
    type F: Copy;
    type I: Copy;
    type M: Copy;

    fn f(self, x: f32) -> Self::F;
    fn i(self, x: i32) -> Self::I;
    /// A float's bits as an integer and back.
    fn bits_of(self, x: Self::F) -> Self::I;
    fn float_of(self, x: Self::I) -> Self::F;

    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// a * b + c, with one rounding if the processor has fused multiply-add.
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// Rounds to the nearest integer, and converts back.
    fn round(self, a: Self::F) -> Self::I;
    fn to_f(self, a: Self::I) -> Self::F;

    fn add_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn sub_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn mul_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn min_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn max_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn and_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn or_i(self, a: Self::I, b: Self::I) -> Self::I;
    /// Arithmetic shift right, and shift left.
    fn shr(self, a: Self::I, n: u32) -> Self::I;
    fn shl(self, a: Self::I, n: u32) -> Self::I;
    /// a * b - c * d with the correct sign, and 0 only if it is exactly 0.
    fn cross(self, a: Self::I, b: Self::I, c: Self::I, d: Self::I) -> Self::F;

    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    fn lt_i(self, a: Self::I, b: Self::I) -> Self::M;
    fn eq_i(self, a: Self::I, b: Self::I) -> Self::M;
    fn and_m(self, a: Self::M, b: Self::M) -> Self::M;
    fn or_m(self, a: Self::M, b: Self::M) -> Self::M;
    /// One bit per lane.
    fn bits(self, m: Self::M) -> u32;
    fn select(self, m: Self::M, yes: Self::F, no: Self::F) -> Self::F;
    fn select_i(self, m: Self::M, yes: Self::I, no: Self::I) -> Self::I;

    /// Whether any lane is negative.
    fn any_negative(self, a: Self::I) -> bool;
    /// The minimum of the lanes.
    fn least(self, a: Self::F) -> f32;

    /// # Safety
    /// `N` words can be read at `p`.
    unsafe fn load(self, p: *const f32) -> Self::F;
    /// # Safety
    /// `N` words can be read at `p`.
    unsafe fn load_i(self, p: *const i32) -> Self::I;
    /// # Safety
    /// `N` words can be written at `p`.
    unsafe fn store(self, p: *mut f32, x: Self::F);
    /// # Safety
    /// `N` words can be written at `p`.
    unsafe fn store_i(self, p: *mut i32, x: Self::I);
    /// Stores the lanes whose bit is set in `keep` contiguously; the memory behind them is overwritten, too.
    ///
    /// # Safety
    /// `N` words can be written at `p`.
    unsafe fn compress(self, p: *mut i32, keep: u32, x: Self::I);
    /// Depth test and update: the nearer of the stored depth and `depth`, in the lanes where `outside` is not negative.
    ///
    /// # Safety
    /// `N` floats can be read and written at `p`, which is a multiple of `N` floats.
    unsafe fn raise(self, p: *mut f32, outside: Self::I, depth: Self::F);
    /// The first, second, third and fourth words of `base[index[0]]`, `base[index[STEP]]`, ...
    ///
    /// # Safety
    /// `N` indices can be read that far apart, and so can the vertices that they refer to.
    unsafe fn fetch<const STEP: usize>(self, base: *const Words, index: *const u32) -> [Self::I; 4];
    /// Writes four words for each lane.
    ///
    /// # Safety
    /// `4 * N` words can be written at `p`.
    unsafe fn spread(self, p: *mut Words, x: [Self::I; 4]);
    /// (x, y, z, 1) times a matrix of four columns, for as many vertices as fit in a vector.
    ///
    /// # Safety
    /// `4 * N` floats can be read at `from` and written at `to`.
    unsafe fn transform(self, columns: &[[f32; 4]; 4], from: *const [f32; 4], to: *mut [f32; 4]);
}

/// A pass, generic over the instruction set.
pub trait Pass {
    type Output;
    fn run<L: Lanes>(self, s: L) -> Self::Output;
}

/// Whether this processor can run it. Levels that are not listed here run as `Scalar`.
pub fn usable(level: Implementation) -> Implementation {
    #[cfg(target_arch = "x86_64")]
    {
        let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
        let avx512 = is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512vl");
        match level {
            Implementation::Avx512 if avx2 && avx512 => return Implementation::Avx512,
            Implementation::Avx512 | Implementation::Avx2 if avx2 => return Implementation::Avx2,
            _ => {}
        }
    }
    let _ = level;
    Implementation::Scalar
}

/// Runs a pass on an instruction set.
///
/// # Safety
/// `level` came from [`usable`].
#[inline(always)]
pub unsafe fn run<P: Pass>(level: Implementation, pass: P) -> P::Output {
    match level {
        // SAFETY: the processor has it, the caller says.
        #[cfg(target_arch = "x86_64")]
        Implementation::Avx512 => unsafe { Avx512::run(pass) },
        // SAFETY: the processor has it, the caller says.
        #[cfg(target_arch = "x86_64")]
        Implementation::Avx2 => unsafe { Avx2::run(pass) },
        _ => Portable::run(pass),
    }
}

/// Methods that each consist of one expression of intrinsics.
#[cfg(target_arch = "x86_64")]
macro_rules! ops {
    ($($name:ident($($a:ident: $t:ty),*) -> $r:ty = $e:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($a: $t),*) -> $r {
                // SAFETY: the token proves the instruction set, and only registers are accessed.
                unsafe { $e }
            }
        )*
    };
}

/// Methods that access memory as the trait documents.
#[cfg(target_arch = "x86_64")]
macro_rules! memory_ops {
    ($($name:ident($($a:ident: $t:ty),*) $(-> $r:ty)? = $e:expr;)*) => {
        $(
            #[inline(always)]
            unsafe fn $name(self, $($a: $t),*) $(-> $r)? {
                // SAFETY: the token proves the instruction set, the caller the memory.
                unsafe { $e }
            }
        )*
    };
}

#[cfg(target_arch = "x86_64")]
pub(super) use {memory_ops, ops};
