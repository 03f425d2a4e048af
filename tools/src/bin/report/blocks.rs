//! A generated world of cubes, as in games: hills, caves, trees, in chunks of 16x16x16. Only the faces between filled
//! and empty cubes are generated.

use glam::{Vec3, vec3};

use demo::scene::{Mesh, Scene};

/// Size of the world in blocks: in x and z, and in height.
const SIZE: i32 = 160;
const HEIGHT: i32 = 48;
const CHUNK: i32 = 16;

/// Camera positions and targets: on a hill, in a valley, in a cave's mouth.
pub const PLACES: [(Vec3, Vec3); 3] = [
    (vec3(12.0, 42.0, 12.0), vec3(90.0, 18.0, 90.0)),
    (vec3(80.5, 32.0, 150.5), vec3(70.0, 24.0, 20.0)),
    (vec3(150.5, 30.0, 70.5), vec3(10.0, 20.0, 90.0)),
];

/// A block, by its integer coordinates.
fn block(x: i32, y: i32, z: i32) -> Vec3 {
    vec3(x as f32, y as f32, z as f32)
}

pub fn generate() -> Scene {
    let index = |p: Vec3| ((p.y as i32 * SIZE + p.z as i32) * SIZE + p.x as i32) as usize;
    let filled: Vec<bool> =
        (0..HEIGHT * SIZE * SIZE).map(|i| is_filled(block(i % SIZE, i / (SIZE * SIZE), i / SIZE % SIZE))).collect();
    // Outside the sides and the bottom everything is rock, so that there are no faces there; above it is air.
    let at = |p: Vec3| {
        let inside = p.cmpge(Vec3::ZERO).all() && p.cmplt(block(SIZE, HEIGHT, SIZE)).all();
        if inside { filled[index(p)] } else { p.y < HEIGHT as f32 }
    };
    let mut scene = Scene::default();
    for chunk in 0..(SIZE / CHUNK) * (SIZE / CHUNK) * (HEIGHT / CHUNK) {
        let across = SIZE / CHUNK;
        let first = block(chunk % across, chunk / (across * across), chunk / across % across) * CHUNK as f32;
        let mut mesh = Mesh::default();
        for i in 0..CHUNK * CHUNK * CHUNK {
            let p = first + block(i % CHUNK, i / (CHUNK * CHUNK), i / CHUNK % CHUNK);
            if at(p) {
                faces(&mut mesh, p, at);
            }
        }
        scene.add(mesh, true, false);
    }
    scene
}

/// The sides of a block that border on air.
fn faces(mesh: &mut Mesh, p: Vec3, at: impl Fn(Vec3) -> bool) {
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let normal = Vec3::AXES[axis] * side;
            if at(p + normal) {
                continue;
            }
            // Two directions that run counter-clockwise around the normal.
            let (u, v) = (Vec3::AXES[(axis + 1) % 3], Vec3::AXES[(axis + 2) % 3]);
            let (u, v) = if side > 0.0 { (u, v) } else { (v, u) };
            let corner = p + normal.max(Vec3::ZERO);
            mesh.polygon(&[corner, corner + u, corner + u + v, corner + v], Vec3::ONE);
        }
    }
}

fn is_filled(p: Vec3) -> bool {
    let [x, y, z] = p.to_array();
    let ground = 20.0 + 11.0 * smooth(x / 37.0, 0.0, z / 37.0) + 4.0 * smooth(x / 11.0, 7.0, z / 11.0);
    let cave = smooth(x / 13.0, y / 9.0, z / 13.0) + 0.5 * smooth(x / 6.0, y / 6.0 + 40.0, z / 6.0);
    let is_ground = y < ground && (cave < 0.62 || y < 2.0);
    // A trunk in every second cell of nine blocks, with leaves around its top.
    let cell = vec3((x / 9.0).floor(), 0.0, (z / 9.0).floor());
    let middle = cell * 9.0 + vec3(4.0, 0.0, 4.0);
    let foot = 20.0
        + 11.0 * smooth(middle.x / 37.0, 0.0, middle.z / 37.0)
        + 4.0 * smooth(middle.x / 11.0, 7.0, middle.z / 11.0);
    let has_tree = (cell.x + cell.z) % 2.0 == 0.0 && foot > 18.0;
    let (away, up) = ((p - middle).with_y(0.0).abs().max_element(), y - foot);
    let is_tree = has_tree && ((away == 0.0 && (-1.0..6.0).contains(&up)) || (away <= 2.0 && (4.0..7.0).contains(&up)));
    is_ground || is_tree
}

/// Smooth noise from -1 to 1 with a feature size of 1.
fn smooth(x: f32, y: f32, z: f32) -> f32 {
    let p = vec3(x, y, z);
    let (cell, f) = (p.floor(), p - p.floor());
    let f = f * f * (3.0 - 2.0 * f);
    let corner = |dx, dy, dz| noise(cell + block(dx, dy, dz));
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let row = |dy, dz| mix(corner(0, dy, dz), corner(1, dy, dz), f.x);
    mix(mix(row(0, 0), row(1, 0), f.y), mix(row(0, 1), row(1, 1), f.y), f.z)
}

/// A number from -1 to 1 for each lattice point.
fn noise(p: Vec3) -> f32 {
    let mut n = (p.x as i32 as u32).wrapping_mul(0x8da6_b343)
        ^ (p.y as i32 as u32).wrapping_mul(0xd816_3841)
        ^ (p.z as i32 as u32).wrapping_mul(0xcb1a_b31f);
    n = (n ^ (n >> 15)).wrapping_mul(0x2c1b_3c6d);
    n = (n ^ (n >> 12)).wrapping_mul(0x297a_2d39);
    (n ^ (n >> 15)) as f32 / u32::MAX as f32 * 2.0 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_has_the_faces_that_show_and_they_face_outwards() {
        let mut mesh = Mesh::default();
        faces(&mut mesh, block(1, 1, 1), |p| p == block(1, 1, 2));
        assert_eq!(mesh.triangles.len(), 2 * 5);
        let middle = Vec3::splat(1.5);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert!((b - a).cross(c - a).dot((a + b + c) / 3.0 - middle) > 0.0);
        }
    }
}
