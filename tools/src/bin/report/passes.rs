//! The passes of a frame: table 1 of the HPG 2016 paper, comparing a full-resolution hierarchical z-buffer with the
//! masked buffer.
//!
//! The library draws in one pass, without intermediate lists in memory. To time its passes separately, vertices are
//! transformed with `transform_vertices` (Geom), culled and projected into a list with `bin_triangles` and a single bin
//! (Proj), and drawn from it (Rast); the last column has the frame as an engine draws it, in one pass.

use std::time::Instant;

use masked_occlusion_culling::{DrawOptions, MaskedOcclusionCulling, Settings, TriList, Vertices, transform_vertices};

use crate::baseline;
use crate::frame::{LAYOUT, Occluder, occluders};
use crate::hiz::Hiz;
use crate::setting::{Order, SCREEN};
use crate::subject::{Rectangle, Subject, View};
use crate::survey::median;
use demo::options::Rule;
use tools::Result;

/// Clear, Geom, Proj, Rast, Gen, Test.
pub const PASSES: [&str; 6] = ["clear", "geometry", "projection", "raster", "generate", "test"];

pub struct Row {
    pub name: String,
    /// Seconds, medians.
    pub passes: [f64; 6],
    /// Drawn and tested in one pass.
    pub frame: f64,
    /// Number of objects and boxes that are culled.
    pub culled: usize,
}

impl Row {
    pub fn total(&self) -> f64 {
        self.passes.iter().sum()
    }
}

/// Seconds since the last lap.
struct Laps(Instant);

impl Laps {
    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        now.duration_since(std::mem::replace(&mut self.0, now)).as_secs_f64()
    }
}

/// Measures the ways alternately, repeatedly, on the first view of a scene, nearest first.
pub fn study(subject: &Subject, repeats: u32) -> Result<Vec<Row>> {
    let view = &subject.views[0];
    let occluders = occluders(subject, view, Order::Near);
    let tested: Vec<Rectangle> = subject.rectangles(view).into_iter().chain(subject.boxes(view)).collect();
    let mut ways = [
        Way::new("z-buffer of all pixels (HiZ)", Kind::Hiz(Box::new(Hiz::new(SCREEN.0, SCREEN.1))), &occluders),
        Way::new("masked, three layers", masked(Rule::ThreeLayer, view)?, &occluders),
        Way::new("masked, quick", masked(Rule::Quick, view)?, &occluders),
    ];
    for turn in 0..=repeats {
        for way in &mut ways {
            let (passes, culled) = way.in_passes(&occluders, &tested, view)?;
            let frame = way.in_one_go(&occluders, &tested, view)?;
            if turn > 0 {
                way.times.iter_mut().zip(passes.into_iter().chain([frame])).for_each(|(times, t)| times.push(t));
            }
            way.culled = culled;
        }
    }
    Ok(ways.into_iter().map(Way::row).collect())
}

fn masked(rule: Rule, view: &View) -> Result<Kind> {
    let settings = Settings::default().with_update_rule(rule.into());
    let mut moc = MaskedOcclusionCulling::new(SCREEN.0, SCREEN.1, settings)?;
    moc.set_near_clip_plane(view.near)?;
    Ok(Kind::Masked(Box::new(moc)))
}

enum Kind {
    Hiz(Box<Hiz>),
    Masked(Box<MaskedOcclusionCulling>),
}

struct Way {
    name: &'static str,
    kind: Kind,
    /// Clip-space vertices of every occluder, and the list's memory.
    clip: Vec<Vec<[f32; 4]>>,
    list: Vec<f32>,
    times: [Vec<f64>; 7],
    culled: usize,
}

impl Way {
    fn new(name: &'static str, kind: Kind, occluders: &[Occluder]) -> Self {
        let triangles: usize = occluders.iter().map(|o| o.indices.len() / 3).sum();
        Self {
            name,
            kind,
            clip: occluders.iter().map(|o| vec![[0.0; 4]; o.vertices().len()]).collect(),
            // Clipping may turn a triangle into several.
            list: vec![0.0; 9 * 2 * (triangles + 1000)],
            times: [const { Vec::new() }; 7],
            culled: 0,
        }
    }

    /// The time of each pass, and the number of culled objects and boxes.
    fn in_passes(&mut self, occluders: &[Occluder], tested: &[Rectangle], view: &View) -> Result<([f64; 6], usize)> {
        let mut t = [0.0; 6];
        let mut laps = Laps(Instant::now());
        match &mut self.kind {
            Kind::Hiz(hiz) => {
                hiz.set_near(view.near);
                laps.lap();
                hiz.clear();
                t[0] = laps.lap();
                for o in occluders {
                    hiz.winding = o.winding();
                    laps.lap();
                    hiz.transform(o.vertices(), &view.clip);
                    t[1] += laps.lap();
                    hiz.project(&o.indices);
                    t[2] += laps.lap();
                }
                laps.lap();
                hiz.raster();
                t[3] = laps.lap();
                hiz.generate();
                t[4] = laps.lap();
            }
            Kind::Masked(moc) => {
                moc.clear_buffer();
                t[0] = laps.lap();
                let mut lists = [TriList::new(&mut self.list)];
                for (o, clip) in occluders.iter().zip(&mut self.clip) {
                    laps.lap();
                    transform_vertices(view.clip, o.vertices().as_flattened(), LAYOUT, clip)?;
                    t[1] += laps.lap();
                    let options = DrawOptions::default().with_winding(o.winding());
                    moc.bin_triangles(Vertices::clip_space(clip), &o.indices, &mut lists, 1, 1, &options)?;
                    t[2] += laps.lap();
                }
                laps.lap();
                moc.render_trilist(&lists[0], None)?;
                t[3] = laps.lap();
            }
        }
        laps.lap();
        let culled = self.test(tested)?;
        t[5] = laps.lap();
        Ok((t, culled))
    }

    /// The time of the frame as an engine draws it.
    fn in_one_go(&mut self, occluders: &[Occluder], tested: &[Rectangle], view: &View) -> Result<f64> {
        let start = Instant::now();
        match &mut self.kind {
            Kind::Hiz(hiz) => {
                hiz.clear();
                baseline::draw(hiz, occluders, view);
                hiz.generate();
            }
            Kind::Masked(moc) => {
                moc.clear_buffer();
                occluders.iter().try_for_each(|o| o.draw(moc))?;
            }
        }
        self.test(tested)?;
        Ok(start.elapsed().as_secs_f64())
    }

    fn test(&self, tested: &[Rectangle]) -> Result<usize> {
        let mut culled = 0;
        for &[x_min, y_min, x_max, y_max, w] in tested.iter().flatten() {
            culled += usize::from(match &self.kind {
                Kind::Hiz(hiz) => hiz.test_rect(x_min, y_min, x_max, y_max, w),
                Kind::Masked(moc) => crate::frame::is_hidden(moc, [x_min, y_min, x_max, y_max, w]),
            });
        }
        Ok(culled)
    }

    fn row(mut self) -> Row {
        let medians = self.times.each_mut().map(|times| median(times));
        let [clear, geometry, projection, raster, generate, test, frame] = medians;
        Row {
            name: self.name.into(),
            passes: [clear, geometry, projection, raster, generate, test],
            frame,
            culled: self.culled,
        }
    }
}
