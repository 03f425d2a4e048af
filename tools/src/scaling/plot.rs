//! The plots. Both axes are logarithmic, so that a factor of two is the same distance everywhere, and a cost that grows
//! proportionally is a straight line with slope 1.

use std::path::Path;

use plotters::prelude::*;

use super::job::Study;
use super::table::Row;
use crate::Result;

/// Everybody can distinguish blue, orange and grey.
const COLOURS: [RGBColor; 3] = [RGBColor(0, 90, 181), RGBColor(220, 90, 0), RGBColor(120, 120, 120)];

/// A plot of one or two studies.
struct Plot {
    file: &'static str,
    title: &'static str,
    across: &'static str,
    studies: &'static [Study],
    /// The unit of the horizontal axis, in amounts.
    unit: f64,
    /// Base of the powers marked on both axes: two if the range is short.
    base: f64,
}

const PLOTS: [Plot; 3] = [
    Plot {
        file: "triangles.svg",
        title: "A terrain of ever smaller triangles, 1920x1080",
        across: "triangles",
        studies: &[Study::Triangles],
        unit: 1.0,
        base: 10.0,
    },
    Plot {
        file: "pixels.svg",
        title: "A scene of 500 objects, 100,000 triangles in all",
        across: "millions of pixels",
        studies: &[Study::Pixels],
        unit: 1e6,
        base: 2.0,
    },
    Plot {
        file: "depth.svg",
        title: "Sheets that fill the screen, 2,000 triangles each, 1920x1080",
        across: "sheets, one behind the other",
        studies: &[Study::FrontToBack, Study::BackToFront],
        unit: 1.0,
        base: 2.0,
    },
];

/// Milliseconds against amounts.
struct Curve {
    name: String,
    colour: RGBColor,
    filled: bool,
    points: Vec<(f64, f64)>,
}

/// Writes all plots into a folder.
pub fn write(folder: &Path, libraries: &[String], rows: &[Row]) -> Result<()> {
    for plot in &PLOTS {
        let curves = curves(plot, libraries, rows);
        // With a small --most there are too few terrains for a curve.
        if curves.iter().all(|c| c.points.len() > 1) {
            draw(&folder.join(plot.file), plot, &curves)?;
        }
    }
    Ok(())
}

fn curves(plot: &Plot, libraries: &[String], rows: &[Row]) -> Vec<Curve> {
    let mut curves = Vec::new();
    for (i, library) in libraries.iter().enumerate() {
        for (&study, filled) in plot.studies.iter().zip([true, false]) {
            let of_study = rows.iter().filter(|row| row.job.study == study);
            let point = |row: &Row| (f64::from(row.job.amount) / plot.unit, row.samples[i].seconds * 1e3);
            let order = study.name().split_once(", ").map_or(String::new(), |(_, order)| format!(", {order}"));
            curves.push(Curve {
                name: format!("{library}{order}"),
                colour: COLOURS[i % COLOURS.len()],
                filled,
                points: of_study.map(point).collect(),
            });
        }
    }
    curves
}

fn draw(path: &Path, plot: &Plot, curves: &[Curve]) -> Result<()> {
    let root = SVGBackend::new(path, (800, 520)).into_drawing_area();
    root.fill(&WHITE)?;
    // A little margin around the minimum and the maximum.
    let range = |pick: fn(&(f64, f64)) -> f64| {
        let values = || curves.iter().flat_map(|c| &c.points).map(pick);
        values().fold(f64::MAX, f64::min) / 1.2..values().fold(0.0, f64::max) * 1.2
    };
    let (across, up) = (range(|p| p.0), range(|p| p.1));
    let mut chart = ChartBuilder::on(&root)
        .caption(plot.title, ("sans-serif", 20))
        .margin(12)
        .margin_right(24)
        .x_label_area_size(48)
        .y_label_area_size(64)
        .build_cartesian_2d(across.log_scale().base(plot.base), up.log_scale().base(plot.base))?;
    chart
        .configure_mesh()
        .x_desc(plot.across)
        .y_desc("milliseconds a frame, clear included")
        .label_style(("sans-serif", 14))
        .x_label_formatter(&|v| short(*v))
        .y_label_formatter(&|v| short(*v))
        .light_line_style(BLACK.mix(0.06))
        .draw()?;
    for curve in curves {
        let line = ShapeStyle {
            color: curve.colour.mix(if curve.filled { 1.0 } else { 0.6 }),
            filled: false,
            stroke_width: 2,
        };
        let dot = ShapeStyle { color: curve.colour.into(), filled: curve.filled, stroke_width: 2 };
        chart.draw_series(LineSeries::new(curve.points.iter().copied(), line))?;
        chart
            .draw_series(curve.points.iter().map(|p| Circle::new(*p, 4, dot)))?
            .label(&curve.name)
            .legend(move |at| Circle::new(at, 4, dot));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperLeft)
        .legend_area_size(12)
        .label_font(("sans-serif", 14))
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    Ok(root.present()?)
}

/// An axis label.
fn short(value: f64) -> String {
    let (value, unit) = match value {
        1e6.. => (value / 1e6, "M"),
        1e3.. => (value / 1e3, "k"),
        _ => (value, ""),
    };
    format!("{}{unit}", (value * 1e4).round() / 1e4)
}

#[cfg(test)]
mod tests {
    use super::super::job::jobs;
    use super::super::measure::Sample;
    use super::*;

    #[test]
    fn every_plot_names_its_curves_and_units() {
        let libraries = ["ours (quick; avx2)".into(), "other (avx2)".into()];
        let rows: Vec<Row> = jobs(30_000)
            .into_iter()
            .map(|job| Row {
                job,
                triangles: 2000,
                samples: vec![Sample { seconds: 1e-9 * f64::from(job.amount), repeats: 5, hidden: 7 }; 2],
            })
            .collect();
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), &libraries, &rows).unwrap();
        for plot in &PLOTS {
            let text = std::fs::read_to_string(folder.path().join(plot.file)).unwrap();
            for part in ["ours (quick; avx2)", "other (avx2)", "milliseconds", plot.across, plot.title] {
                assert!(text.contains(part), "{}: {part}", plot.file);
            }
        }
        assert_eq!([0.1 + 0.2, 20.0, 3e5, 1e7].map(short), ["0.3", "20", "300k", "10M"]);
    }
}
