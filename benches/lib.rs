//! Shared by benches and tools: objects, scenes in an order, and drawing them.

#[path = "../tests/scenes/mod.rs"]
#[allow(clippy::should_implement_trait, reason = "a generator of numbers that never ends is no iterator")]
pub mod scenes;

use fastrand::Rng;
use masked_occlusion_culling::{
    CullingThreadpool, DrawOptions, MaskedOcclusionCulling, Settings, UpdateRule, Vertices,
};

use scenes::{Scene, town};

pub const WIDTH: u32 = 1920;
pub const HEIGHT: u32 = 1080;

pub const RULES: [(&str, UpdateRule); 4] = [
    ("three-layer", UpdateRule::ThreeLayer),
    ("quick", UpdateRule::Quick),
    ("accurate", UpdateRule::Accurate),
    ("four-layer", UpdateRule::FourLayer),
];

/// A buffer of a size that engines use, or one larger, on the best instruction set.
pub fn object(update_rule: UpdateRule) -> MaskedOcclusionCulling {
    MaskedOcclusionCulling::new(WIDTH, HEIGHT, Settings::default().with_update_rule(update_rule))
        .expect("the size is accepted")
}

/// The order in which objects are drawn.
#[derive(Clone, Copy)]
pub enum Order {
    /// Nearest first, as an engine should.
    Near,
    /// Random, but the same in every run.
    Random,
}

pub const ORDERS: [(&str, Order); 2] = [("near", Order::Near), ("random", Order::Random)];

/// A scene that is ready to be drawn.
pub struct View {
    pub name: &'static str,
    pub vertices: Vec<[f32; 4]>,
    pub positions: Vec<[f32; 3]>,
    pub matrix: [f32; 16],
    pub objects: Vec<Vec<u32>>,
    pub options: DrawOptions,
    pub near: f32,
}

impl View {
    pub fn triangles(&self) -> u64 {
        self.objects.iter().map(|o| o.len() as u64 / 3).sum()
    }

    /// The positions and their matrix.
    pub fn model_space(&self) -> Vertices<'_> {
        Vertices::model_space(&self.positions, self.matrix)
    }

    /// Sets the near plane and draws all objects, without clearing the buffer.
    pub fn draw(&self, moc: &mut MaskedOcclusionCulling) {
        moc.set_near_clip_plane(self.near).expect("a number");
        let vertices = self.model_space();
        for object in &self.objects {
            moc.render_triangles(vertices, object, &self.options).expect("the mesh is sound");
        }
    }

    /// Draws a frame with a pool whose object already has the near plane: clears, draws all objects and flushes.
    pub fn pool_frame(&self, pool: &CullingThreadpool) {
        let vertices = self.model_space();
        pool.scope(|scope| {
            pool.clear_buffer().expect("there is a buffer");
            for object in &self.objects {
                scope.render_triangles(vertices, object, &self.options).expect("the mesh is sound");
            }
        });
    }
}

/// The generated scenes, sorted into an order.
pub fn views(order: Order) -> Vec<View> {
    [town::town(), town::terrain(), town::blocks()].into_iter().map(|scene| view(scene, order)).collect()
}

fn view(mut scene: Scene, order: Order) -> View {
    match order {
        Order::Near => {
            let mut objects = std::mem::take(&mut scene.objects);
            objects.sort_by(|a, b| scene.rectangle(a)[4].total_cmp(&scene.rectangle(b)[4]));
            scene.objects = objects;
        }
        Order::Random => Rng::with_seed(7).shuffle(&mut scene.objects),
    }
    let matrix = scene.matrix.expect("these scenes have a camera");
    View {
        name: scene.name,
        positions: scene.vertices.iter().map(|&[x, y, z, _]| [x, y, z]).collect(),
        vertices: scene.vertices,
        objects: scene.objects,
        matrix,
        options: DrawOptions::default(),
        near: scene.near,
    }
}

/// Draws a wall that fills the screen, at distance `w`.
pub fn draw_wall(moc: &mut MaskedOcclusionCulling, w: f32) {
    let corner = |x: f32, y: f32| [x * w, y * w, 0.0, w];
    let wall = [corner(-3.0, -1.0), corner(1.0, -1.0), corner(1.0, 3.0)];
    let options = DrawOptions::default().with_winding(masked_occlusion_culling::BackfaceWinding::None);
    moc.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2], &options).expect("a sound triangle");
}
