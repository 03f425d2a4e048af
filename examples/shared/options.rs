//! What several examples let the command line choose.

use clap::ValueEnum;

/// An update rule, in the numbers of the C interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Rule {
    ThreeLayer = 0,
    Quick = 1,
    Accurate = 2,
}

/// An instruction set, in the numbers of the C++ class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Isa {
    Scalar = -1,
    Sse2 = 0,
    Sse41 = 1,
    Avx2 = 2,
    Avx512 = 3,
    Neon = 16,
}
