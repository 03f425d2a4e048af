//! The subjects of the measurement: scenes, each with several views, and small boxes scattered over it.

use std::path::Path;

use fastrand::Rng;
use glam::{Mat4, Vec3, vec3};

use crate::{blocks, file_cameras, hall};
use demo::camera::{Camera, in_view};
use demo::scene::{Object, Scene};
use demo::{load, split, town};
use tools::Result;
use tools::merging::landscape::{self, Landscape};
use tools::rectangle::rectangle;

/// All screens are 16 to 9.
pub const ASPECT: f32 = 16.0 / 9.0;
/// Number of boxes scattered over a scene for each view; some are out of view.
const BOXES: usize = 3_000;
/// Number of views for a file without cameras.
const VIEWS: usize = 3;

pub struct Subject {
    pub name: String,
    pub objects: Vec<Object>,
    pub views: Vec<View>,
}

/// A camera position.
pub struct View {
    pub clip: Mat4,
    pub near: f32,
}

/// The rectangle of a tested object on the screen, with its minimum w. Objects that cross the near plane have none, and
/// are not tested.
pub type Rectangle = Option<[f32; 5]>;

impl Subject {
    pub fn generated() -> Vec<Self> {
        let views =
            |places: &[(Vec3, Vec3)], near| places.iter().map(|&(eye, look)| View::new(eye, look, near)).collect();
        let (eye, look) = town::camera();
        let landscape = Landscape::generate(ASPECT, 0);
        let of_landscape = View { clip: landscape.clip_from_world, near: landscape::NEAR };
        let subject = |name: &str, objects, views| Self { name: name.into(), objects, views };
        vec![
            subject(
                "town",
                town::generate().objects,
                views(
                    &[
                        (eye, look),
                        (vec3(-75.0, 48.0, 190.0), vec3(10.0, 0.0, -60.0)),
                        (vec3(31.0, 2.0, -30.0), vec3(-40.0, 6.0, 120.0)),
                    ],
                    0.1,
                ),
            ),
            subject(
                "landscape",
                landscape.terrain.into_iter().chain(landscape.foreground).collect(),
                vec![of_landscape],
            ),
            subject("blocks", blocks::generate().objects, views(&blocks::PLACES, 0.1)),
            subject("hall", hall::generate().objects, views(&hall::PLACES, 0.1)),
        ]
    }

    /// The scene in a file; large meshes are split, as in the demo.
    pub fn load(path: &Path) -> Result<Self> {
        if path.extension().is_some_and(|e| e == "mocrec") {
            return Err(format!("{}: a recording has no objects to test; `replay` plays it", path.display()).into());
        }
        let scene = load::load(path)?;
        let piece = split::piece_size(&scene);
        let scene = split::split(scene, piece);
        let mut views = file_cameras::read(path)?;
        if views.is_empty() {
            views = chosen(&scene);
        }
        let name = path.file_stem().map_or_else(|| path.display().to_string(), |s| s.to_string_lossy().into());
        Ok(Self { name, objects: scene.objects, views })
    }

    pub fn triangles(&self) -> usize {
        self.objects.iter().map(|o| o.mesh.triangles.len()).sum()
    }

    /// The rectangles of all objects in a view, by object. Those out of view have none either: an engine culls them
    /// beforehand.
    pub fn rectangles(&self, view: &View) -> Vec<Rectangle> {
        let in_view = |o: &Object| in_view(o.lo, o.hi, &view.clip);
        self.objects
            .iter()
            .map(|o| in_view(o).then(|| rectangle(o.lo, o.hi, &view.clip, view.near)).flatten())
            .collect()
    }

    /// Boxes of half a percent of the scene's size, at random positions at least partly on the screen.
    pub fn boxes(&self, view: &View) -> Vec<Rectangle> {
        let (lo, hi) = demo::scene::bounds(self.objects.iter().flat_map(|o| [o.lo, o.hi]));
        let size = (hi - lo).length();
        let mut random = Rng::with_seed(11);
        let mut within = |lo: f32, hi: f32| lo + (hi - lo) * random.f32();
        let boxes = (0..BOXES).filter_map(|_| {
            let middle = vec3(within(lo.x, hi.x), within(lo.y, hi.y), within(lo.z, hi.z));
            let half = vec3(within(0.5, 1.5), within(0.5, 1.5), within(0.5, 1.5)) * size * 0.0025;
            let (lo, hi) = (middle - half, middle + half);
            in_view(lo, hi, &view.clip).then(|| rectangle(lo, hi, &view.clip, view.near)).flatten()
        });
        boxes.map(Some).collect()
    }
}

impl View {
    fn new(eye: Vec3, look: Vec3, near: f32) -> Self {
        Self::of(&Camera { eye, look, up: Vec3::Y, fov: 1.0, near, aspect: ASPECT })
    }

    pub fn of(camera: &Camera) -> Self {
        Self { clip: camera.clip_from_world(), near: camera.near }
    }
}

/// The views with the most to see and to cull, from different positions.
fn chosen(scene: &Scene) -> Vec<View> {
    let (lo, hi) = scene.bounds();
    let size = (hi - lo).length();
    let camera = Camera { eye: lo, look: hi, up: Vec3::Y, fov: 1.0, near: size * 2e-4, aspect: ASPECT };
    let mut eyes: Vec<Vec3> = Vec::new();
    let mut views = Vec::new();
    for (eye, look) in camera.ranked(scene, None) {
        if views.len() < VIEWS && eyes.iter().all(|e| e.distance(eye) > 0.1 * size) {
            eyes.push(eye);
            views.push(View::of(&Camera { eye, look, ..camera }));
        }
    }
    if views.is_empty() {
        let mut camera = camera;
        camera.choose(scene, None);
        views.push(View::of(&camera));
    }
    views
}
