//! Command-line options shared by several programs.

use clap::ValueEnum;
use masked_occlusion_culling::{Implementation, Settings, UpdateRule};

/// An update rule, with the values of the C interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum Rule {
    ThreeLayer = 0,
    Quick = 1,
    Accurate = 2,
    FourLayer = 3,
}

/// An instruction set, with the values of the C++ class.
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

impl Rule {
    /// Its name in tables and legends.
    pub fn name(self) -> &'static str {
        match self {
            Rule::ThreeLayer => "three layers",
            Rule::Quick => "quick",
            Rule::Accurate => "accurate",
            Rule::FourLayer => "four layers",
        }
    }
}

impl Isa {
    /// Its name on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().into())
    }

    /// Those of this processor, lowest first.
    pub fn available() -> Vec<Self> {
        let available = Implementation::available();
        Self::value_variants().iter().copied().filter(|isa| available.contains(&Implementation::from(*isa))).collect()
    }
}

/// Parses an instruction set of this processor from the command line: for one that the processor does not have, the
/// library would silently use the best one available.
pub fn isa(text: &str) -> Result<Isa, String> {
    let available = Isa::available();
    available.iter().copied().find(|isa| isa.name() == text).ok_or_else(|| {
        let known = Isa::value_variants().iter().any(|isa| isa.name() == text);
        let what = if known { "not in this build or not on this processor" } else { "no such instruction set" };
        let names: Vec<String> = available.iter().map(|isa| isa.name()).collect();
        format!("{what}; available: {}", names.join(", "))
    })
}

/// The settings for these options; without an instruction set, the best that the processor has.
pub fn settings(isa: Option<Isa>, rule: Rule) -> Settings {
    let best = Settings::default();
    isa.map_or(best, |isa| best.with_implementation(isa.into())).with_update_rule(rule.into())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_instruction_set_of_another_processor_is_refused() {
        for own in Isa::available() {
            assert_eq!(isa(&own.name()), Ok(own));
        }
        let foreign = if cfg!(target_arch = "aarch64") { "avx2" } else { "neon" };
        for (name, reason) in [(foreign, "not on this processor"), ("mmx", "no such")] {
            let error = isa(name).unwrap_err();
            assert!(error.contains(reason) && error.contains(&Isa::available()[0].name()), "{error}");
        }
    }
}
