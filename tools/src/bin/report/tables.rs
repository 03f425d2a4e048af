//! Tables, for the page and for the terminal.

use std::collections::BTreeMap;

use crate::merging;
use crate::passes::{self, PASSES};
use crate::setting::{ORDERS, Order, RULES, SCREEN, Setting, best_isa};
use crate::sizes;
use crate::survey::{Point, Survey};
use demo::options::Rule;

/// A heading and rows with equally many cells; the first column is left-aligned.
pub struct Table {
    pub head: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    fn new<S: ToString>(head: impl IntoIterator<Item = S>) -> Self {
        Self { head: head.into_iter().map(|s| s.to_string()).collect(), rows: Vec::new() }
    }

    /// As text in aligned columns.
    pub fn text(&self) -> String {
        let lines = || std::iter::once(&self.head).chain(&self.rows);
        let width = |column: usize| lines().map(|l| l[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.head.len()).map(width).collect();
        let line = |cells: &Vec<String>| {
            let cells = cells.iter().zip(&widths).enumerate();
            let cells: Vec<String> =
                cells.map(|(i, (c, &w))| if i == 0 { format!("{c:w$}") } else { format!("{c:>w$}") }).collect();
            cells.join("  ").trim_end().to_owned()
        };
        lines().map(line).collect::<Vec<_>>().join("\n")
    }
}

fn percent(value: f64) -> String {
    format!("{value:.1}")
}

/// The usual setting with a rule, at the highest resolution that was measured.
fn plain(survey: &Survey, rule: Rule, order: Order) -> Option<&Point> {
    let of_rule = |p: &&Point| p.setting.is_plain() && p.setting.rule == rule && p.setting.order == order;
    survey.points.iter().filter(of_rule).max_by_key(|p| p.setting.size)
}

/// For each scene and order: the percentage of hidden objects and boxes that each rule culls, and its time relative to
/// the quick rule.
pub fn rules(surveys: &[Survey]) -> Table {
    let mut table = Table::new(["scene, order", "exact", "8x4 ceiling"]);
    for rule in RULES {
        table.head.push(rule.name().into());
        table.head.push("time".into());
    }
    // Sums for the last line: shares of objects, of boxes, logarithms of times.
    let mut sums = RULES.map(|_| [0.0; 3]);
    let mut count = 0.0;
    for survey in surveys {
        for order in ORDERS {
            let Some(quick) = plain(survey, Rule::Quick, order) else { continue };
            let both = |shares: [crate::survey::Share; 2]| shares.map(|s| percent(s.percent())).join(" / ");
            let mut row = vec![format!("{}, {order}", survey.name), both(survey.exact), both(survey.ceiling)];
            for (rule, sums) in RULES.into_iter().zip(&mut sums) {
                let Some(p) = plain(survey, rule, order) else { continue };
                let time = p.seconds() / quick.seconds();
                row.push(both([p.objects, p.boxes]));
                row.push(format!("{time:.2}"));
                let values = [p.objects.percent(), p.boxes.percent(), time.ln()];
                sums.iter_mut().zip(values).for_each(|(sum, v)| *sum += v);
            }
            count += 1.0;
            table.rows.push(row);
        }
    }
    if count > 0.0 {
        let mut row = vec!["mean".into(), String::new(), String::new()];
        for [objects, boxes, log] in sums.map(|s| s.map(|v| v / count)) {
            row.push(format!("{} / {}", percent(objects), percent(boxes)));
            row.push(format!("{:.2}", log.exp()));
        }
        table.rows.push(row);
    }
    table
}

/// Every point of a scene.
pub fn points(survey: &Survey) -> Table {
    let mut table = Table::new([
        "rule",
        "size",
        "order",
        "buffers",
        "set",
        "threads",
        "draw, ms",
        "query, ms",
        "objects, %",
        "boxes, %",
        "falsely",
        "on screen",
        "leaking, %",
    ]);
    for p in &survey.points {
        let Setting { rule, size, order, buffers, isa, threads } = p.setting;
        table.rows.push(vec![
            rule.name().into(),
            format!("{}x{}", size.0, size.1),
            order.to_string(),
            buffers.to_string(),
            isa.name(),
            threads.to_string(),
            format!("{:.3}", p.draw * 1e3),
            format!("{:.3}", p.query * 1e3),
            percent(p.objects.percent()),
            percent(p.boxes.percent()),
            p.falsely.to_string(),
            p.on_screen.to_string(),
            format!("{:.2}", p.leaks.percent()),
        ]);
    }
    table
}

/// For every value of a setting, the mean over scenes of its time relative to the usual setting with the same rule and
/// order, and of the difference in what it culls.
pub fn effect<K: Ord + Clone>(surveys: &[Survey], what: &str, key: impl Fn(&Setting) -> Option<(K, String)>) -> Table {
    /// The value's name, and time, objects, boxes for each scene and order.
    type Group = (String, Vec<[f64; 3]>);
    let mut groups: BTreeMap<(K, u8), Group> = BTreeMap::new();
    for survey in surveys {
        for p in &survey.points {
            let Some((k, name)) = key(&p.setting) else { continue };
            let Some(base) = plain(survey, p.setting.rule, p.setting.order) else { continue };
            let value = [
                (p.draw / base.draw).ln(),
                p.objects.percent() - base.objects.percent(),
                p.boxes.percent() - base.boxes.percent(),
            ];
            let rule = RULES.iter().position(|r| *r == p.setting.rule).unwrap_or(0) as u8;
            groups.entry((k, rule)).or_insert_with(|| (name, Vec::new())).1.push(value);
        }
    }
    let mut table = Table::new([what]);
    for rule in RULES {
        let name = rule.name();
        table.head.extend([format!("{name}: draw"), "objects".into(), "boxes".into()]);
    }
    let mut rows: BTreeMap<K, Vec<String>> = BTreeMap::new();
    for ((k, _), (name, values)) in groups {
        let mean = |i: usize| values.iter().map(|v| v[i]).sum::<f64>() / values.len() as f64;
        let row = rows.entry(k).or_insert_with(|| vec![name]);
        row.extend([format!("{:.2}", mean(0).exp()), format!("{:+.1}", mean(1)), format!("{:+.1}", mean(2))]);
    }
    table.rows = rows.into_values().filter(|row| row.len() == table.head.len()).collect();
    table
}

/// Resolution on one thread with one buffer; then buffers, instruction sets, and threads at full resolution.
pub fn effects(surveys: &[Survey]) -> Vec<Table> {
    let best = best_isa();
    let usual = |s: &Setting| s.isa == best && s.threads == 1;
    let tables = [
        effect(surveys, "resolution", move |s| {
            (usual(s) && s.buffers == 1).then(|| (u32::MAX - s.size.0, format!("{}x{}", s.size.0, s.size.1)))
        }),
        effect(surveys, "buffers merged", move |s| {
            (usual(s) && s.size == SCREEN).then(|| (s.buffers, s.buffers.to_string()))
        }),
        effect(surveys, "instruction set", move |s| {
            (s.threads == 1 && s.buffers == 1 && s.size == SCREEN).then(|| (s.isa as i32, s.isa.name()))
        }),
        effect(surveys, "threads", move |s| {
            let how = match (s.buffers, s.threads) {
                (1, 1) => "no pool".into(),
                (1, _) => "a pool".into(),
                (buffers, _) => format!("{buffers} buffers merged"),
            };
            // Each buffer has one thread.
            let is_sound = s.buffers == 1 || s.threads as usize <= s.buffers;
            let has_both = is_sound && s.isa == best && s.size == SCREEN && s.buffers <= 2 && s.order != Order::Far;
            has_both.then(|| ((s.buffers, s.threads), format!("{}, {how}", s.threads)))
        }),
    ];
    // A short run has a single size, which is not that of the screen.
    tables.into_iter().filter(|t| !t.rows.is_empty()).collect()
}

pub fn passes(rows: &[passes::Row]) -> Table {
    let mut table = Table::new(["microseconds"].into_iter().chain(PASSES).chain(["sum", "in one go", "culled"]));
    for row in rows {
        let mut cells = vec![row.name.clone()];
        cells.extend(row.passes.iter().chain([&row.total(), &row.frame]).map(|t| format!("{:.0}", t * 1e6)));
        cells.push(row.culled.to_string());
        table.rows.push(cells);
    }
    table
}

pub fn sizes(rows: &[sizes::Row], libraries: &[String]) -> Table {
    let mut table = Table::new(["leg, pixels", "triangles"]);
    table.head.extend(libraries.iter().map(|l| format!("{l}, ns a triangle")));
    for row in rows {
        let mut cells = vec![row.leg.to_string(), row.triangles.to_string()];
        cells.extend((0..libraries.len()).map(|i| format!("{:.1}", row.ns_per_triangle(i))));
        table.rows.push(cells);
    }
    table
}

pub fn merging(rows: &[merging::Row]) -> Table {
    let mut table = Table::new([
        "size, rule",
        "terrain, ms",
        "foreground, ms",
        "both, ms",
        "merge, ms",
        "merge, %",
        "one buffer, ms",
        "one buffer, %",
        "merged, %",
        "falsely",
    ]);
    for row in rows {
        let m = &row.measured;
        let share = |culled: usize| percent(100.0 * culled as f64 / row.hidden.max(1) as f64);
        let ms = |s: f64| format!("{:.3}", s * 1e3);
        table.rows.push(vec![
            format!("{}x{}, {}", row.size.0, row.size.1, row.rule.name()),
            ms(m.terrain),
            ms(m.foreground),
            ms(m.terrain + m.foreground),
            ms(m.merge),
            percent(row.share()),
            ms(m.one),
            share(m.culled_one),
            share(m.culled_two),
            m.falsely.to_string(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_below_each_other() {
        let mut table = Table::new(["a", "long"]);
        table.rows.push(vec!["wide name".into(), "1".into()]);
        assert_eq!(table.text(), "a          long\nwide name     1");
    }
}
