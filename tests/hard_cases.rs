//! Hard cases by name, measured against the oracle: how many pixels are covered wrongly, and how far the stored depths
//! are from the exact ones. A test for each gives the limits; the figures are in docs/accuracy.md, which
//! `UPDATE_ACCURACY=1 cargo test --test hard_cases` rewrites.

mod oracle;
mod support;

#[path = "hard_cases"]
mod cases {
    use std::sync::OnceLock;

    mod coplanar;
    mod grid;
    mod ground;
    mod junctions;
    mod layers;
    pub mod measured;
    mod neighbours;
    mod range;
    mod scale;
    mod slivers;
    mod subject;
    mod table;

    use measured::Measured;

    /// A case: measured once, by whichever test comes first.
    pub struct Case {
        pub name: &'static str,
        measure: fn() -> Measured,
        result: OnceLock<Measured>,
    }

    impl Case {
        pub const fn new(name: &'static str, measure: fn() -> Measured) -> Self {
            Self { name, measure, result: OnceLock::new() }
        }

        pub fn measured(&self) -> &Measured {
            self.result.get_or_init(self.measure)
        }
    }

    /// All cases, in the order of the table.
    pub fn all() -> impl Iterator<Item = &'static Case> {
        [
            slivers::CASES,
            ground::CASES,
            coplanar::CASES,
            junctions::CASES,
            neighbours::CASES,
            range::CASES,
            scale::CASES,
            grid::CASES,
            layers::CASES,
        ]
        .into_iter()
        .flatten()
        .copied()
    }
}
