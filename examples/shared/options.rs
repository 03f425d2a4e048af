//! What several examples let the command line choose.

use clap::ValueEnum;
use masked_occlusion_culling::{Implementation, UpdateRule};

/// An update rule, in the numbers of the C interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum Rule {
    ThreeLayer = 0,
    Quick = 1,
    Accurate = 2,
    FourLayer = 3,
}

/// An instruction set, in the numbers of the C++ class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum Isa {
    Scalar = -1,
    Sse2 = 0,
    Sse41 = 1,
    Avx2 = 2,
    Avx512 = 3,
    Neon = 16,
    Simd128 = 17,
}

impl From<Rule> for UpdateRule {
    fn from(rule: Rule) -> Self {
        match rule {
            Rule::ThreeLayer => Self::ThreeLayer,
            Rule::Quick => Self::Quick,
            Rule::Accurate => Self::Accurate,
            Rule::FourLayer => Self::FourLayer,
        }
    }
}

impl From<Isa> for Implementation {
    fn from(isa: Isa) -> Self {
        match isa {
            Isa::Scalar => Self::Scalar,
            Isa::Sse2 => Self::Sse2,
            Isa::Sse41 => Self::Sse41,
            Isa::Avx2 => Self::Avx2,
            Isa::Avx512 => Self::Avx512,
            Isa::Neon => Self::Neon,
            Isa::Simd128 => Self::Simd128,
        }
    }
}
