//! Splits meshes: an object can only be culled as a whole.

use glam::Vec3;
use indicatif::ProgressIterator;

use crate::scene::{Mesh, Object, Scene, bounds};

/// Splits every object of more than `max_triangles` into spatially compact pieces of at most that many.
pub fn split(scene: Scene, max_triangles: usize) -> Scene {
    let mut pieces = Scene::default();
    for object in scene.objects.into_iter().progress() {
        let count = object.mesh.triangles.len();
        if count <= max_triangles {
            pieces.objects.push(object);
            continue;
        }
        let centres: Vec<Vec3> = (0..count).map(|t| object.corners(t).iter().sum::<Vec3>() / 3.0).collect();
        let mut triangles: Vec<u32> = (0..count as u32).collect();
        halve(&mut triangles, &centres, max_triangles, &mut |cluster| {
            pieces.objects.extend(Object::new(extract(&object.mesh, cluster), object.occluder, object.two_sided));
        });
    }
    pieces
}

/// A piece size that splits a large scene into about a thousand objects.
pub fn piece_size(scene: &Scene) -> usize {
    (scene.num_triangles() / 1_000).clamp(64, 1_024)
}

/// Splits at the median along the longest side, until the pieces are small enough.
fn halve(triangles: &mut [u32], centres: &[Vec3], max: usize, done: &mut impl FnMut(&[u32])) {
    if triangles.len() <= max.max(1) {
        return done(triangles);
    }
    let (lo, hi) = bounds(triangles.iter().map(|&t| centres[t as usize]));
    let axis = (hi - lo).max_position();
    let middle = triangles.len() / 2;
    triangles.select_nth_unstable_by(middle, |&a, &b| {
        centres[a as usize][axis].total_cmp(&centres[b as usize][axis]).then(a.cmp(&b))
    });
    let (left, right) = triangles.split_at_mut(middle);
    halve(left, centres, max, done);
    halve(right, centres, max, done);
}

/// Some triangles of a mesh, with only the vertices that they use.
fn extract(mesh: &Mesh, triangles: &[u32]) -> Mesh {
    let mut used: Vec<u32> = triangles.iter().flat_map(|&t| mesh.triangles[t as usize]).collect();
    used.sort_unstable();
    used.dedup();
    let local = |i: u32| used.partition_point(|&u| u < i) as u32;
    Mesh {
        positions: used.iter().map(|&i| mesh.positions[i as usize]).collect(),
        triangles: triangles.iter().map(|&t| mesh.triangles[t as usize].map(local)).collect(),
        colours: triangles.iter().map(|&t| mesh.colours[t as usize]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_hold_every_triangle_once() {
        let mut mesh = Mesh::default();
        mesh.ball(Vec3::ZERO, Vec3::ONE, 4, Vec3::ONE, |_| 1.0);
        let mut scene = Scene::default();
        scene.add(mesh, true, false);
        let sorted = |scene: &Scene| {
            let corners = |o: &Object| (0..o.mesh.triangles.len()).map(|t| o.corners(t)).collect::<Vec<_>>();
            let mut all: Vec<String> = scene.objects.iter().flat_map(corners).map(|t| format!("{t:?}")).collect();
            all.sort();
            all
        };
        let before = sorted(&scene);
        let pieces = split(scene, 100);
        assert_eq!(sorted(&pieces), before);
        assert!(pieces.objects.len() >= before.len().div_ceil(100));
        for piece in &pieces.objects {
            assert!(piece.mesh.triangles.len() <= 100);
            assert!(piece.mesh.positions.len() <= 300);
            assert!((piece.hi - piece.lo).max_element() < 1.5, "a piece is spread over the ball");
        }
    }

    #[test]
    fn triangles_in_one_place_are_split_too() {
        let mut mesh = Mesh::default();
        for _ in 0..10 {
            mesh.polygon(&[Vec3::ZERO, Vec3::X, Vec3::Y], Vec3::ONE);
        }
        let mut scene = Scene::default();
        scene.add(mesh, true, false);
        assert_eq!(split(scene, 3).objects.iter().map(|o| o.mesh.triangles.len()).sum::<usize>(), 10);
    }
}
