//! A small town, the same every time: bent streets of terraced houses, a church on a square, trees, lamps, parked cars.

use glam::{Mat4, Vec2, Vec3, vec2, vec3};

use crate::scene::{Mesh, Scene};

/// Number of blocks in each direction.
const BLOCKS: i32 = 9;
/// The block without houses: the square.
const SQUARE: i32 = BLOCKS / 2;
/// Distance between the centre lines of adjacent streets, in metres.
const PITCH: f32 = 58.0;
/// Width of a street, and of the pavement on each side.
const STREET: f32 = 9.0;
const PAVEMENT: f32 = 3.0;
/// Depth of a house, from front to back.
const DEPTH: f32 = 10.0;

/// Position and target of the default camera.
pub fn camera() -> (Vec3, Vec3) {
    let street = PITCH / 2.0;
    let stand = bend(vec2(street + 2.0, 1.02 * PITCH));
    let ahead = bend(vec2(street - 15.0, 0.1 * PITCH));
    (vec3(stand.x, 3.6, stand.y), vec3(ahead.x, 11.0, ahead.y))
}

/// The town.
pub fn generate() -> Scene {
    let mut town = Town { scene: Scene::default(), random: Random(7) };
    let half = BLOCKS as f32 / 2.0 * PITCH;
    for row in 0..BLOCKS {
        for column in 0..BLOCKS {
            let lo = vec2(column as f32, row as f32) * PITCH - half;
            town.street_surface(lo);
            town.block(lo + STREET / 2.0, lo + PITCH - STREET / 2.0, (column, row) == (SQUARE, SQUARE));
        }
    }
    town.scene
}

/// Bends the straight plan, so that no street can be seen from end to end.
fn bend(p: Vec2) -> Vec2 {
    p + vec2(16.0 * (p.y / 75.0).sin() + 5.0 * (p.y / 31.0 + 1.0).sin(), 13.0 * (p.x / 82.0 + 0.8).sin())
}

/// Moves geometry built around the origin, with its front towards +z, to its place in the plan. `front` is the
/// direction in the plan that +z is mapped to.
fn place(at: Vec2, front: Vec2) -> Mat4 {
    let middle = bend(at);
    let along = (bend(at + front.perp()) - bend(at - front.perp())).normalize();
    let right = vec3(-along.x, 0.0, -along.y);
    let out = right.cross(Vec3::Y);
    Mat4::from_cols(right.extend(0.0), Vec3::Y.extend(0.0), out.extend(0.0), vec3(middle.x, 0.0, middle.y).extend(1.0))
}

/// Steele, Lea, Flood: "Fast splittable pseudorandom number generators", 2014.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn range(&mut self, lo: f32, hi: f32) -> f32 {
        lo + (hi - lo) * (self.next() >> 40) as f32 / (1u64 << 24) as f32
    }

    fn chance(&mut self, p: f32) -> bool {
        self.range(0.0, 1.0) < p
    }

    fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[(self.next() % of.len() as u64) as usize]
    }
}

fn rgb(hex: u32) -> Vec3 {
    vec3((hex >> 16) as f32, (hex >> 8 & 255) as f32, (hex & 255) as f32) / 255.0
}

const WALLS: [u32; 9] = [0xe8dcc5, 0xd9c3a0, 0xc98f6b, 0xb9a48c, 0xe3d5d0, 0xa8b5ad, 0xd8b46a, 0xb5705a, 0xcfd3d6];
const ROOFS: [u32; 5] = [0x9a4a35, 0x7f3f30, 0x8a5a44, 0x55585f, 0xa85c3c];
const CARS: [u32; 7] = [0x9c1f24, 0x21447a, 0xe6e6e6, 0x2b2d30, 0x7d8790, 0x3f6b4a, 0xd7a323];

struct Town {
    scene: Scene,
    random: Random,
}

impl Town {
    /// The ground of one block and half of the streets around it.
    fn street_surface(&mut self, lo: Vec2) {
        let mut mesh = Mesh::default();
        patch(&mut mesh, lo, lo + PITCH, 0.0, rgb(0x6b6c70));
        self.scene.add(mesh, true, false);
    }

    fn block(&mut self, lo: Vec2, hi: Vec2, square: bool) {
        let mut pavement = Mesh::default();
        patch(&mut pavement, lo, hi, 0.15, rgb(if square { 0xb9ad98 } else { 0xa5a29a }));
        self.scene.add(pavement, true, false);
        self.kerbside(lo, hi);
        let (lo, hi) = (lo + PAVEMENT, hi - PAVEMENT);
        if square {
            return self.square((lo + hi) / 2.0, hi - lo);
        }

        // Two sides of the block include the corners; the other two fit between them.
        self.terrace(vec2(lo.x, hi.y), vec2(hi.x, hi.y), Vec2::Y);
        self.terrace(vec2(hi.x, lo.y), vec2(lo.x, lo.y), Vec2::NEG_Y);
        self.terrace(vec2(hi.x, hi.y - DEPTH), vec2(hi.x, lo.y + DEPTH), Vec2::X);
        self.terrace(vec2(lo.x, lo.y + DEPTH), vec2(lo.x, hi.y - DEPTH), Vec2::NEG_X);

        let court = vec2(hi.x - lo.x, hi.y - lo.y) / 2.0 - DEPTH;
        for _ in 0..4 {
            let at = (lo + hi) / 2.0 + court * vec2(self.random.range(-0.7, 0.7), self.random.range(-0.7, 0.7));
            let size = self.random.range(0.8, 1.3);
            self.tree(at, size);
        }
    }

    /// Lamps, cars and trees along the two streets that belong to a block.
    fn kerbside(&mut self, lo: Vec2, hi: Vec2) {
        for (from, to, out) in
            [(lo, vec2(lo.x, hi.y), Vec2::NEG_X), (vec2(hi.x, lo.y), hi, Vec2::X), (lo, vec2(hi.x, lo.y), Vec2::NEG_Y)]
        {
            let length = (to - from).length();
            let along = (to - from) / length;
            for t in [0.06, 0.5, 0.94] {
                self.lamp(from + along * (length * t) - out * 0.5, out);
            }
            for t in [0.2, 0.35, 0.65, 0.8] {
                if self.random.chance(0.35) {
                    let size = self.random.range(0.55, 0.8);
                    self.tree(from + along * (length * t) - out * 0.9, size);
                }
            }
            let mut at = 4.0;
            while at < length - 4.0 {
                if self.random.chance(0.55) {
                    self.car(from + along * at + out * 1.15, out);
                }
                at += self.random.range(5.2, 6.5);
            }
        }
    }

    /// A row of houses whose fronts are on the line and face `front`.
    fn terrace(&mut self, from: Vec2, to: Vec2, front: Vec2) {
        let length = (to - from).length();
        let along = (to - from) / length;
        let mut at = 0.0;
        while at < length - 1.0 {
            let mut width = self.random.range(7.0, 13.0);
            if length - at - width < 6.0 {
                width = length - at;
            }
            self.house(from + along * (at + width / 2.0) - front * (DEPTH / 2.0), front, width);
            at += width;
        }
    }

    fn house(&mut self, at: Vec2, front: Vec2, width: f32) {
        let place = place(at, front);
        let storeys = self.random.pick(&[2, 2, 3, 3, 3, 4, 5]);
        let storey = self.random.range(2.9, 3.4);
        let eaves = 0.5 + storeys as f32 * storey;
        let wall = rgb(self.random.pick(&WALLS)) * self.random.range(0.9, 1.05);
        let roof = rgb(self.random.pick(&ROOFS)) * self.random.range(0.85, 1.1);
        // A little wider than its plot, because streets bend.
        let (w, d) = (width / 2.0 + 0.25, DEPTH / 2.0);

        let mut body = Mesh::default();
        body.cuboid(vec3(-w, 0.0, -d), vec3(w, eaves, d), wall);
        if storeys >= 5 || self.random.chance(0.12) {
            body.cuboid(vec3(-w, eaves, -d), vec3(w, eaves + 0.7, d), wall * 0.92);
        } else {
            let hip = if self.random.chance(0.25) { 3.0 } else { 0.0 };
            let ridge = eaves + self.random.range(2.8, 4.6);
            body.roof(vec3(-w, eaves, -d - 0.4), vec3(w, ridge, d + 0.4), hip, roof, wall);
        }
        self.scene.add(body.placed(place), true, false);

        self.details(place, w, d, storeys, storey, eaves, wall);
    }

    /// Windows with ledges, a door, a chimney: too small to be occluders.
    #[allow(clippy::too_many_arguments)]
    fn details(&mut self, place: Mat4, w: f32, d: f32, storeys: i32, storey: f32, eaves: f32, wall: Vec3) {
        let mut trim = Mesh::default();
        let (glass, frame, door) =
            (rgb(0x39495a), rgb(0xefece4), rgb(self.random.pick(&[0x5a3a28, 0x2f4a3a, 0x6b2a26])));
        let columns = (w * 2.0 / 2.6) as i32;
        for side in [1.0, -1.0] {
            for floor in 0..storeys {
                for column in 0..columns {
                    let x = (column as f32 + 0.5) / columns as f32 * 2.0 * w - w;
                    let y = 0.5 + floor as f32 * storey + 0.9;
                    let box_at = |trim: &mut Mesh, x0: f32, y0: f32, x1: f32, y1: f32, out: f32, colour: Vec3| {
                        let (z0, z1) = (d * side, (d + out) * side);
                        trim.cuboid(vec3(x0, y0, z0.min(z1)), vec3(x1, y1, z0.max(z1)), colour);
                    };
                    if floor == 0 && column == columns / 2 {
                        box_at(&mut trim, x - 0.65, 0.15, x + 0.65, 2.5, 0.12, frame);
                        box_at(&mut trim, x - 0.5, 0.15, x + 0.5, 2.35, 0.15, door);
                        continue;
                    }
                    box_at(&mut trim, x - 0.6, y - 0.08, x + 0.6, y + storey - 1.42, 0.05, frame);
                    box_at(&mut trim, x - 0.5, y, x + 0.5, y + storey - 1.5, 0.08, glass);
                    box_at(&mut trim, x - 0.7, y - 0.16, x + 0.7, y - 0.06, 0.2, wall * 0.8);
                }
            }
        }
        trim.cuboid(vec3(-w, eaves - 0.25, d), vec3(w, eaves, d + 0.3), frame * 0.9);
        let x = self.random.range(-0.7, 0.7) * w;
        trim.cuboid(vec3(x - 0.4, eaves, -2.0), vec3(x + 0.4, eaves + 4.6, -1.2), rgb(0x8c5a48));
        trim.cuboid(vec3(x - 0.5, eaves + 4.6, -2.1), vec3(x + 0.5, eaves + 4.8, -1.1), rgb(0x6e6a66));
        self.scene.add(trim.placed(place), false, false);
    }

    fn tree(&mut self, at: Vec2, size: f32) {
        let at = bend(at);
        let base = vec3(at.x, 0.1, at.y);
        let green = rgb(self.random.pick(&[0x5c7f3a, 0x4c7040, 0x6f8b3d, 0x87923f]));
        let mut mesh = Mesh::default();
        mesh.cone(base, 3.2 * size, 0.22 * size, 0.16 * size, 6, rgb(0x5d4632));
        let phase = self.random.range(0.0, 6.0);
        for i in 0..3 {
            let turn = phase + i as f32 * 1.9;
            let offset = vec3(turn.cos() * 0.9, 3.6 + 0.95 * i as f32, turn.sin() * 0.9) * size;
            let radius = Vec3::splat((2.0 - 0.3 * i as f32) * size);
            mesh.ball(base + offset, radius, 2, green * (0.86 + 0.07 * i as f32), |p| {
                1.0 + 0.1 * (p.x * 7.0 + phase).sin() * (p.y * 6.0 - phase).cos() + 0.05 * (p.z * 11.0).sin()
            });
        }
        self.scene.add(mesh, false, false);
    }

    fn lamp(&mut self, at: Vec2, out: Vec2) {
        let iron = rgb(0x33383b);
        let mut mesh = Mesh::default();
        mesh.cone(Vec3::ZERO, 0.8, 0.14, 0.09, 8, iron);
        mesh.cone(Vec3::Y * 0.8, 4.0, 0.06, 0.05, 8, iron);
        mesh.cuboid(vec3(-0.04, 4.7, 0.0), vec3(0.04, 4.8, 1.2), iron);
        mesh.tapered(vec3(-0.18, 4.55, 0.95), vec3(0.18, 4.75, 1.45), vec2(0.08, 0.1), rgb(0xf3e6b0));
        self.scene.add(mesh.placed(place(at, out)), false, false);
    }

    fn car(&mut self, at: Vec2, out: Vec2) {
        let paint = rgb(self.random.pick(&CARS));
        let (length, height) = (self.random.range(2.0, 2.3), self.random.range(1.4, 1.6));
        let mut mesh = Mesh::default();
        mesh.cuboid(vec3(-length, 0.35, -0.85), vec3(length, 0.9, 0.85), paint);
        mesh.tapered(vec3(-length * 0.75, 0.9, -0.8), vec3(length * 0.5, height, 0.8), vec2(0.5, 0.15), rgb(0x2c3640));
        mesh.cuboid(vec3(-length * 0.5, height, -0.62), vec3(length * 0.26, height + 0.04, 0.62), paint);
        for (x, z) in [(-0.6, -0.9), (0.6, -0.9), (-0.6, 0.7), (0.6, 0.7)] {
            let wheel =
                Mat4::from_translation(vec3(x * length, 0.33, z)) * Mat4::from_rotation_x(std::f32::consts::FRAC_PI_2);
            let mut tyre = Mesh::default();
            tyre.cone(Vec3::ZERO, 0.2, 0.33, 0.33, 10, rgb(0x1c1c1e));
            tyre.cone(Vec3::ZERO, -0.2, 0.2, 0.2, 10, rgb(0x9a9a9a));
            let tyre = tyre.placed(wheel);
            for t in 0..tyre.triangles.len() {
                mesh.polygon(&tyre.triangles[t].map(|i| tyre.positions[i as usize]), tyre.colours[t]);
            }
        }
        self.scene.add(mesh.placed(place(at, out)), false, true);
    }

    /// A church, a fountain and trees.
    fn square(&mut self, centre: Vec2, size: Vec2) {
        let (stone, slate) = (rgb(0xcbbfa8), rgb(0x4c5560));
        let place = place(centre, Vec2::Y);
        let mut nave = Mesh::default();
        nave.cuboid(vec3(-6.0, 0.0, -17.0), vec3(6.0, 12.0, 6.0), stone);
        self.scene.add(nave.placed(place), true, false);
        let mut roof = Mesh::default();
        roof.roof(vec3(-17.0, 12.0, -6.6), vec3(6.0, 18.5, 6.6), 0.0, slate, stone);
        self.scene.add(roof.placed(place * Mat4::from_rotation_y(-std::f32::consts::FRAC_PI_2)), true, false);
        let mut tower = Mesh::default();
        tower.cuboid(vec3(-3.4, 0.0, 6.0), vec3(3.4, 27.0, 12.8), stone * 0.97);
        tower.cuboid(vec3(-3.7, 27.0, 5.7), vec3(3.7, 27.8, 13.1), stone * 0.85);
        tower.cone(vec3(0.0, 27.8, 9.4), 17.0, 4.3, 0.0, 8, slate);
        self.scene.add(tower.placed(place), true, false);
        let mut trim = Mesh::default();
        for y in [7.0, 14.0, 20.5] {
            trim.cuboid(vec3(-0.7, y, 12.8), vec3(0.7, y + 3.4, 12.9), rgb(0x2e3a46));
            for x in [-3.45, 3.4] {
                trim.cuboid(vec3(x, y, 8.7), vec3(x + 0.05, y + 3.4, 10.1), rgb(0x2e3a46));
            }
        }
        trim.cuboid(vec3(-1.3, 0.15, 12.8), vec3(1.3, 4.0, 13.0), rgb(0x5a3a28));
        self.scene.add(trim.placed(place), false, false);

        let mut fountain = Mesh::default();
        fountain.cone(vec3(11.5, 0.15, 12.0), 0.7, 2.6, 2.6, 16, stone * 0.9);
        fountain.cone(vec3(11.5, 0.15, 12.0), 2.2, 0.5, 0.3, 12, stone);
        self.scene.add(fountain.placed(place), false, false);
        for i in 0..14 {
            let side = if i % 2 == 0 { -1.0 } else { 1.0 };
            let at = centre + vec2(side * (size.x / 2.0 - 2.5), ((i / 2) as f32 / 6.0 - 0.5) * (size.y - 6.0));
            let grown = self.random.range(0.9, 1.2);
            self.tree(at, grown);
        }
    }
}

/// A bent rectangle of ground with a kerb that goes down to the street.
fn patch(mesh: &mut Mesh, lo: Vec2, hi: Vec2, y: f32, colour: Vec3) {
    const PARTS: i32 = 6;
    let at = |i: i32, j: i32, y: f32| {
        let p = bend(lo + (hi - lo) * vec2(i as f32, j as f32) / PARTS as f32);
        vec3(p.x, y, p.y)
    };
    for j in 0..PARTS {
        for i in 0..PARTS {
            mesh.polygon(&[at(i, j + 1, y), at(i + 1, j + 1, y), at(i + 1, j, y), at(i, j, y)], colour);
        }
    }
    if y > 0.0 {
        for i in 0..PARTS {
            let mut rim = |a: (i32, i32), b: (i32, i32)| {
                mesh.polygon(&[at(a.0, a.1, 0.0), at(b.0, b.1, 0.0), at(b.0, b.1, y), at(a.0, a.1, y)], colour * 0.9);
            };
            rim((i, PARTS), (i + 1, PARTS));
            rim((i + 1, 0), (i, 0));
            rim((PARTS, i + 1), (PARTS, i));
            rim((0, i), (0, i + 1));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_town_is_the_same_every_time() {
        let (a, b) = (generate(), generate());
        assert!((1_000..10_000).contains(&a.objects.len()), "{} objects", a.objects.len());
        assert_eq!(a.objects.len(), b.objects.len());
        for (a, b) in a.objects.iter().zip(&b.objects) {
            assert_eq!(a.mesh.positions, b.mesh.positions);
            assert_eq!(a.mesh.triangles, b.mesh.triangles);
        }
    }

    #[test]
    fn placing_turns_the_front_and_mirrors_nothing() {
        for front in [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
            let place = place(vec2(30.0, -20.0), front);
            assert!((place.determinant() - 1.0).abs() < 1e-3);
            let out = place.transform_vector3(Vec3::Z);
            assert!(out.dot(vec3(front.x, 0.0, front.y)) > 0.8, "{front} became {out}");
        }
    }

    #[test]
    fn the_ground_faces_up() {
        let mut mesh = Mesh::default();
        patch(&mut mesh, Vec2::ZERO, vec2(10.0, 10.0), 0.0, Vec3::ONE);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert!((b - a).cross(c - a).y > 0.0);
        }
    }
}
