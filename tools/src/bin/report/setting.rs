//! The settings: the choices of a user of the library, and which combinations are measured.

use std::fmt;

use demo::options::{Isa, Rule};

/// The order in which objects are drawn, by the distance of their boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Order {
    /// Nearest first.
    Near,
    Random,
    /// Farthest first.
    Far,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Setting {
    pub rule: Rule,
    pub size: (u32, u32),
    pub order: Order,
    /// Number of buffers that objects are distributed over, which are merged at the end.
    pub buffers: usize,
    pub isa: Isa,
    pub threads: u32,
}

pub const RULES: [Rule; 4] = [Rule::ThreeLayer, Rule::Quick, Rule::Accurate, Rule::FourLayer];
pub const ORDERS: [Order; 3] = [Order::Near, Order::Random, Order::Far];
pub const BUFFERS: [usize; 3] = [1, 2, 4];
/// Size of the screen: visibility on it is the reference for all settings.
pub const SCREEN: (u32, u32) = (1920, 1080);
const SIZES: [(u32, u32); 4] = [SCREEN, (1280, 720), (640, 360), (320, 180)];

/// The extent of the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    Short,
    Usual,
    Every,
}

impl Setting {
    /// Whether it is the usual choice: one buffer, one thread, the best instruction set.
    pub fn is_plain(&self) -> bool {
        self.buffers == 1 && self.threads == 1 && self.isa == best_isa()
    }

    /// A key shared by all settings that must give the same bits: instruction sets, and threads with one buffer.
    pub fn bits(&self) -> Self {
        Self { isa: Isa::Scalar, threads: 1, ..*self }
    }
}

pub fn best_isa() -> Isa {
    *Isa::available().last().unwrap_or(&Isa::Scalar)
}

/// 1, 2, 4, ... up to the number of processors, but at least 2.
fn threads() -> Vec<u32> {
    let most = std::thread::available_parallelism().map_or(2, |n| n.get().max(2)) as u32;
    (0..).map(|n| 1 << n).take_while(|n| *n <= most).collect()
}

/// The settings to measure, without duplicates.
///
/// Usually all combinations of rule, resolution, order and number of buffers on one thread; then, at full resolution,
/// all instruction sets, and several threads.
pub fn settings(extent: Extent) -> Vec<Setting> {
    let (isa, all_isas) = (best_isa(), Isa::available());
    let mut settings = Vec::new();
    let mut add = |sizes: &[(u32, u32)], orders: &[Order], buffers: &[usize], isas: &[Isa], threads: &[u32]| {
        for &size in sizes {
            for &order in orders {
                for &buffers in buffers {
                    for &isa in isas {
                        for &threads in threads {
                            settings.extend(RULES.map(|rule| Setting { rule, size, order, buffers, isa, threads }));
                        }
                    }
                }
            }
        }
    };
    match extent {
        Extent::Short => {
            add(&[(640, 360)], &[Order::Near, Order::Random], &[1, 2], &[isa], &[1]);
            add(&[(640, 360)], &[Order::Near], &[1], &[all_isas[0]], &[1]);
            add(&[(640, 360)], &[Order::Near], &[1, 2], &[isa], &[2]);
        }
        Extent::Usual => {
            add(&SIZES, &ORDERS, &BUFFERS, &[isa], &[1]);
            add(&[SCREEN], &[Order::Near, Order::Random], &[1], &all_isas, &[1]);
            add(&[SCREEN], &[Order::Near, Order::Random], &[1, 2], &[isa], &threads());
        }
        Extent::Every => add(&SIZES, &ORDERS, &BUFFERS, &all_isas, &threads()),
    }
    let mut seen = std::collections::HashSet::new();
    settings.retain(|s| seen.insert(*s));
    settings
}

impl fmt::Display for Order {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Near => "near",
            Self::Random => "random",
            Self::Far => "far",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_is_measured_and_nothing_twice() {
        for extent in [Extent::Short, Extent::Usual, Extent::Every] {
            let all = settings(extent);
            for (i, a) in all.iter().enumerate() {
                assert!(!all[..i].contains(a), "{a:?}");
            }
            assert!(RULES.iter().all(|rule| all.iter().any(|s| s.rule == *rule)));
            assert!(all.iter().any(|s| s.threads > 1) && all.iter().any(|s| s.buffers > 1));
        }
        let usual = settings(Extent::Usual);
        assert!(ORDERS.iter().all(|order| usual.iter().any(|s| s.order == *order)));
        assert!(SIZES.iter().all(|size| usual.iter().any(|s| s.size == *size)));
        assert!(Isa::available().iter().all(|isa| usual.iter().any(|s| s.isa == *isa)));
        let product =
            RULES.len() * SIZES.len() * ORDERS.len() * BUFFERS.len() * Isa::available().len() * threads().len();
        assert_eq!(settings(Extent::Every).len(), product);
    }
}
