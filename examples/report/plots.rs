//! The plots of the page, as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::Result;
use crate::options::Rule;
use crate::setting::{Order, SCREEN};
use crate::sizes;
use crate::survey::{Point, Survey};

/// Colours that everyone tells apart.
const BLUE_OF: RGBColor = RGBColor(0, 90, 181);
const ORANGE: RGBColor = RGBColor(220, 90, 0);
const GREEN: RGBColor = RGBColor(0, 140, 90);
const PURPLE: RGBColor = RGBColor(150, 60, 170);
const GREY: RGBColor = RGBColor(110, 110, 110);
const SIZE: (u32, u32) = (820, 520);
const FONT: (&str, i32) = ("sans-serif", 14);

fn colour(rule: Rule) -> RGBColor {
    match rule {
        Rule::ThreeLayer => BLUE_OF,
        Rule::Quick => ORANGE,
        Rule::Accurate => GREEN,
        Rule::FourLayer => PURPLE,
    }
}

/// A drawing as text.
fn svg(draw: impl for<'a> FnOnce(&DrawingArea<SVGBackend<'a>, Shift>) -> Result<()>) -> Result<String> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
    }
    Ok(text)
}

/// A full-resolution z-buffer on the same scene: order, seconds, percent of the hidden objects.
pub struct Baseline {
    pub order: Order,
    pub seconds: f64,
    pub percent: f64,
}

/// Speed against the share of hidden objects that are culled. Colour is the rule, shape the order, size the resolution; a
/// hollow point has several buffers.
pub fn speed_against_error(survey: &Survey, baselines: &[Baseline]) -> Result<String> {
    let points: Vec<&Point> = survey.points.iter().filter(|p| p.setting.threads == 1).collect();
    let best = crate::setting::best_isa();
    let points: Vec<&Point> = points.into_iter().filter(|p| p.setting.isa == best).collect();
    let ms = |p: &Point| p.seconds() * 1e3;
    let times = || points.iter().map(|p| ms(p)).chain(baselines.iter().map(|b| b.seconds * 1e3));
    let across = times().fold(f64::MAX, f64::min) / 1.3..times().fold(0.0, f64::max) * 1.3;
    let lines = [(survey.exact[0], "exact z-buffer", BLACK), (survey.ceiling[0], "least depth of each 8x4", GREY)];
    let shares = || {
        let of_points = points.iter().map(|p| p.objects.percent());
        of_points.chain(lines.iter().map(|l| l.0.percent())).chain(baselines.iter().map(|b| b.percent))
    };
    let least = shares().fold(100.0, f64::min);
    let up = (least - 4.0).max(0.0)..102.0;
    svg(|root| {
        let mut chart = ChartBuilder::on(root)
            .caption(
                format!("{}: {} objects, {} triangles", survey.name, survey.objects, survey.triangles),
                ("sans-serif", 20),
            )
            .margin(12)
            .margin_right(24)
            .x_label_area_size(48)
            .y_label_area_size(56)
            .build_cartesian_2d(across.clone().log_scale(), up)?;
        chart
            .configure_mesh()
            .x_desc("milliseconds: all views drawn and all queries, one thread; small dots are small buffers")
            .y_desc("percent of the hidden objects culled")
            .label_style(FONT)
            .x_label_formatter(&|v| format!("{}", (v * 100.0).round() / 100.0))
            .light_line_style(BLACK.mix(0.06))
            .draw()?;
        for (share, name, colour) in lines {
            let y = share.percent();
            let line = LineSeries::new([(across.start, y), (across.end, y)], colour.stroke_width(1));
            chart
                .draw_series(line)?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x - 6, y), (x + 6, y)], colour));
        }
        let mut dots: Vec<((f64, f64), Order, i32, ShapeStyle)> = Vec::new();
        for &p in &points {
            let filled = p.setting.buffers == 1;
            let style = ShapeStyle { color: colour(p.setting.rule).mix(0.85), filled, stroke_width: 1 };
            dots.push(((ms(p), p.objects.percent()), p.setting.order, radius(p.setting.size), style));
        }
        for b in baselines {
            dots.push(((b.seconds * 1e3, b.percent), b.order, radius(SCREEN), BLACK.mix(0.9).filled()));
        }
        let of = |order| dots.iter().filter(move |d| d.1 == order);
        chart.draw_series(of(Order::Near).map(|&(at, _, r, style)| Circle::new(at, r, style)))?;
        let square = |&(at, _, r, style): &((f64, f64), Order, i32, ShapeStyle)| {
            EmptyElement::at(at) + Rectangle::new([(-r, -r), (r, r)], style)
        };
        chart.draw_series(of(Order::Random).map(square))?;
        chart.draw_series(of(Order::Far).map(|&(at, _, r, style)| TriangleMarker::new(at, r + 2, style)))?;
        for rule in crate::setting::RULES {
            let style = colour(rule).filled();
            chart
                .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
                .label(rule.name())
                .legend(move |at| Circle::new(at, 4, style));
        }
        if !baselines.is_empty() {
            chart
                .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
                .label("z-buffer of all pixels (HiZ), 1920x1080")
                .legend(|at| Circle::new(at, 4, BLACK.filled()));
        }
        for order in crate::setting::ORDERS {
            let style = ShapeStyle { color: GREY.into(), filled: true, stroke_width: 1 };
            let entry =
                chart.draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?.label(format!("drawn {order}"));
            match order {
                Order::Near => entry.legend(move |at| Circle::new(at, 4, style)),
                Order::Random => entry.legend(move |(x, y)| Rectangle::new([(x - 4, y - 4), (x + 4, y + 4)], style)),
                Order::Far => entry.legend(move |at| TriangleMarker::new(at, 6, style)),
            };
        }
        let hollow = ShapeStyle { color: GREY.into(), filled: false, stroke_width: 1 };
        chart
            .draw_series(std::iter::empty::<Circle<(f64, f64), i32>>())?
            .label("2 or 4 buffers, merged")
            .legend(move |at| Circle::new(at, 4, hollow));
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .legend_area_size(14)
            .label_font(("sans-serif", 13))
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .draw()?;
        Ok(())
    })
}

/// From 2 to 6 pixels.
fn radius(size: (u32, u32)) -> i32 {
    match size.0 {
        0..400 => 2,
        400..800 => 3,
        800..1600 => 4,
        _ => 6,
    }
}

/// Nanoseconds against the size of triangles, both logarithmic: a triangle's, and a pixel's.
pub fn triangle_sizes(rows: &[sizes::Row], libraries: &[String], per_pixel: bool) -> Result<String> {
    let value = |row: &sizes::Row, i| if per_pixel { row.ns_per_pixel(i) } else { row.ns_per_triangle(i) };
    let all = || rows.iter().flat_map(|r| (0..libraries.len()).map(move |i| value(r, i)));
    let up = all().fold(f64::MAX, f64::min) / 1.5..all().fold(0.0, f64::max) * 1.5;
    let (first, last) = (rows.first().map_or(1, |r| r.leg), rows.last().map_or(2, |r| r.leg));
    let colours = [BLUE_OF, ORANGE, GREY, GREEN];
    svg(|root| {
        let mut chart = ChartBuilder::on(root)
            .caption("Right-angled triangles, back to front", ("sans-serif", 20))
            .margin(12)
            .margin_right(24)
            .x_label_area_size(48)
            .y_label_area_size(64)
            .build_cartesian_2d((f64::from(first) / 1.2..f64::from(last) * 1.2).log_scale(), up.log_scale())?;
        chart
            .configure_mesh()
            .x_desc("length of a leg in pixels")
            .y_desc(if per_pixel { "nanoseconds a pixel" } else { "nanoseconds a triangle" })
            .label_style(FONT)
            .light_line_style(BLACK.mix(0.06))
            .draw()?;
        for (i, library) in libraries.iter().enumerate() {
            let colour = colours[i % colours.len()];
            let points = || rows.iter().map(|r| (f64::from(r.leg), value(r, i)));
            chart.draw_series(LineSeries::new(points(), colour.stroke_width(2)))?;
            chart
                .draw_series(points().map(|p| Circle::new(p, 4, colour.filled())))?
                .label(library)
                .legend(move |at| Circle::new(at, 4, colour.filled()));
        }
        let place = if per_pixel { SeriesLabelPosition::UpperRight } else { SeriesLabelPosition::UpperLeft };
        chart
            .configure_series_labels()
            .position(place)
            .legend_area_size(12)
            .label_font(FONT)
            .background_style(WHITE.mix(0.85))
            .border_style(BLACK.mix(0.3))
            .draw()?;
        Ok(())
    })
}
