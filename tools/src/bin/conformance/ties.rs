//! Counts the ties that the fill rule has to break: pixel centres exactly on an edge.

use crate::view::View;
use tools::oracle::{Triangle, UNIT, area};

/// The number of pixel centres on the screen that are on each edge, ends included, of a triangle with a nonzero area.
pub fn ties(t: &Triangle, view: View) -> u64 {
    if area(t) == 0 {
        return 0;
    }
    (0..3).map(|i| on_edge((t[i].x, t[i].y), (t[(i + 1) % 3].x, t[(i + 1) % 3].y), view)).sum()
}

fn on_edge(a: (i64, i64), b: (i64, i64), view: View) -> u64 {
    let (low, high) = if a.1 <= b.1 { (a, b) } else { (b, a) };
    let rows = centres(low.1, high.1, view.height);
    if low.1 == high.1 {
        let columns = centres(low.0.min(high.0), low.0.max(high.0), view.width);
        return if rows.is_empty() { 0 } else { columns.count() as u64 };
    }
    let (width, across, down) = (view.width as i64, high.0 - low.0, high.1 - low.1);
    let hits = |row: &i64| {
        let n = across * (row * UNIT + UNIT / 2 - low.1);
        let x = low.0 + n.div_euclid(down);
        n.rem_euclid(down) == 0 && x.rem_euclid(UNIT) == UNIT / 2 && (0..width).contains(&x.div_euclid(UNIT))
    };
    rows.filter(hits).count() as u64
}

/// The pixels along one axis whose centres are from `low` to `high`.
fn centres(low: i64, high: i64, size: usize) -> std::ops::Range<i64> {
    let first = (low + UNIT / 2 - 1).div_euclid(UNIT).max(0);
    let end = (high + UNIT / 2).div_euclid(UNIT).min(size as i64);
    first..end.max(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tools::oracle::Vertex;

    fn of(corners: [(i64, i64); 3]) -> u64 {
        ties(&corners.map(|(x, y)| Vertex { x, y, z: 1.0 }), View::new((8, 8), 64).unwrap())
    }

    #[test]
    fn centres_on_edges_are_counted() {
        // Five centres on each leg, and five on the hypotenuse, which is a diagonal.
        assert_eq!(of([(128, 128), (128 + 4 * 256, 128), (128, 128 + 4 * 256)]), 15);
        // One unit lower, only the vertical leg passes through centres, but not through that in its first row.
        assert_eq!(of([(128, 129), (128 + 4 * 256, 129), (128, 129 + 4 * 256)]), 4);
        // Off the screen on three sides: the row of eight.
        assert_eq!(of([(-5000, 128), (5000, 128), (0, -9000)]), 8);
        // A degenerate triangle has no inside, so the rule has nothing to decide.
        assert_eq!(of([(128, 128), (640, 640), (1152, 1152)]), 0);
    }
}
