//! AVX-512 (F, BW, DQ, VL): sixteen lanes for vertices and triangles, eight for a tile, which has eight
//! sub-tiles. Masks are mask registers; an eight-lane `D` is one register.

mod tile;
mod wide;

use super::{Apart, Job};

#[derive(Clone, Copy)]
pub(super) struct Avx512Tile(());

#[derive(Clone, Copy)]
pub(super) struct Avx512Wide(());

/// # Safety
/// The processor has AVX-512 F, BW, DQ and VL, BMI1, BMI2, LZCNT and POPCNT.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn enter<J: Job>(job: J) -> J::Output {
    job.run(Avx512Tile(()), Avx512Wide(()))
}

/// # Safety
/// As [`enter`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
unsafe fn apart<S, J: Apart<S>>(s: S, job: J) -> J::Output {
    job.run(s)
}
