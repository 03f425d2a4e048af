//! Transforms vertices to clip space.

use glam::Mat4;

use super::lanes::{Lanes, MOST, Pass};

/// Positions (x, y, z, anything) to clip-space (x, y, z, w). Elements of 16 bytes can be loaded without shuffles.
pub struct Transform<'a> {
    pub positions: &'a [[f32; 4]],
    pub matrix: &'a Mat4,
    pub out: &'a mut Vec<[f32; 4]>,
}

impl Pass for Transform<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, s: L) {
        let Self { positions, matrix, out } = self;
        let columns = matrix.to_cols_array_2d();
        out.resize(positions.len(), [0.0; 4]);
        let whole = positions.len() / L::N * L::N;
        for i in (0..whole).step_by(L::N) {
            // SAFETY: both have this many elements from here on.
            unsafe { s.transform(&columns, positions.as_ptr().add(i), out.as_mut_ptr().add(i)) };
        }
        let (mut from, mut to) = ([[0.0; 4]; MOST], [[0.0; 4]; MOST]);
        let rest = &positions[whole..];
        from[..rest.len()].copy_from_slice(rest);
        // SAFETY: both are as long as the most lanes.
        unsafe { s.transform(&columns, from.as_ptr(), to.as_mut_ptr()) };
        out[whole..].copy_from_slice(&to[..rest.len()]);
    }
}
