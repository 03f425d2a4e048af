//! Draws a landscape both ways, alternately, and measures the times.

use std::time::{Duration, Instant};

use masked_occlusion_culling::{
    CullingResult, DrawOptions, Error, MaskedOcclusionCulling, Matrix, Settings, UpdateRule, Vertices,
};

use super::landscape::{Landscape, NEAR};
use super::truth::Truth;
use demo::scene::Object;

/// Times are medians, in seconds.
pub struct Measured {
    /// Everything into one buffer.
    pub one: f64,
    /// Each part, as measured on its thread.
    pub terrain: f64,
    pub foreground: f64,
    /// Both parts, from the start of the threads to the end of the slower one.
    pub both: f64,
    pub merge: f64,
    /// Number of hidden boxes culled by the single buffer, and by the merged one.
    pub culled_one: usize,
    pub culled_two: usize,
    /// Number of boxes culled by either that are not hidden.
    pub falsely: usize,
}

/// An object in the form that the library takes.
struct Drawn {
    positions: Vec<[f32; 3]>,
    triangles: Vec<u32>,
}

impl Drawn {
    fn all(objects: &[Object]) -> Vec<Self> {
        let drawn = |o: &Object| Self {
            positions: o.mesh.positions.iter().map(|p| p.to_array()).collect(),
            triangles: o.mesh.triangles.as_flattened().to_vec(),
        };
        objects.iter().map(drawn).collect()
    }
}

pub fn measure(
    landscape: &Landscape,
    truth: &Truth,
    (width, height): (u32, u32),
    update_rule: UpdateRule,
    repeats: u32,
) -> Result<Measured, Error> {
    let buffer = || -> Result<_, Error> {
        let settings = Settings::default().with_update_rule(update_rule);
        let mut moc = MaskedOcclusionCulling::new(width, height, settings)?;
        moc.set_near_clip_plane(NEAR)?;
        Ok(moc)
    };
    let (mut one, mut merged, mut other) = (buffer()?, buffer()?, buffer()?);
    let (terrain, foreground) = (Drawn::all(&landscape.terrain), Drawn::all(&landscape.foreground));
    let pick = |&(is_terrain, i): &(bool, usize)| if is_terrain { &terrain[i] } else { &foreground[i] };
    let interleaved: Vec<&Drawn> = landscape.interleaved.iter().map(pick).collect();
    let matrix = Matrix::from(landscape.clip_from_world);

    let mut times = [const { Vec::new() }; 5];
    // The first round touches memory that the system has not mapped yet: it is not counted.
    for turn in 0..=repeats {
        let all = draw(&mut one, interleaved.iter().copied(), matrix)?;

        let start = Instant::now();
        let (far, near) = std::thread::scope(|scope| {
            let far = scope.spawn(|| draw(&mut other, terrain.iter(), matrix));
            let near = scope.spawn(|| draw(&mut merged, foreground.iter(), matrix));
            (far.join().expect("drawing does not panic"), near.join().expect("drawing does not panic"))
        });
        let both = start.elapsed();
        let start = Instant::now();
        merged.merge_buffer(&other)?;
        let merge = start.elapsed();

        if turn > 0 {
            for (times, time) in times.iter_mut().zip([all, far?, near?, both, merge]) {
                times.push(time);
            }
        }
    }

    let (mut culled, mut falsely) = ([0; 2], 0);
    for (i, &[x_min, y_min, x_max, y_max, w]) in landscape.boxes.iter().enumerate() {
        let mut by_either = false;
        for (moc, culled) in [&one, &merged].into_iter().zip(&mut culled) {
            let is_culled = moc.test_rect(x_min, y_min, x_max, y_max, w) == CullingResult::Occluded;
            *culled += usize::from(is_culled && truth.is_hidden[i]);
            by_either |= is_culled;
        }
        falsely += usize::from(by_either && !truth.may_be_hidden[i]);
    }
    let [one, terrain, foreground, both, merge] = times.map(median);
    Ok(Measured { one, terrain, foreground, both, merge, culled_one: culled[0], culled_two: culled[1], falsely })
}

/// Clears the buffer and draws objects; returns the time taken.
fn draw<'d>(
    moc: &mut MaskedOcclusionCulling,
    objects: impl Iterator<Item = &'d Drawn>,
    matrix: Matrix,
) -> Result<Duration, Error> {
    let start = Instant::now();
    moc.clear_buffer();
    for object in objects {
        let vertices = Vertices::model_space(&object.positions, matrix);
        moc.render_triangles(vertices, &object.triangles, &DrawOptions::default())?;
    }
    Ok(start.elapsed())
}

/// The median, in seconds; the upper one of the two middle values for an even count.
fn median(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times[times.len() / 2].as_secs_f64()
}
