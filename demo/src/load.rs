//! Reading `.obj`, `.gltf` and `.glb` files into objects.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use glam::{Mat4, Vec3};
use gltf::mesh::Mode;
use indicatif::{ProgressBar, ProgressStyle};

use crate::Result;
use crate::gltf_buffers;
use crate::scene::{Mesh, Object, Scene};

/// The colour of surfaces without one.
const PLAIN: Vec3 = Vec3::new(0.72, 0.7, 0.66);

/// Loads the scene in a file, whose extension determines the format. Reports how many triangles were dropped, if any.
pub fn load(path: &Path) -> Result<Scene> {
    let (scene, dropped) = read(path)?;
    if dropped > 0 {
        let all = dropped + scene.num_triangles();
        let why = "dropped, with a vertex that is not a finite number";
        eprintln!("{}: triangles {why}: {dropped} of {all}", path.display());
    }
    Ok(scene)
}

/// The scene, and the number of triangles dropped because of a NaN or infinite vertex.
fn read(path: &Path) -> Result<(Scene, usize)> {
    let file = File::open(path).map_err(|e| format!("cannot open {}: {e}", path.display()))?;
    let bar = ProgressBar::new(file.metadata()?.len());
    bar.set_style(ProgressStyle::with_template("reading {wide_bar} {bytes}/{total_bytes}")?);
    let reader = BufReader::new(bar.wrap_read(file));
    let folder = path.parent().unwrap_or(Path::new(""));
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let mut scene = match ending.as_str() {
        "obj" => obj(reader, folder),
        "gltf" | "glb" => gltf(reader, folder),
        _ => Err("not a .obj, .gltf, .glb or .mocrec file".into()),
    }
    .map_err(|e| format!("{}: {e}", path.display()))?;
    bar.finish_and_clear();

    let dropped = drop_triangles_that_are_not_finite(&mut scene);
    if scene.objects.is_empty() {
        let reason = if dropped > 0 {
            "all its triangles have a vertex that is not a finite number"
        } else {
            "it contains no triangles"
        };
        return Err(format!("{}: {reason}", path.display()).into());
    }
    Ok((scene, dropped))
}

/// Preserves the order of the remaining triangles. Returns the number of dropped ones.
fn drop_triangles_that_are_not_finite(scene: &mut Scene) -> usize {
    let before = scene.num_triangles();
    let objects = std::mem::take(&mut scene.objects);
    for Object { mesh, occluder, two_sided, .. } in objects {
        let Mesh { mut positions, triangles, colours } = mesh;
        let is_finite: Vec<bool> = positions.iter().map(|p| p.is_finite()).collect();
        let (triangles, colours) = triangles
            .into_iter()
            .zip(colours)
            .filter(|(triangle, _)| triangle.iter().all(|&i| is_finite[i as usize]))
            .unzip();
        // No remaining triangle uses them, but the bounds are computed from all vertices.
        let finite = positions.iter().copied().find(|p| p.is_finite()).unwrap_or_default();
        positions.iter_mut().filter(|p| !p.is_finite()).for_each(|p| *p = finite);
        scene.add(Mesh { positions, triangles, colours }, occluder, two_sided);
    }
    before - scene.num_triangles()
}

/// One object for each `o` or `g`, and for each material in it. The format does not specify which side of a triangle is
/// its front, so objects are two-sided.
fn obj(reader: impl BufRead, folder: &Path) -> Result<Scene> {
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    let mut reader = Lines { reader, ended: 0, inside: false };
    let loaded = tobj::load_obj_buf(&mut reader, &options, |name| tobj::load_mtl(folder.join(name)));
    let (models, materials) = loaded.map_err(|error| {
        use tobj::LoadError::{
            FaceColorOutOfBounds, FaceNormalOutOfBounds, FaceTexCoordOutOfBounds, FaceVertexOutOfBounds,
        };
        // The parser validates indices only when the next object begins.
        let place = match error {
            FaceVertexOutOfBounds | FaceTexCoordOutOfBounds | FaceNormalOutOfBounds | FaceColorOutOfBounds => {
                "in the object that ends at line"
            }
            _ => "line",
        };
        format!("{place} {}: {error}", reader.number())
    })?;
    // A missing material file only costs the mesh its colours.
    let materials = materials.unwrap_or_default();
    let mut scene = Scene::default();
    for model in models {
        let material = model.mesh.material_id.and_then(|m| materials.get(m));
        let colour = material.and_then(|m| m.diffuse).map_or(PLAIN, Vec3::from);
        let positions = model.mesh.positions.chunks_exact(3).map(Vec3::from_slice).collect();
        scene.add(mesh(positions, triples(&model.mesh.indices), colour)?, true, true);
    }
    Ok(scene)
}

/// Counts the lines that are read.
struct Lines<R> {
    reader: R,
    ended: usize,
    /// Whether anything was read after the last line ending.
    inside: bool,
}

impl<R> Lines<R> {
    /// Number of the line read last; the first is 1.
    fn number(&self) -> usize {
        self.ended + usize::from(self.inside)
    }
}

impl<R: BufRead> Read for Lines<R> {
    fn read(&mut self, to: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(to)?;
        self.consume(n);
        Ok(n)
    }
}

impl<R: BufRead> BufRead for Lines<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.reader.fill_buf()
    }

    fn consume(&mut self, amount: usize) {
        // Consumed bytes were filled before, so this reads nothing.
        if let Ok(buffer) = self.reader.fill_buf() {
            let consumed = &buffer[..amount.min(buffer.len())];
            self.ended += consumed.iter().filter(|byte| **byte == b'\n').count();
            self.inside = consumed.last().map_or(self.inside, |byte| *byte != b'\n');
        }
        self.reader.consume(amount);
    }
}

/// One object for each primitive of each node. Points and lines are skipped.
fn gltf(mut reader: impl BufRead, folder: &Path) -> Result<Scene> {
    let mut bytes = Vec::new();
    reader.read_to_end(&mut bytes)?;
    let gltf::Gltf { document, blob } = match gltf::Gltf::from_slice(&bytes) {
        Err(gltf::Error::Deserialize(e)) => return Err(format!("not a glTF file: {e}").into()),
        other => other?,
    };
    let buffers = gltf_buffers::read(&document, folder, blob)?;

    let mut scene = Scene::default();
    let roots = document.default_scene().or_else(|| document.scenes().next()).ok_or("there is no scene in it")?;
    let mut nodes: Vec<(gltf::Node, Mat4)> = roots.nodes().map(|n| (n, Mat4::IDENTITY)).collect();
    nodes.reverse();
    while let Some((node, parent)) = nodes.pop() {
        let world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        nodes.extend(node.children().map(|n| (n, world)));
        for primitive in node.mesh().iter().flat_map(|m| m.primitives()) {
            let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
            let Some(positions) = reader.read_positions() else { continue };
            let positions: Vec<Vec3> = positions.map(|p| world.transform_point3(p.into())).collect();
            let indices: Vec<u32> = match reader.read_indices() {
                Some(indices) => indices.into_u32().collect(),
                None => (0..positions.len() as u32).collect(),
            };
            let mut triangles = triangles(primitive.mode(), &indices);
            if world.determinant() < 0.0 {
                // A mirroring transform reverses the winding.
                triangles.iter_mut().for_each(|t| t.swap(1, 2));
            }
            let material = primitive.material();
            let [r, g, b, _] = material.pbr_metallic_roughness().base_color_factor();
            scene.add(mesh(positions, triangles, Vec3::new(r, g, b).powf(1.0 / 2.2))?, true, material.double_sided());
        }
    }
    Ok(scene)
}

/// A mesh of one colour, with its indices checked.
fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>, colour: Vec3) -> Result<Mesh> {
    if triangles.iter().flatten().any(|&i| i as usize >= positions.len()) {
        return Err("an index is out of range".into());
    }
    let colours = vec![colour; triangles.len()];
    Ok(Mesh { positions, triangles, colours })
}

fn triples(indices: &[u32]) -> Vec<[u32; 3]> {
    indices.as_chunks().0.to_vec()
}

fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Triangles => triples(indices),
        // Every second triangle of a strip has the opposite winding.
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
            .collect(),
        Mode::TriangleFan => indices.windows(2).skip(1).map(|w| [indices[0], w[0], w[1]]).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn obj_groups_become_objects_and_faces_triangles() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.OBJ");
        fs::write(folder.path().join("two.mtl"), "newmtl red\nKd 1 0 0\n").unwrap();
        fs::write(
            &path,
            "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 5 5\n\
             o square\nusemtl red\nf 1 2 3 4\no far\nf 1 2 -1\n",
        )
        .unwrap();
        let scene = load(&path).unwrap();
        assert_eq!(scene.objects.iter().map(|o| o.mesh.triangles.len()).collect::<Vec<_>>(), [2, 1]);
        assert_eq!(scene.objects[0].mesh.colours, [Vec3::X; 2]);
        assert_eq!(scene.bounds(), (Vec3::ZERO, Vec3::splat(5.0)));
    }

    /// Two nodes that share a mesh of one triangle: the second is mirrored, and translated by its parent.
    fn gltf_text(buffer: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0,1]}}],
            "nodes":[{{"mesh":0}},{{"translation":[10,0,0],"children":[2]}},{{"mesh":0,"scale":[-1,1,1]}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"material":0}}]}}],
            "materials":[{{"doubleSided":true,"pbrMetallicRoughness":{{"baseColorFactor":[0,1,0,1]}}}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[2,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
            "buffers":[{{"byteLength":44{buffer}}}]}}"#
        )
    }

    fn gltf_buffer() -> Vec<u8> {
        let mut bytes: Vec<u8> =
            [0f32, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|f| f.to_le_bytes()).collect();
        bytes.extend([0, 0, 1, 0, 2, 0, 0, 0]);
        bytes
    }

    fn check_gltf(scene: &Scene) {
        assert_eq!(scene.objects.len(), 2);
        let [plain, mirrored] = [&scene.objects[0], &scene.objects[1]];
        assert!(plain.two_sided && mirrored.two_sided);
        assert_eq!(plain.mesh.triangles, [[0, 1, 2]]);
        assert_eq!(mirrored.mesh.triangles, [[0, 2, 1]]);
        assert_eq!((mirrored.lo, mirrored.hi), (Vec3::new(8.0, 0.0, 0.0), Vec3::new(10.0, 1.0, 0.0)));
        assert_eq!(plain.mesh.colours, [Vec3::Y]);
    }

    #[test]
    fn gltf_nodes_become_objects_in_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.gltf");
        fs::write(folder.path().join("two.bin"), gltf_buffer()).unwrap();
        fs::write(&path, gltf_text(r#","uri":"two.bin""#)).unwrap();
        check_gltf(&load(&path).unwrap());

        fs::write(folder.path().join("two of them.bin"), gltf_buffer()).unwrap();
        fs::write(&path, gltf_text(r#","uri":"two%20of%20them.bin""#)).unwrap();
        check_gltf(&load(&path).unwrap());

        let data = "AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
        fs::write(&path, gltf_text(&format!(r#","uri":"data:application/octet-stream;base64,{data}""#))).unwrap();
        check_gltf(&load(&path).unwrap());
    }

    #[test]
    fn glb_holds_its_buffer() {
        let mut json = gltf_text("").into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let binary = gltf_buffer();
        let mut glb = b"glTF".to_vec();
        for word in [2, 12 + 8 + json.len() + 8 + binary.len(), json.len()] {
            glb.extend((word as u32).to_le_bytes());
        }
        glb.extend(b"JSON");
        glb.extend(json);
        glb.extend((binary.len() as u32).to_le_bytes());
        glb.extend(b"BIN\0");
        glb.extend(binary);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("two.glb");
        fs::write(&path, glb).unwrap();
        check_gltf(&load(&path).unwrap());
    }

    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3]), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(triangles(Mode::TriangleFan, &[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
        assert!(triangles(Mode::TriangleFan, &[]).is_empty());
        assert!(triangles(Mode::Lines, &[0, 1, 2]).is_empty());
    }

    #[test]
    fn triangles_with_a_vertex_that_is_no_number_are_dropped_and_counted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nan.obj");
        fs::write(
            &path,
            "v 0 0 0\nv 1 0 0\nv 1 1 0\nv nan 1 0\nv 2 inf 0\no some\nf 1 2 3\nf 1 2 4\nf 1 3 2\no none\nf 1 2 5\n",
        )
        .unwrap();
        let (scene, dropped) = read(&path).unwrap();
        assert_eq!(dropped, 2);
        assert_eq!(
            scene.objects.iter().map(|o| o.mesh.triangles.clone()).collect::<Vec<_>>(),
            [[[0, 1, 2], [0, 2, 1]]]
        );
        assert_eq!(scene.objects[0].mesh.colours.len(), 2);
        assert_eq!(scene.bounds(), (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
        assert!(scene.objects.iter().flat_map(|o| &o.mesh.positions).all(|p| p.is_finite()));
    }

    #[test]
    fn what_cannot_be_read_says_so() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("empty.obj"), "v 0 0 0\n").unwrap();
        fs::write(path("bad.glb"), b"glTF\x02\0\0\0").unwrap();
        fs::write(path("text.gltf"), "This is no scene.").unwrap();
        fs::write(path("lost.gltf"), gltf_text(r#","uri":"lost.bin""#)).unwrap();
        fs::write(path("short.gltf"), gltf_text(r#","uri":"data:;base64,AAAA""#)).unwrap();
        fs::write(path("remote.gltf"), gltf_text(r#","uri":"https://example.org/a.bin""#)).unwrap();
        fs::write(path("bare.gltf"), gltf_text("")).unwrap();
        fs::write(path("mesh.fbx"), "").unwrap();
        fs::write(path("number.obj"), "v 0 0 0\nv 1 x 0\nv 1 1 0\n").unwrap();
        fs::write(path("last.obj"), "v 0 0 0\r\n# a comment\r\nf 1 2 three").unwrap();
        fs::write(path("index.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\no a\nf 1 2 9\n").unwrap();
        fs::write(path("nan.obj"), "v 0 0 0\nv nan 0 0\nv 1 1 0\nf 1 2 3\n").unwrap();
        for (name, reason) in [
            ("empty.obj", "no triangles"),
            ("bad.glb", "bad.glb"),
            ("text.gltf", "not a glTF file"),
            ("lost.gltf", "cannot read"),
            ("short.gltf", "3 of 44 bytes"),
            ("remote.gltf", "https"),
            ("bare.gltf", "bare.gltf"),
            ("mesh.fbx", "not a .obj"),
            ("absent.obj", "cannot open"),
            ("number.obj", "line 2: position"),
            ("last.obj", "line 3: face"),
            ("index.obj", "in the object that ends at line 5: face vertex index"),
            ("nan.obj", "not a finite number"),
        ] {
            let error = load(&path(name)).unwrap_err().to_string();
            assert!(error.contains(reason) && error.contains(name), "{name}: {error}");
        }
    }
}
