//! The plots of the page, as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::sizes;
use demo::options::Rule;
use tools::Result;

/// Colours that everybody can distinguish, including the colour-blind.
const BLUE_OF: RGBColor = RGBColor(0, 90, 181);
const ORANGE: RGBColor = RGBColor(220, 90, 0);
const GREEN: RGBColor = RGBColor(0, 140, 90);
const PURPLE: RGBColor = RGBColor(150, 60, 170);
pub const GREY: RGBColor = RGBColor(110, 110, 110);
pub const SIZE: (u32, u32) = (820, 520);
pub const FONT: (&str, i32) = ("sans-serif", 14);

/// The colour of a rule.
pub fn colour(rule: Rule) -> RGBColor {
    match rule {
        Rule::ThreeLayer => BLUE_OF,
        Rule::Quick => ORANGE,
        Rule::Accurate => GREEN,
        Rule::FourLayer => PURPLE,
    }
}

/// An SVG drawing as text.
pub fn svg(draw: impl for<'a> FnOnce(&DrawingArea<SVGBackend<'a>, Shift>) -> Result<()>) -> Result<String> {
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
    }
    Ok(text)
}

/// Nanoseconds per triangle and per pixel against triangle size, on logarithmic axes.
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
            .x_label_formatter(&|v| few(*v))
            .y_label_formatter(&|v| few(*v))
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

/// A label on a logarithmic axis: 1, 2, 5, 10, ...; empty for values in between, whose labels would overlap.
fn few(value: f64) -> String {
    let leading = (value / 10f64.powf((value * 1.0001).log10().floor())).round();
    if [1.0, 2.0, 5.0].contains(&leading) { format!("{}", (value * 1e4).round() / 1e4) } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_numbers_stand_at_an_axis() {
        assert_eq!([0.1, 0.3, 1.0, 2.0, 3.0, 50.0, 90.0, 1000.0].map(few), ["0.1", "", "1", "2", "", "50", "", "1000"]);
    }
}
