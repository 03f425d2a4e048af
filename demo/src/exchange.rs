//! The files that the driver and the C++ program exchange. cpp-examples/demo.cpp documents their layout.

use std::fs;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::Result;
use crate::camera::Camera;
use crate::scene::Scene;

/// The result for an object, with the values of the C++ class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    Visible = 0,
    Culled = 1,
    Outside = 3,
}

/// The results of the C++ program.
pub struct Outcome {
    /// One for each object.
    pub fates: Vec<Fate>,
    /// 1/w of each pixel, top row first; negative where nothing was drawn.
    pub depth: Vec<f32>,
}

/// Writes the scene file.
pub fn write_scene(path: &Path, scene: &Scene, camera: &Camera, (width, height): (u32, u32)) -> Result<()> {
    let mut file = BufWriter::new(fs::File::create(path)?);
    let mut words = |words: &[u32]| words.iter().try_for_each(|w| file.write_all(&w.to_le_bytes()));
    let count = |n: usize| u32::try_from(n).map_err(|_| "the scene is too large: counts have 32 bits");
    let vertices = scene.objects.iter().map(|o| o.mesh.positions.len()).sum();
    let indices = scene.num_triangles() * 3;

    words(&[u32::from_le_bytes(*b"MOCD"), u32::from_le_bytes(*b"EMO1"), width, height])?;
    words(&[count(vertices)?, count(indices)?, count(scene.objects.len())?, camera.near.to_bits()])?;
    words(&camera.clip_from_world().to_cols_array().map(f32::to_bits))?;
    for position in scene.objects.iter().flat_map(|o| &o.mesh.positions) {
        words(&position.to_array().map(f32::to_bits))?;
    }
    for triangle in scene.objects.iter().flat_map(|o| &o.mesh.triangles) {
        words(triangle)?;
    }
    let (mut vertex, mut index) = (0, 0);
    for object in &scene.objects {
        let triangles = object.mesh.triangles.len();
        let flags = u32::from(object.occluder) | u32::from(object.two_sided) << 1;
        words(&[count(vertex)?, count(index)?, count(triangles)?, flags])?;
        words(&object.lo.to_array().map(f32::to_bits))?;
        words(&object.hi.to_array().map(f32::to_bits))?;
        vertex += object.mesh.positions.len();
        index += triangles * 3;
    }
    file.flush()?;
    Ok(())
}

/// Reads the results that the program wrote.
pub fn read_outcome(path: &Path, objects: usize, (width, height): (u32, u32)) -> Result<Outcome> {
    let bytes = fs::read(path)?;
    let (fates, depth) = bytes.split_at_checked(objects).ok_or("the result is cut short")?;
    let (depth, rest) = depth.as_chunks();
    if depth.len() != width as usize * height as usize || !rest.is_empty() {
        return Err("the result and the buffer differ in size".into());
    }
    let fate = |byte: &u8| match byte {
        0 => Ok(Fate::Visible),
        1 => Ok(Fate::Culled),
        3 => Ok(Fate::Outside),
        _ => Err(format!("{byte} is not a culling result")),
    };
    Ok(Outcome {
        fates: fates.iter().map(fate).collect::<std::result::Result<_, _>>()?,
        depth: depth.iter().map(|b| f32::from_le_bytes(*b)).collect(),
    })
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn the_scene_file_is_what_the_program_expects() {
        let mut scene = Scene::default();
        for (z, occluder, two_sided) in [(1.0, true, false), (2.0, false, true)] {
            let mut mesh = Mesh::default();
            mesh.polygon(&[Vec3::Z * z, Vec3::X, Vec3::Y, Vec3::NEG_X], Vec3::ONE);
            scene.add(mesh, occluder, two_sided);
        }
        let camera = Camera { eye: Vec3::ZERO, look: Vec3::NEG_Z, up: Vec3::Y, fov: 1.0, near: 0.25, aspect: 2.0 };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene");
        write_scene(&path, &scene, &camera, (64, 32)).unwrap();

        let bytes = fs::read(&path).unwrap();
        assert_eq!(&bytes[..8], b"MOCDEMO1");
        let words: Vec<u32> = bytes[8..].as_chunks().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
        assert_eq!(words[..6], [64, 32, 8, 12, 2, 0.25f32.to_bits()]);
        let matrix: [f32; 16] = std::array::from_fn(|i| f32::from_bits(words[6 + i]));
        assert_eq!(matrix, camera.clip_from_world().to_cols_array());
        let (vertices, rest) = words[22..].split_at(8 * 3);
        assert_eq!(vertices[..3], [0, 0, 1.0f32.to_bits()]);
        assert_eq!(vertices[12..15], [0, 0, 2.0f32.to_bits()]);
        let (indices, objects) = rest.split_at(12);
        assert_eq!(indices, [0, 1, 2, 0, 2, 3, 0, 1, 2, 0, 2, 3]);
        assert_eq!(objects.len(), 2 * 10);
        assert_eq!(objects[..4], [0, 0, 2, 1]);
        assert_eq!(objects[10..14], [4, 6, 2, 2]);
        assert_eq!(objects[14..20], [-1.0f32, 0.0, 0.0, 1.0, 1.0, 2.0].map(f32::to_bits));
    }

    #[test]
    fn a_result_is_read_and_a_bad_one_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result");
        let mut bytes = vec![0, 1, 3];
        bytes.extend([0.5f32, -1.0].iter().flat_map(|f| f.to_le_bytes()));
        fs::write(&path, &bytes).unwrap();
        let outcome = read_outcome(&path, 3, (2, 1)).unwrap();
        assert_eq!(outcome.fates, [Fate::Visible, Fate::Culled, Fate::Outside]);
        assert_eq!(outcome.depth, [0.5, -1.0]);
        assert!(read_outcome(&path, 3, (3, 1)).is_err());
        assert!(read_outcome(&path, 20, (2, 1)).is_err());
        bytes[1] = 7;
        fs::write(&path, &bytes).unwrap();
        assert!(read_outcome(&path, 3, (2, 1)).is_err());
    }
}
