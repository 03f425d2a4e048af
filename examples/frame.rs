//! A frame as in an engine: meshes with matrices, a thread pool that draws occluders, boxes that are tested.

use masked_occlusion_culling::{
    CullingResult, CullingThreadpool, DrawOptions, Error, MaskedOcclusionCulling, Settings, ThreadpoolSettings,
    Vertices,
};

fn main() -> Result<(), Error> {
    // Once: the buffer, the near plane of the camera, and threads.
    let pool = CullingThreadpool::new(ThreadpoolSettings::default().with_threads(2))?;
    pool.set_buffer(MaskedOcclusionCulling::new(640, 360, Settings::default())?);
    pool.set_near_clip_plane(0.1)?;
    pool.wake_threads();

    // A wall 10 units in front of the camera, which looks along -z: w is -z. The matrix is column by column.
    let view_projection = [1.0, 0.0, 0.0, 0.0, 0.0, 1.8, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, -0.2, 0.0];
    let positions = [[-3.0, -3.0, -10.0], [3.0, -3.0, -10.0], [3.0, 3.0, -10.0], [-3.0, 3.0, -10.0]];
    let wall = Vertices::model_space(&positions, view_projection);

    // Each frame: draws return at once, and all of them are done when the scope ends.
    pool.clear_buffer()?;
    pool.scope(|scope| scope.render_triangles(wall, &[0, 1, 2, 0, 2, 3], &DrawOptions::default()))?;

    // Objects are tested by their screen rectangle and the w of the nearest corner of their box.
    for (name, x, w) in [("crate", 0.0, 12.0), ("barrel", 0.0, 6.0), ("tree", 0.7, 12.0)] {
        let hidden = pool.test_rect(x - 0.05, -0.1, x + 0.05, 0.1, w)? != CullingResult::Visible;
        println!("{name}: {}", if hidden { "hidden" } else { "draw it" });
    }
    Ok(())
}
