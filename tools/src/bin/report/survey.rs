//! Measures settings on a scene: time, how much of the hidden geometry is culled, and false culls.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::frame::{Frames, occluders};
use crate::leaks::leaking;
use crate::setting::{ORDERS, Order, SCREEN, Setting};
use crate::subject::{Rectangle, Subject};
use crate::visibility::Visibility;
use tools::Result;
use tools::rectangle::hides;

/// A fraction, as two counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    pub part: usize,
    pub whole: usize,
}

impl Share {
    pub fn percent(self) -> f64 {
        100.0 * self.part as f64 / self.whole.max(1) as f64
    }

    /// Counts how many of those that are `wanted` are `found`.
    pub fn of(wanted: &[bool], found: impl Iterator<Item = bool>) -> Self {
        let found: Vec<bool> =
            wanted.iter().zip(found).filter(|(wanted, _)| **wanted).map(|(_, found)| found).collect();
        Self { part: found.iter().filter(|f| **f).count(), whole: found.len() }
    }

    pub fn add(&mut self, other: Self) {
        self.part += other.part;
        self.whole += other.whole;
    }
}

/// The results of a setting, over all views.
#[derive(Clone, Debug)]
pub struct Point {
    pub setting: Setting,
    /// Sums of the medians over the views, in seconds: clear, draw, merge; then the queries.
    pub draw: f64,
    pub query: f64,
    /// The fraction of objects not visible on the screen that is culled.
    pub objects: Share,
    pub boxes: Share,
    /// Objects and boxes that are culled although they are visible at the buffer's own resolution: guaranteed to be 0.
    pub falsely: usize,
    /// Objects that are culled but visible on the screen, which has more pixels than a small buffer.
    pub on_screen: usize,
    /// Pixels whose stored depth is less than half of the true depth.
    pub leaks: Share,
}

impl Point {
    pub fn seconds(&self) -> f64 {
        self.draw + self.query
    }
}

/// A scene and its results.
pub struct Survey {
    pub name: String,
    pub objects: usize,
    pub triangles: usize,
    pub points: Vec<Point>,
    /// Hidden objects and boxes culled by an exact z-buffer at screen resolution, and by one reduced to the least depth
    /// of each 8x4 pixels.
    pub exact: [Share; 2],
    pub ceiling: [Share; 2],
    /// The number of groups of settings that must give the same bits, and of those that do not.
    pub same_bits: usize,
    pub other_bits: usize,
}

/// Measures all settings; `tick` is called for each setting and view.
pub fn survey(subject: &Subject, settings: &[Setting], repeats: u32, mut tick: impl FnMut()) -> Result<Survey> {
    let mut survey = Survey {
        name: subject.name.clone(),
        objects: subject.objects.len(),
        triangles: subject.triangles(),
        points: settings.iter().map(Point::new).collect(),
        exact: Default::default(),
        ceiling: Default::default(),
        same_bits: 0,
        other_bits: 0,
    };
    for view in &subject.views {
        let (objects, boxes) = (subject.rectangles(view), subject.boxes(view));
        let all: Vec<Rectangle> = objects.iter().chain(&boxes).copied().collect();
        let truth = |size| Visibility::new(subject, view, &boxes, size);
        let screen = truth(SCREEN);
        let blocks = screen.blocks();
        for (shares, buffer) in [(&mut survey.exact, &screen.exact), (&mut survey.ceiling, &blocks)] {
            let found = |r: &Rectangle| r.is_some_and(|r| hides(buffer, &r, view.near, 1.0, 0.0));
            shares[0].add(Share::of(&screen.hidden_objects, objects.iter().map(found)));
            shares[1].add(Share::of(&screen.hidden_boxes, boxes.iter().map(found)));
        }
        let mut own: HashMap<(u32, u32), Visibility> = HashMap::new();
        let by_order = ORDERS.map(|order| (order, occluders(subject, view, order)));
        let of_order = |order: Order| by_order.iter().find(|o| o.0 == order).map(|o| &o.1[..]).unwrap_or_default();
        let mut bits: HashMap<Setting, u64> = HashMap::new();
        for point in &mut survey.points {
            let setting = point.setting;
            let own = match setting.size {
                SCREEN => &screen,
                size => own.entry(size).or_insert_with(|| truth(size)),
            };
            let mut frames = Frames::new(&setting, of_order(setting.order), view.near)?;
            let (mut draws, mut queries, mut hidden) = (Vec::new(), Vec::new(), Vec::new());
            // The first frame touches memory that the system has not mapped yet: it is not counted.
            for turn in 0..=repeats {
                let times = (frames.draw()?, frames.test(&all, &mut hidden)?);
                if turn > 0 {
                    draws.push(times.0);
                    queries.push(times.1);
                }
            }
            point.draw += median(&mut draws);
            point.query += median(&mut queries);
            let (of_objects, of_boxes) = hidden.split_at(objects.len());
            let both = |a: &[bool], b: &[bool]| a.iter().zip(b).filter(|(a, b)| **a && **b).count();
            point.objects.add(Share::of(&screen.hidden_objects, of_objects.iter().copied()));
            point.boxes.add(Share::of(&screen.hidden_boxes, of_boxes.iter().copied()));
            point.falsely += both(of_objects, &own.showing_objects);
            point.falsely +=
                of_boxes.iter().zip(&own.may_hide_boxes).filter(|(culled, may)| **culled && !**may).count();
            point.on_screen += both(of_objects, &screen.showing_objects);

            let mut depth = vec![0.0; (setting.size.0 * setting.size.1) as usize];
            frames.result().compute_pixel_depth_buffer(&mut depth, false)?;
            point.leaks.add(leaking(&depth, &own.exact, view.near));
            let mut hasher = DefaultHasher::new();
            depth.iter().for_each(|d| d.to_bits().hash(&mut hasher));
            hidden.hash(&mut hasher);
            let hash = hasher.finish();
            match bits.get(&setting.bits()) {
                None => drop(bits.insert(setting.bits(), hash)),
                Some(known) if *known == hash => survey.same_bits += 1,
                Some(_) => survey.other_bits += 1,
            }
            tick();
        }
    }
    Ok(survey)
}

impl Point {
    fn new(setting: &Setting) -> Self {
        Self {
            setting: *setting,
            draw: 0.0,
            query: 0.0,
            objects: Share::default(),
            boxes: Share::default(),
            falsely: 0,
            on_screen: 0,
            leaks: Share::default(),
        }
    }
}

/// The median; the upper one of the two middle values for an even count.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
