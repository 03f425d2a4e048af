//! Meshes: everything drawn here is a sheet, placed in the scene.

use glam::Vec3;

/// Vertices and indices, all of them in range: drawing relies on it, so the fields are private.
pub struct Mesh {
    vertices: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

impl Mesh {
    /// A sheet of `columns` by `rows` quads of two triangles each. `place` takes two numbers from 0 to 1, across and
    /// up, and must keep right on the right as seen from the front. Rows are drawn from the lowest up.
    pub fn sheet(columns: u32, rows: u32, place: impl Fn(f32, f32) -> Vec3) -> Self {
        let mut vertices = Vec::with_capacity((columns as usize + 1) * (rows as usize + 1));
        for row in 0..=rows {
            for column in 0..=columns {
                let p = place(column as f32 / columns as f32, row as f32 / rows as f32);
                // x, y, padding, z: 16 bytes per vertex with the third coordinate at byte 12 is the default layout of
                // the class, so libraries with a fast path for reading vertices use it.
                vertices.push([p.x, p.y, 0.0, p.z]);
            }
        }
        let mut indices = Vec::with_capacity(6 * columns as usize * rows as usize);
        for row in 0..rows {
            for column in 0..columns {
                let low = row * (columns + 1) + column;
                let high = low + columns + 1;
                indices.extend([low, low + 1, high + 1, low, high + 1, high]);
            }
        }
        Self { vertices, indices }
    }

    /// Triangles that share no vertices, counter-clockwise as seen from the front, drawn in their order.
    pub fn soup(triangles: &[[Vec3; 3]]) -> Self {
        let vertices: Vec<[f32; 4]> = triangles.iter().flatten().map(|p| [p.x, p.y, 0.0, p.z]).collect();
        Self { indices: (0..vertices.len() as u32).collect(), vertices }
    }

    /// x, y, padding, z of each vertex.
    pub fn vertices(&self) -> &[[f32; 4]] {
        &self.vertices
    }

    /// Three per triangle, counter-clockwise as seen from the front.
    pub fn indices(&self) -> &[u32] {
        &self.indices
    }

    pub fn triangles(&self) -> usize {
        self.indices.len() / 3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_faces_the_front_and_its_indices_are_sound() {
        let mesh = Mesh::sheet(5, 3, |x, y| Vec3::new(x, y, 0.0));
        assert_eq!((mesh.triangles(), mesh.vertices().len()), (30, 24));
        assert!(mesh.indices().iter().all(|i| (*i as usize) < mesh.vertices().len()));
        for triangle in mesh.indices().as_chunks::<3>().0 {
            let [a, b, c] = triangle.map(|i| Vec3::from_slice(&mesh.vertices()[i as usize]).truncate());
            assert!((b - a).perp_dot(c - a) > 0.0);
        }
    }
}
