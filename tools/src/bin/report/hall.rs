//! A generated hall in the style of old buildings: two storeys of columns and arches around a long court, vaults,
//! curtains hanging in the openings, plants in tubs. Much of it is behind small occluders, where it matters what a
//! buffer forgets.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3, vec3};

use demo::scene::{Mesh, Scene};

/// Number of bays along the court, the length of each, and the distance of the columns and the walls from the middle.
const BAYS: i32 = 14;
const BAY: f32 = 4.0;
const COLUMNS: f32 = 5.0;
const WALL: f32 = 9.0;
const STOREY: f32 = 6.0;

/// Camera positions and targets: along the court, along an aisle, from the gallery across.
pub const PLACES: [(Vec3, Vec3); 3] = [
    (vec3(0.5, 1.7, 1.0), vec3(-0.8, 3.5, -40.0)),
    (vec3(7.0, 1.7, 0.5), vec3(5.2, 2.0, -40.0)),
    (vec3(-7.2, 8.0, -6.0), vec3(7.0, 4.0, -44.0)),
];

pub fn generate() -> Scene {
    let mut scene = Scene::default();
    let length = BAYS as f32 * BAY;
    let mut shell = |lo: Vec3, hi: Vec3| {
        let mut mesh = Mesh::default();
        mesh.cuboid(lo, hi, Vec3::ONE);
        scene.add(mesh, true, false);
    };
    for storey in 0..3 {
        // The lowest floor is complete, the others leave the court open.
        let y = storey as f32 * STOREY;
        let from = if storey == 0 { 0.0 } else { COLUMNS - 0.6 };
        for side in [-1.0, 1.0] {
            let (a, b) = (side * from, side * (WALL + 0.5));
            shell(vec3(a.min(b), y - 0.4, -length), vec3(a.max(b), y, 4.0));
        }
    }
    for side in [-1.0f32, 1.0] {
        let (a, b) = (side * WALL, side * (WALL + 0.5));
        shell(vec3(a.min(b), 0.0, -length), vec3(a.max(b), 2.0 * STOREY, 4.0));
    }
    shell(vec3(-WALL, 0.0, -length - 0.5), vec3(WALL, 2.0 * STOREY, -length));

    for bay in 0..=BAYS {
        for side in [-1.0, 1.0] {
            for storey in 0..2 {
                let foot = vec3(side * COLUMNS, storey as f32 * STOREY, -(bay as f32) * BAY);
                column(&mut scene, foot);
                if bay < BAYS {
                    arch(&mut scene, foot, Vec3::NEG_Z * BAY);
                    vault(&mut scene, foot, side);
                    if (bay + storey) % 2 == 0 {
                        curtain(&mut scene, foot, bay);
                    } else {
                        plant(&mut scene, foot + vec3(side * 1.6, 0.0, -BAY / 2.0), bay as u32 * 4 + storey as u32);
                    }
                }
                // Across the aisle, from the column to the wall.
                arch(&mut scene, foot, vec3(side * (WALL - COLUMNS), 0.0, 0.0));
            }
        }
    }
    scene
}

/// Base, shaft and capital, each as one object.
fn column(scene: &mut Scene, foot: Vec3) {
    let mut base = Mesh::default();
    base.tapered(foot + vec3(-0.55, 0.0, -0.55), foot + vec3(0.55, 0.5, 0.55), Vec2::splat(0.1), Vec3::ONE);
    scene.add(base, true, false);
    let mut shaft = Mesh::default();
    for ring in 0..8 {
        let swell = |k: i32| 0.4 - 0.05 * (k as f32 / 8.0).powi(2);
        let at = foot + Vec3::Y * (0.5 + ring as f32 * 0.35);
        shaft.cone(at, 0.35, swell(ring), swell(ring + 1), 24, Vec3::ONE);
    }
    scene.add(shaft, true, false);
    let mut capital = Mesh::default();
    capital.cone(foot + Vec3::Y * 3.3, 0.3, 0.35, 0.6, 24, Vec3::ONE);
    capital.cuboid(foot + vec3(-0.6, 3.6, -0.6), foot + vec3(0.6, 3.8, 0.6), Vec3::ONE);
    scene.add(capital, true, false);
}

/// The wall above a round arch, from one capital to the next in a direction.
fn arch(scene: &mut Scene, foot: Vec3, span: Vec3) {
    const STONES: usize = 24;
    let (half, middle) = (span.length() / 2.0 - 0.5, span / 2.0);
    let along = span.normalize();
    let thick = along.cross(Vec3::Y) * 0.4;
    let (spring, top) = (3.8, STOREY - 0.4);
    let at = |i: usize| {
        let (sin, cos) = (PI * i as f32 / STONES as f32).sin_cos();
        let rise = (sin * half).min(top - spring - 0.15);
        foot + middle - along * cos * half + Vec3::Y * (spring + rise)
    };
    let mut mesh = Mesh::default();
    for i in 0..STONES {
        let (a, b) = (at(i), at(i + 1));
        let up = |p: Vec3| p.with_y(foot.y + top);
        mesh.polygon(&[a + thick, b + thick, up(b) + thick, up(a) + thick], Vec3::ONE);
        mesh.polygon(&[b - thick, a - thick, up(a) - thick, up(b) - thick], Vec3::ONE);
        mesh.polygon(&[b + thick, a + thick, a - thick, b - thick], Vec3::ONE);
    }
    scene.add(mesh, true, false);
}

/// The ceiling of a bay of an aisle, curved in both directions.
fn vault(scene: &mut Scene, foot: Vec3, side: f32) {
    let mesh = sheet(16, 16, |u, v| {
        let bulge = (PI * u).sin() * (PI * v).sin();
        foot + vec3(side * u * (WALL - COLUMNS), STOREY - 1.2 + 0.75 * bulge, -v * BAY)
    });
    scene.add(mesh, true, true);
}

/// A curtain in an opening, with folds.
fn curtain(scene: &mut Scene, foot: Vec3, bay: i32) {
    let low = 1.0 + 0.4 * (bay % 3) as f32;
    let mesh = sheet(40, 16, |u, v| {
        let fold = 0.12 * (9.0 * TAU * u + bay as f32).sin() * (1.2 - v);
        foot + vec3(fold, low + (4.4 - low) * v, -0.5 - u * (BAY - 1.0))
    });
    scene.add(mesh, true, true);
}

/// A tub and leaves, which are too small to hide anything.
fn plant(scene: &mut Scene, foot: Vec3, seed: u32) {
    let mut tub = Mesh::default();
    tub.cone(foot, 0.6, 0.3, 0.4, 16, Vec3::ONE);
    scene.add(tub, true, false);
    let mut leaves = Mesh::default();
    for leaf in 0..120 {
        let turn = (leaf + seed) as f32 * 2.399_963;
        let (sin, cos) = turn.sin_cos();
        let out = vec3(sin, 0.0, cos);
        let from = foot + Vec3::Y * (0.6 + leaf as f32 * 0.01) + out * 0.1;
        let tip = from + out * (0.3 + 0.002 * leaf as f32) + Vec3::Y * 0.25;
        let across = out.cross(Vec3::Y) * 0.05;
        leaves.polygon(&[from, (from + tip) / 2.0 + across, tip, (from + tip) / 2.0 - across], Vec3::ONE);
    }
    scene.add(leaves, false, true);
}

/// A grid of quads on the surface that `place` defines for two parameters from 0 to 1.
fn sheet(columns: u32, rows: u32, place: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            mesh.positions.push(place(column as f32 / columns as f32, row as f32 / rows as f32));
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let low = row * (columns + 1) + column;
            let high = low + columns + 1;
            mesh.triangles.extend([[low, low + 1, high + 1], [low, high + 1, high]]);
            mesh.colours.extend([Vec3::ONE; 2]);
        }
    }
    mesh
}
