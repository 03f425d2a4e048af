//! Scenes: objects, each with its own mesh.

use glam::Vec3;

/// Triangles with a colour each. Counter-clockwise is front-facing, unless the object is two-sided.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub triangles: Vec<[u32; 3]>,
    pub colours: Vec<Vec3>,
}

/// A part of the scene that is drawn or culled as a whole.
#[derive(Clone, Debug)]
pub struct Object {
    pub mesh: Mesh,
    /// Whether it is worth drawing as an occluder.
    pub occluder: bool,
    /// Whether its triangles are visible from both sides.
    pub two_sided: bool,
    /// Bounding box.
    pub lo: Vec3,
    pub hi: Vec3,
}

impl Object {
    /// An object with the bounds of its mesh; `None` if the mesh has no triangles.
    pub fn new(mesh: Mesh, occluder: bool, two_sided: bool) -> Option<Self> {
        if mesh.triangles.is_empty() {
            return None;
        }
        let (lo, hi) = bounds(mesh.positions.iter().copied());
        Some(Self { mesh, occluder, two_sided, lo, hi })
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.mesh.triangles[triangle].map(|i| self.mesh.positions[i as usize])
    }
}

/// All objects.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    pub objects: Vec<Object>,
}

impl Scene {
    /// Adds a mesh as an object, unless it is empty.
    pub fn add(&mut self, mesh: Mesh, occluder: bool, two_sided: bool) {
        self.objects.extend(Object::new(mesh, occluder, two_sided));
    }

    /// The bounding box of the scene.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        bounds(self.objects.iter().flat_map(|o| [o.lo, o.hi]))
    }

    pub fn num_triangles(&self) -> usize {
        self.objects.iter().map(|o| o.mesh.triangles.len()).sum()
    }
}

/// The bounding box of points.
pub fn bounds(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}
