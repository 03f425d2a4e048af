//! How a mesh numbers its vertices makes no difference: close together, in two rows of a wide grid, scattered over a
//! large array, or three separate ones for every triangle.

mod oracle;
mod support;

use fastrand::Rng;
use masked_occlusion_culling::{CullingResult, Vertices};
use support::{RULES, bits, both_sides, name, object};

const SIZE: (usize, usize) = (400, 230);

/// A bumpy sheet that extends past the screen, `wide` by `high` squares.
fn sheet(wide: u32, high: u32, near: f32) -> (Vec<[f32; 4]>, Vec<u32>) {
    let mut vertices = Vec::new();
    for y in 0..=high {
        for x in 0..=wide {
            let w = near * (2.0 + (x as f32 * 0.37).sin() * (y as f32 * 0.23).cos());
            let (u, v) = (x as f32 / wide as f32, y as f32 / high as f32);
            vertices.push([(2.2 * u - 1.1) * w, (2.2 * v - 1.1) * w, 0.0, w]);
        }
    }
    let mut indices = Vec::new();
    for y in 0..high {
        for x in 0..wide {
            let a = y * (wide + 1) + x;
            let [b, c, d] = [a + 1, a + wide + 1, a + wide + 2];
            indices.extend([a, b, d, a, d, c]);
        }
    }
    (vertices, indices)
}

/// The same triangles, with the vertices moved to the positions `to` in an array of `len`.
fn renumbered(vertices: &[[f32; 4]], indices: &[u32], len: usize, to: &[u32]) -> (Vec<[f32; 4]>, Vec<u32>) {
    // Unused vertices are NaN: they are sometimes projected, and must not matter.
    let mut moved = vec![[f32::NAN; 4]; len];
    for (vertex, &to) in vertices.iter().zip(to) {
        moved[to as usize] = *vertex;
    }
    // The array ends with the last used vertex, so that valgrind finds any read beyond it.
    moved.truncate(*to.iter().max().unwrap() as usize + 1);
    moved.shrink_to_fit();
    (moved, indices.iter().map(|&i| to[i as usize]).collect())
}

#[test]
fn numbering_changes_no_bit_and_no_answer() {
    let mut rng = Rng::with_seed(7);
    // Some fit in a chunk, some in pages, some in neither; some have only a few triangles.
    for (wide, high) in [(3, 2), (20, 12), (300, 5), (1000, 3), (5000, 1), (9000, 1), (700, 20)] {
        let (vertices, indices) = sheet(wide, high, 5.0);
        let n = vertices.len();
        let in_order: Vec<u32> = (0..n as u32).collect();
        let mut shuffled = in_order.clone();
        rng.shuffle(&mut shuffled);
        let spread: Vec<u32> = (0..n as u32).map(|i| i * 5 + 3).collect();
        let by_rows: Vec<u32> = (0..n as u32).map(|i| i + i / (wide + 1) * 2011).collect();
        let mut far = shuffled.clone();
        far[0] = 300_000;
        let alone = (indices.iter().map(|&i| vertices[i as usize]).collect(), (0..indices.len() as u32).collect());
        let mut meshes = vec![(vertices.clone(), indices.clone()), alone];
        for to in [&shuffled, &spread, &by_rows, &far] {
            let len = *to.iter().max().unwrap() as usize + 1;
            meshes.push(renumbered(&vertices, &indices, len, to));
        }
        for implementation in masked_occlusion_culling::Implementation::available() {
            let mut expected = None;
            for (k, (vertices, indices)) in meshes.iter().enumerate() {
                let mut moc = object(*implementation, RULES[0], masked_occlusion_culling::YAxis::Down, SIZE);
                let drawn = moc.render_triangles(Vertices::clip_space(vertices), indices, &both_sides()).unwrap();
                assert_eq!(drawn, CullingResult::Visible);
                let hidden: Vec<[f32; 4]> = vertices.iter().map(|v| v.map(|x| x * 12.0)).collect();
                let answer = moc.test_triangles(Vertices::clip_space(&hidden), indices, &both_sides()).unwrap();
                let found = (bits(&moc), answer);
                match &expected {
                    None => expected = Some(found),
                    Some(expected) => assert!(*expected == found, "{} {wide}x{high}, numbering {k}", name(&moc)),
                }
            }
        }
    }
}
