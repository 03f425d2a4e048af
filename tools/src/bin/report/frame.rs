//! Draws frames of a view with one setting, and runs the queries.

use std::time::Instant;

use masked_occlusion_culling::{
    BackfaceWinding, CullingResult, CullingThreadpool, DrawOptions, Error, MaskedOcclusionCulling, Matrix,
    ModelSpaceLayout, Settings, ThreadpoolSettings, Vertices,
};

use crate::setting::{Order, Setting};
use crate::subject::{Rectangle, Subject, View};
use demo::camera::in_view;
use demo::scene::Object;
use tools::Result;

/// An occluder in the form that the library reads fastest: x, y, z and padding, 16 bytes per vertex.
pub struct Occluder {
    vertices: Vec<[f32; 4]>,
    pub indices: Vec<u32>,
    matrix: Matrix,
    options: DrawOptions,
    /// The minimum and maximum w of its box.
    nearest: f32,
    farthest: f32,
}

/// The layout of [`Occluder::vertices`].
pub const LAYOUT: ModelSpaceLayout = ModelSpaceLayout::XYZ_PADDED;

impl Occluder {
    fn new(object: &Object, view: &View) -> Self {
        let winding = if object.two_sided { BackfaceWinding::None } else { BackfaceWinding::Clockwise };
        let w = demo::camera::box_corners(object.lo, object.hi).map(|p| (view.clip * p.extend(1.0)).w);
        Self {
            vertices: object.mesh.positions.iter().map(|p| p.extend(1.0).to_array()).collect(),
            indices: object.mesh.triangles.as_flattened().to_vec(),
            matrix: view.clip.into(),
            options: DrawOptions::default().with_winding(winding),
            nearest: w.into_iter().fold(f32::INFINITY, f32::min).max(view.near),
            farthest: w.into_iter().fold(view.near, f32::max),
        }
    }

    pub fn vertices(&self) -> &[[f32; 4]] {
        &self.vertices
    }

    pub fn winding(&self) -> BackfaceWinding {
        self.options.winding
    }

    fn source(&self) -> Result<Vertices<'_>, Error> {
        Vertices::new(self.vertices.as_flattened(), LAYOUT.with_matrix(self.matrix))
    }

    pub fn draw(&self, moc: &mut MaskedOcclusionCulling) -> Result<(), Error> {
        moc.render_triangles(self.source()?, &self.indices, &self.options).map(drop)
    }
}

/// The occluders in view, in drawing order.
pub fn occluders(subject: &Subject, view: &View, order: Order) -> Vec<Occluder> {
    let in_view = |o: &&Object| o.occluder && in_view(o.lo, o.hi, &view.clip);
    let mut all: Vec<Occluder> = subject.objects.iter().filter(in_view).map(|o| Occluder::new(o, view)).collect();
    match order {
        Order::Near => all.sort_by(|a, b| a.nearest.total_cmp(&b.nearest)),
        Order::Far => all.sort_by(|a, b| b.nearest.total_cmp(&a.nearest)),
        Order::Random => fastrand::Rng::with_seed(3).shuffle(&mut all),
    }
    all
}

/// Distributes occluders over buffers, preserving their order. An occluder that spans a wide range of depth cannot be
/// sorted among the objects within that range, which is why the article on merging has a separate buffer for terrain:
/// here the first buffer gets the occluders with the smallest depth range, the last those with the largest, with the
/// same number of triangles in each.
fn deal(occluders: &[Occluder], buffers: usize) -> Vec<Vec<&Occluder>> {
    let reach = |o: &Occluder| o.farthest / o.nearest;
    let mut by_reach: Vec<usize> = (0..occluders.len()).collect();
    by_reach.sort_by(|&a, &b| reach(&occluders[a]).total_cmp(&reach(&occluders[b])));
    let total: usize = occluders.iter().map(|o| o.indices.len()).sum();
    let (mut buffer_of, mut sum) = (vec![0; occluders.len()], 0);
    for i in by_reach {
        buffer_of[i] = (sum * buffers / total.max(1)).min(buffers - 1);
        sum += occluders[i].indices.len();
    }
    let of = |buffer| occluders.iter().zip(&buffer_of).filter(move |(_, b)| **b == buffer).map(|(o, _)| o);
    (0..buffers).map(|buffer| of(buffer).collect()).collect()
}

/// Draws frames with a setting.
pub struct Frames<'a> {
    lists: Vec<Vec<&'a Occluder>>,
    buffers: Vec<MaskedOcclusionCulling>,
    /// The pool, if several threads draw into one buffer.
    pool: Option<CullingThreadpool>,
    threads: usize,
}

impl<'a> Frames<'a> {
    pub fn new(setting: &Setting, occluders: &'a [Occluder], near: f32) -> Result<Self> {
        let settings =
            Settings::default().with_implementation(setting.isa.into()).with_update_rule(setting.rule.into());
        let buffer = |_| -> Result<_> {
            let mut moc = MaskedOcclusionCulling::new(setting.size.0, setting.size.1, settings)?;
            moc.set_near_clip_plane(near)?;
            Ok(moc)
        };
        let pool = (setting.threads > 1 && setting.buffers == 1).then(|| -> Result<_> {
            // The flushing thread draws, too.
            let settings = ThreadpoolSettings::default().with_threads(setting.threads - 1);
            let pool = CullingThreadpool::new(settings.with_bins(4, 16).with_max_jobs(64))?;
            pool.wake_threads();
            Ok(pool)
        });
        Ok(Self {
            lists: deal(occluders, setting.buffers),
            buffers: (0..setting.buffers).map(buffer).collect::<Result<_>>()?,
            pool: pool.transpose()?,
            threads: setting.threads as usize,
        })
    }

    /// Clears, draws, merges; returns the seconds taken.
    pub fn draw(&mut self) -> Result<f64> {
        if let Some(pool) = &self.pool {
            pool.set_buffer(self.buffers.pop().ok_or("the pool still has the buffer")?);
            let start = Instant::now();
            pool.clear_buffer()?;
            pool.scope(|scope| {
                let mut list = self.lists[0].iter();
                list.try_for_each(|o| scope.render_triangles(o.source()?, &o.indices, &o.options))
            })?;
            let seconds = start.elapsed().as_secs_f64();
            self.buffers.extend(pool.take_buffer());
            return Ok(seconds);
        }
        let start = Instant::now();
        let mut jobs: Vec<_> = self.buffers.iter_mut().zip(&self.lists).collect();
        if self.threads == 1 {
            jobs.into_iter().try_for_each(|(moc, list)| draw_list(moc, list))?;
        } else {
            std::thread::scope(|scope| {
                let share = jobs.len().div_ceil(self.threads);
                let threads: Vec<_> = jobs
                    .chunks_mut(share)
                    .map(|jobs| scope.spawn(|| jobs.iter_mut().try_for_each(|(moc, list)| draw_list(moc, list))))
                    .collect();
                threads.into_iter().try_for_each(|t| t.join().expect("drawing does not panic"))
            })?;
        }
        if let Some((first, others)) = self.buffers.split_first_mut()
            && !others.is_empty()
        {
            first.merge_buffers(&others.iter().collect::<Vec<_>>())?;
        }
        Ok(start.elapsed().as_secs_f64())
    }

    /// Tests every rectangle; returns which are hidden, and the seconds taken. Objects without a rectangle may be
    /// visible.
    pub fn test(&self, rectangles: &[Rectangle], hidden: &mut Vec<bool>) -> Result<f64> {
        let moc = self.result();
        hidden.clear();
        let start = Instant::now();
        for rectangle in rectangles {
            hidden.push(match rectangle {
                Some(rectangle) => is_hidden(moc, *rectangle),
                None => false,
            });
        }
        Ok(start.elapsed().as_secs_f64())
    }

    /// The buffer with the complete frame.
    pub fn result(&self) -> &MaskedOcclusionCulling {
        &self.buffers[0]
    }
}

fn draw_list(moc: &mut MaskedOcclusionCulling, list: &[&Occluder]) -> Result<(), Error> {
    moc.clear_buffer();
    list.iter().try_for_each(|o| o.draw(moc))
}

/// Whether a rectangle at w is hidden, and not only out of view.
pub fn is_hidden(moc: &MaskedOcclusionCulling, [x_min, y_min, x_max, y_max, w]: [f32; 5]) -> bool {
    moc.test_rect(x_min, y_min, x_max, y_max, w) == CullingResult::Occluded
}
