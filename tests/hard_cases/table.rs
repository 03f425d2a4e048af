//! The table of docs/accuracy.md, with a row per case.

use std::fmt::Write;
use std::path::Path;

use crate::cases::measured::Measured;
use crate::cases::{Case, all};

const BEGIN: &str = "<!-- figures: UPDATE_ACCURACY=1 cargo test --test hard_cases -->\n";
const END: &str = "<!-- end of figures -->\n";

/// An integer with thousands separators.
fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// Units in the last place, with a decimal if that is significant.
fn ulps(x: f64) -> String {
    match x.abs() {
        f64::INFINITY => "none".into(),
        a if a < 0.05 => "0".into(),
        a if a < 1000.0 => format!("{x:.1}"),
        a if a < 1e6 => format!("{}{}", if x < 0.0 { "-" } else { "" }, count(a.round() as u64)),
        _ => format!("{x:.1e}"),
    }
}

/// A fraction as a percentage.
fn percent(x: f64) -> String {
    let x = 100.0 * x;
    match x {
        f64::NEG_INFINITY => "none".into(),
        x if x <= 0.0 => "0".into(),
        x if x < 0.001 => format!("{x:.0e}"),
        x if x < 1.0 => format!("{x:.3}"),
        x => format!("{x:.1}"),
    }
}

fn pixels(x: f64) -> String {
    match x {
        0.0 => "0".into(),
        x if x < 0.001 => format!("{x:.0e}"),
        x => format!("{x:.4}"),
    }
}

fn row(case: &Case, m: &Measured) -> String {
    let cells = [
        case.name.into(),
        count(m.triangles),
        count(m.pixels),
        count(m.depths),
        count(m.wrong),
        pixels(m.off),
        ulps(m.nearer),
        ulps(m.over),
        ulps(m.behind),
        percent(m.part),
        percent(m.behind_share()),
        count(m.forgotten),
        count(m.refused),
        if m.asked == 0 { "none asked".into() } else { format!("{} of {}", count(m.hidden), count(m.asked)) },
    ];
    format!("| {} |\n", cells.join(" | "))
}

fn table() -> String {
    let mut out = String::from(
        "| case | triangles | pixels | covered | wrong | off, pixels | nearest, ulp | over, ulp | behind, ulp | behind, % | over 1% behind, % \
         | given up | refused | falsely hidden |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    all().for_each(|case| write!(out, "{}", row(case, case.measured())).expect("a string"));
    out
}

/// The committed table matches the current measurements.
#[test]
fn the_committed_table_is_current() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/accuracy.md");
    let text = std::fs::read_to_string(&path).expect("docs/accuracy.md").replace("\r\n", "\n");
    let (before, rest) = text.split_once(BEGIN).expect("a line where the figures begin");
    let (committed, after) = rest.split_once(END).expect("a line where they end");
    let measured = table();
    if std::env::var_os("UPDATE_ACCURACY").is_some_and(|v| v == "1") {
        std::fs::write(&path, format!("{before}{BEGIN}{measured}{END}{after}"))
            .expect("docs/accuracy.md can be written");
        return;
    }
    let differs = committed.lines().zip(measured.lines()).find(|(a, b)| a != b);
    assert!(
        committed == measured,
        "docs/accuracy.md is stale, first in {differs:?}: run `UPDATE_ACCURACY=1 cargo test --test hard_cases` and commit it"
    );
}
