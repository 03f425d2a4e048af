//! Many triangles in one call, each in a square of tiles of its own: drawing them as full vectors must give the same
//! result as drawing them one by one.

mod oracle;
mod support;

use std::cell::RefCell;

use oracle::{Oracle, Triangle, UNIT, Vertex};
use proptest::prelude::*;
use support::triangles::{Kind, of_kind};
use support::{check, conservative, draw, mesh, name, objects, read};

const CELL: usize = 32;
const CELLS: usize = 12;

fn moved(t: &Triangle, column: usize, row: usize) -> Triangle {
    let by = |n: usize| (n * CELL) as i64 * UNIT;
    t.map(|v| Vertex { x: v.x + by(column), y: v.y + by(row), z: v.z })
}

/// Squares with triangles that stay inside them.
fn squares() -> impl Strategy<Value = Vec<Triangle>> {
    use Kind::*;
    let kinds = [Uniform, OnCentres, OnCorners, NearHorizontal, NearVertical, HorizontalEdge, VerticalEdge];
    let inside = proptest::strategy::Union::new(kinds.map(|k| of_kind(k, (CELL, CELL))));
    let end = CELL as i64 * UNIT;
    // Some kinds extend slightly past the edge of their square.
    let inside = inside.prop_map(move |t| t.map(|v| Vertex { x: v.x.clamp(0, end), y: v.y.clamp(0, end), z: v.z }));
    proptest::collection::vec(inside, CELLS * CELLS)
}

#[test]
fn triangles_in_one_call_are_exact() {
    let size = (CELL * CELLS, CELL * CELLS);
    let state = RefCell::new((objects(size), Vec::new(), Oracle::new(size.0, size.1)));
    check(40, 1, &squares(), |triangles| {
        let (objects, depth, oracle) = &mut *state.borrow_mut();
        let placed: Vec<Triangle> = triangles.iter().enumerate().map(|(i, t)| moved(t, i % CELLS, i / CELLS)).collect();
        oracle.clear();
        placed.iter().for_each(|t| oracle.draw(t));
        for moc in objects.iter_mut() {
            moc.clear_buffer();
            draw(moc, &placed);
            read(moc, depth);
            let wrong = depth.iter().zip(&oracle.depth).position(|(a, b)| (*a < 0.0) != (*b < 0.0));
            let wrong = wrong.map(|i| format!("pixel ({}, {}) is covered wrongly", i % size.0, i / size.0));
            if let Some(why) = wrong.or_else(|| conservative(depth, oracle).err()) {
                let (vertices, _) = mesh(&placed, size, moc.y_axis());
                return Err(format!("{}: {why}\n{vertices:?}", name(moc)));
            }
        }
        Ok(())
    });
}
