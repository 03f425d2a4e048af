//! The perspective cameras of a glTF file.

use std::path::Path;

use glam::{Mat4, Vec3};

use crate::subject::{ASPECT, View};
use demo::camera::Camera;
use tools::Result;

/// A view for each camera in a file's scene; none if the format has no cameras.
pub fn read(path: &Path) -> Result<Vec<View>> {
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
        return Ok(Vec::new());
    }
    let gltf::Gltf { document, .. } = gltf::Gltf::open(path).map_err(|e| format!("{}: {e}", path.display()))?;
    let roots = document.default_scene().or_else(|| document.scenes().next());
    let mut nodes: Vec<(gltf::Node, Mat4)> =
        roots.iter().flat_map(|scene| scene.nodes()).map(|n| (n, Mat4::IDENTITY)).collect();
    nodes.reverse();
    let mut views = Vec::new();
    while let Some((node, parent)) = nodes.pop() {
        let world = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        nodes.extend(node.children().map(|n| (n, world)));
        let Some(camera) = node.camera() else { continue };
        let gltf::camera::Projection::Perspective(p) = camera.projection() else { continue };
        let eye = world.transform_point3(Vec3::ZERO);
        let look = eye + world.transform_vector3(Vec3::NEG_Z);
        let up = world.transform_vector3(Vec3::Y).normalize();
        views.push(View::of(&Camera { eye, look, up, fov: p.yfov(), near: p.znear(), aspect: ASPECT }));
    }
    Ok(views)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_is_where_its_node_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("camera.gltf");
        let text = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
            "nodes":[{"translation":[1,2,3],"children":[1]},{"camera":0,"translation":[0,0,1]}],
            "cameras":[{"type":"perspective","perspective":{"yfov":1.0,"znear":0.5}},
            {"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"zfar":9,"znear":1}}]}"#;
        std::fs::write(&path, text).unwrap();
        let views = read(&path).unwrap();
        assert_eq!(views.len(), 1);
        assert_eq!(views[0].near, 0.5);
        let ahead = views[0].clip * Vec3::new(1.0, 2.0, -6.0).extend(1.0);
        assert!((ahead.w - 10.0).abs() < 1e-5 && ahead.x.abs() < 1e-5 && ahead.y.abs() < 1e-5, "{ahead}");
        assert!(read(&folder.path().join("a.OBJ")).unwrap().is_empty());
    }
}
