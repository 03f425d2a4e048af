//! The central plot of the report: speed against the percentage of hidden objects that are culled.

use plotters::prelude::*;

use crate::plots::{FONT, GREY, SIZE, colour, svg};
use crate::setting::{ORDERS, Order, RULES, SCREEN, Setting, best_isa};
use crate::survey::Survey;
use tools::Result;

/// A full-resolution z-buffer on the same scene: order, seconds, percent of the hidden objects.
pub struct Baseline {
    pub order: Order,
    pub seconds: f64,
    pub percent: f64,
}

/// Width of the legend.
const LEGEND: u32 = 230;

/// The position and style of a setting's point.
#[derive(Clone, Copy)]
struct Dot {
    at: (f64, f64),
    shape: Shape,
    radius: i32,
    style: ShapeStyle,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Circle,
    Square,
    Triangle,
    Cross,
}

impl Shape {
    /// The shape for an order. Other instruction sets and more threads, which cull exactly the same, are crosses.
    fn of(setting: &Setting) -> Self {
        if setting.threads > 1 || setting.isa != best_isa() { Self::Cross } else { setting.order.into() }
    }
}

impl From<Order> for Shape {
    fn from(order: Order) -> Self {
        match order {
            Order::Near => Self::Circle,
            Order::Random => Self::Square,
            Order::Far => Self::Triangle,
        }
    }
}

/// One point per setting. Colour is the rule, shape the order, size the resolution; hollow points have several buffers.
pub fn speed_against_error(survey: &Survey, baselines: &[Baseline]) -> Result<String> {
    let mut dots: Vec<Dot> = Vec::new();
    for p in &survey.points {
        let filled = p.setting.buffers == 1;
        let style = ShapeStyle { color: colour(p.setting.rule).mix(0.85), filled, stroke_width: 1 };
        let at = (p.seconds() * 1e3, p.objects.percent());
        dots.push(Dot { at, shape: Shape::of(&p.setting), radius: radius(p.setting.size), style });
    }
    for b in baselines {
        let (at, style) = ((b.seconds * 1e3, b.percent), BLACK.mix(0.9).filled());
        dots.push(Dot { at, shape: b.order.into(), radius: radius(SCREEN), style });
    }
    let lines = [(survey.exact[0], BLACK), (survey.ceiling[0], GREY)].map(|(share, c)| (share.percent(), c));
    let times = || dots.iter().map(|d| d.at.0);
    let across = times().fold(f64::MAX, f64::min) / 1.3..times().fold(0.0, f64::max) * 1.3;
    let shares = || dots.iter().map(|d| d.at.1).chain(lines.map(|l| l.0));
    let (least, most) = (shares().fold(100.0, f64::min), shares().fold(0.0, f64::max));
    let up = (least - 4.0).max(-1.0)..(most + 4.0).min(102.0);
    let title = format!("{}: {} objects, {} triangles", survey.name, survey.objects, survey.triangles);
    svg(|root| {
        let (left, right) = root.split_horizontally(SIZE.0 - LEGEND);
        let mut chart = ChartBuilder::on(&left)
            .caption(title, ("sans-serif", 20))
            .margin(12)
            .x_label_area_size(48)
            .y_label_area_size(56)
            .build_cartesian_2d(across.clone().log_scale(), up)?;
        chart
            .configure_mesh()
            .x_desc("milliseconds: all views drawn and all queries")
            .y_desc("percent of the hidden objects culled")
            .label_style(FONT)
            .x_labels(20)
            .x_label_formatter(&|v| format!("{}", (v * 100.0).round() / 100.0))
            .light_line_style(BLACK.mix(0.06))
            .draw()?;
        for (y, colour) in lines {
            chart.draw_series(LineSeries::new([(across.start, y), (across.end, y)], colour.stroke_width(1)))?;
        }
        let of = |shape| dots.iter().filter(move |d| d.shape == shape);
        chart.draw_series(of(Shape::Cross).map(|d| Cross::new(d.at, 3, d.style)))?;
        chart.draw_series(of(Shape::Circle).map(|d| Circle::new(d.at, d.radius, d.style)))?;
        let square = |r: i32| [(-r, -r), (r, r)];
        let squares = of(Shape::Square).map(|d| EmptyElement::at(d.at) + Rectangle::new(square(d.radius), d.style));
        chart.draw_series(squares)?;
        chart.draw_series(of(Shape::Triangle).map(|d| TriangleMarker::new(d.at, d.radius + 2, d.style)))?;

        let mut y = 60;
        let mut entry = |text: &str, shape: Option<Shape>, style: ShapeStyle| -> Result<()> {
            match shape {
                None => right.draw(&PathElement::new([(6, y), (20, y)], style))?,
                Some(Shape::Circle) => right.draw(&Circle::new((13, y), 4, style))?,
                Some(Shape::Square) => right.draw(&Rectangle::new([(9, y - 4), (17, y + 4)], style))?,
                Some(Shape::Triangle) => right.draw(&TriangleMarker::new((13, y), 6, style))?,
                Some(Shape::Cross) => right.draw(&Cross::new((13, y), 3, style))?,
            }
            right.draw(&Text::new(text.to_owned(), (28, y - 7), ("sans-serif", 13)))?;
            y += 21;
            Ok(())
        };
        for rule in RULES {
            entry(rule.name(), Some(Shape::Circle), colour(rule).filled())?;
        }
        entry("z-buffer of all pixels (HiZ)", Some(Shape::Circle), BLACK.filled())?;
        for order in ORDERS {
            entry(&format!("drawn {order}"), Some(order.into()), GREY.filled())?;
        }
        let hollow = ShapeStyle { color: GREY.into(), filled: false, stroke_width: 1 };
        entry("2 or 4 buffers, merged", Some(Shape::Circle), hollow)?;
        entry("other instruction sets, threads", Some(Shape::Cross), GREY.filled())?;
        entry("exact z-buffer", None, BLACK.stroke_width(1))?;
        entry("least depth of each 8x4", None, GREY.stroke_width(1))?;
        right.draw(&Text::new("small dots: small buffers", (6, y), ("sans-serif", 13)))?;
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
