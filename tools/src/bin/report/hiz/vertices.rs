//! Projects vertices to the screen: divides, snaps, marks those that need clipping. Once per vertex, however many
//! triangles share it.

use super::lanes::{COUNT, Lanes, MOST, Pass, Words};
use super::screen::Screen;

/// Outside a plane of the frustum.
pub const NEAR: i32 = 1;
pub const LEFT: i32 = 2;
pub const RIGHT: i32 = 4;
pub const BELOW: i32 = 8;
pub const ABOVE: i32 = 16;
/// All of them.
pub const PLANES: i32 = 31;
/// In front of the near plane or beyond the guard band.
pub const CLIP: i32 = 32;

/// Clip-space vertices to x and y on the grid, 1/w, and clip marks.
pub struct Project<'a> {
    pub screen: Screen,
    pub clip: &'a [[f32; 4]],
    pub out: &'a mut Vec<Words>,
}

impl Pass for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, s: L) {
        let Self { screen, clip, out } = self;
        out.resize(clip.len().next_multiple_of(MOST), [0; 4]);
        let whole = clip.len() / L::N * L::N;
        for i in (0..whole).step_by(L::N) {
            // SAFETY: there are as many from here on, and `out` is no shorter.
            unsafe { project(s, &screen, clip.as_ptr().add(i).cast(), out.as_mut_ptr().add(i)) };
        }
        if whole < clip.len() {
            let mut rest = [[0; 4]; MOST];
            for (rest, v) in rest.iter_mut().zip(&clip[whole..]) {
                *rest = v.map(f32::to_bits);
            }
            // SAFETY: there is room for the most lanes, and `out` is a whole number of those.
            unsafe { project(s, &screen, rest.as_ptr(), out.as_mut_ptr().add(whole)) };
        }
    }
}

/// # Safety
/// As many vertices as there are lanes can be read and written.
#[inline(always)]
unsafe fn project<L: Lanes>(s: L, screen: &Screen, from: *const Words, to: *mut Words) {
    // SAFETY: the caller's contract; they are contiguous.
    let [x, y, _, w] = unsafe { s.fetch::<1>(from, COUNT.as_ptr()) };
    let (x, y, w) = (s.float_of(x), s.float_of(y), s.float_of(w));
    let depth = s.div(s.f(1.0), w);
    // Not fused: `Screen::project` rounds in the same way.
    let [half_width, half_height] = screen.half;
    let across = s.add(s.mul(s.mul(x, depth), s.f(half_width)), s.f(half_width));
    let down = s.add(s.mul(s.mul(y, depth), s.f(-half_height)), s.f(half_height));

    let within = |v, axis: usize| {
        let (low, high) = screen.range(axis);
        s.and_m(s.le(s.f(low), v), s.le(v, s.f(high)))
    };
    let regular = s.and_m(s.le(s.f(screen.near), w), s.and_m(within(across, 0), within(down, 1)));
    let mut marks = s.i(0);
    if s.bits(regular) != (1 << L::N) - 1 {
        let minus_w = s.sub(s.f(0.0), w);
        let mark = |m, mark: i32| s.select_i(m, s.i(mark), s.i(0));
        marks = s.or_i(
            s.select_i(regular, s.i(0), s.i(CLIP)),
            s.or_i(
                mark(s.lt(w, s.f(screen.near)), NEAR),
                s.or_i(
                    s.or_i(mark(s.lt(x, minus_w), LEFT), mark(s.lt(w, x), RIGHT)),
                    s.or_i(mark(s.lt(y, minus_w), BELOW), mark(s.lt(w, y), ABOVE)),
                ),
            ),
        );
    }
    // SAFETY: there is room, by the caller's contract.
    unsafe { s.spread(to, [s.round(across), s.round(down), s.bits_of(depth), marks]) };
}
