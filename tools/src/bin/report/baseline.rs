//! The full-resolution z-buffer as a subject of measurement, for comparison with the library.

use std::collections::HashMap;
use std::time::Instant;

use glam::Mat4;

use crate::frame::{Occluder, occluders};
use crate::hiz::Hiz;
use crate::scatter::Baseline;
use crate::setting::{ORDERS, SCREEN};
use crate::subject::{Rectangle, Subject, View};
use crate::survey::{Share, median};
use crate::visibility::Visibility;
use tools::Result;
use tools::scaling::culler::Culler;
use tools::scaling::mesh::Mesh;

/// For the studies of cost.
pub struct HizCuller {
    hiz: Hiz,
    near: f32,
    /// The vertices of the meshes drawn so far, in the form that this buffer reads.
    positions: HashMap<*const [f32; 4], Vec<[f32; 4]>>,
}

impl HizCuller {
    pub fn new() -> Self {
        Self { hiz: Hiz::new(8, 8), near: 0.0, positions: HashMap::new() }
    }
}

impl Culler for HizCuller {
    fn name(&self) -> String {
        format!("z-buffer of all pixels ({:?})", self.hiz.level()).to_lowercase()
    }

    fn set_size(&mut self, width: u32, height: u32) -> Result<()> {
        self.hiz = Hiz::new(width, height);
        self.positions.clear();
        Ok(())
    }

    fn set_near(&mut self, near: f32) {
        self.near = near;
    }

    fn clear(&mut self) {
        self.hiz.clear();
    }

    fn draw(&mut self, mesh: &Mesh, model_to_clip: &Mat4) {
        // Built in the first frame, which is not timed. A mesh lives as long as its scene, and the size is set again
        // for each scene.
        let made = || mesh.vertices().iter().map(|&[x, y, _, z]| [x, y, z, 1.0]).collect();
        let positions = self.positions.entry(mesh.vertices().as_ptr()).or_insert_with(made);
        let hiz = &mut self.hiz;
        hiz.set_near(self.near);
        hiz.transform(positions, model_to_clip);
        hiz.project(mesh.indices());
        hiz.raster();
    }

    fn finish(&mut self) {
        self.hiz.generate();
    }

    fn hides(&self, [x_min, y_min, x_max, y_max]: [f32; 4], w: f32) -> bool {
        self.hiz.test_rect(x_min, y_min, x_max, y_max, w)
    }
}

/// Draws all occluders, one after another.
pub fn draw(hiz: &mut Hiz, occluders: &[Occluder], view: &View) {
    for o in occluders {
        hiz.winding = o.winding();
        hiz.transform(o.vertices(), &view.clip);
        hiz.project(&o.indices);
        hiz.raster();
    }
}

/// Culls a scene's hidden objects with this buffer at screen resolution, for each order.
pub fn survey(subject: &Subject, repeats: u32, mut tick: impl FnMut()) -> Result<Vec<Baseline>> {
    let mut found: Vec<(f64, Share)> = vec![(0.0, Share::default()); ORDERS.len()];
    for view in &subject.views {
        let (objects, boxes) = (subject.rectangles(view), subject.boxes(view));
        let all: Vec<Rectangle> = objects.iter().chain(&boxes).copied().collect();
        let truth = Visibility::new(subject, view, &boxes, SCREEN);
        for (order, found) in ORDERS.into_iter().zip(&mut found) {
            let occluders = occluders(subject, view, order);
            let mut hiz = Hiz::new(SCREEN.0, SCREEN.1);
            hiz.set_near(view.near);
            let (mut times, mut hidden) = (Vec::new(), Vec::new());
            for turn in 0..=repeats {
                let start = Instant::now();
                hiz.clear();
                draw(&mut hiz, &occluders, view);
                hiz.generate();
                hidden.clear();
                hidden.extend(all.iter().map(|r| r.is_some_and(|[a, b, c, d, w]| hiz.test_rect(a, b, c, d, w))));
                if turn > 0 {
                    times.push(start.elapsed().as_secs_f64());
                }
            }
            found.0 += median(&mut times);
            let share = Share::of(&truth.hidden_objects, hidden[..objects.len()].iter().copied());
            found.1.add(share);
            tick();
        }
    }
    let baselines = ORDERS.into_iter().zip(found);
    Ok(baselines.map(|(order, (seconds, share))| Baseline { order, seconds, percent: share.percent() }).collect())
}
